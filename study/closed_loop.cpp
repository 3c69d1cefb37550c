#include "study/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <stdexcept>

#include "erard/haptics/keyboard.hpp"
#include "erard/mechanics/rest.hpp"

namespace erard::study {
namespace {

/// The other side of the loop.
class Host {
 public:
  Host() = default;
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  virtual ~Host() = default;

  /// @return the command for a sample [N]
  virtual double answer(double sample) = 0;
  virtual double hammer_speed() const = 0;  // at the first impact [m/s]
  virtual double guarded() const { return 0; }
};

Model with(Model model, const Coupling& coupling) {
  model.finger.stiffness = coupling.stiffness;
  model.finger.damping = coupling.damping;
  return model;
}

class Plain : public Host {
 public:
  Plain(const ActionFile& action, const PlainHost& settings, double period, const VirtualActuatorSettings& actuator)
      : settings_(settings),
        actuator_(actuator),
        rising_(period, kMemory, 1),
        mechanism_(build_mechanism(with(action.model, settings.coupling))),
        detector_(mechanism_, action.roles) {
    tick_.set_rate(1 / period);
    state_ = rest_state(mechanism_, tick_.scheme.time_step);
  }

  double answer(double sample) override {
    const DriveSample piston = settings_.estimator.update(sample);
    const LineInput line{last_, piston, state_.time, tick_.period};
    const auto observe = [this](const State& now, const StepReport&, double force) noexcept {
      detector_.observe(now, force);
    };
    const TickReport report = tick(mechanism_, tick_, line, state_, *work_, observe);
    if (report.status == StepStatus::not_finite) throw std::runtime_error("closed loop: a step that is not finite");
    last_ = piston;
    const bool is_brake = actuator_.kind == VirtualActuatorKind::mr_brake;
    const double command = is_brake && rising_.update(sample) < -settings_.release_speed ? 0 : report.force;
    settings_.estimator.sent(std::clamp(command, -actuator_.limit, actuator_.limit));
    return command;
  }

  double hammer_speed() const override {
    for (int i = 0; i < detector_.count(); ++i)
      if (detector_[i].kind == EventKind::hammer_meets_string) return detector_[i].hammer_speed;
    return 0;
  }

 private:
  static constexpr double kMemory = 0.85;  // 6 ms of delay, 4 mm/s of noise for 50 um

  PlainHost settings_;
  VirtualActuatorSettings actuator_;
  FadingPolynomial rising_;
  Mechanism mechanism_;
  EventDetector detector_;
  std::unique_ptr<Workspace> work_ = std::make_unique<Workspace>();
  TickSettings tick_;
  State state_;
  DriveSample last_;
};

class Pipeline : public Host {
 public:
  Pipeline(const ActionFile& action, const PipelineHost& settings)
      : renderer_(std::make_unique<Renderer>(action.model, action.roles, settings.rendering)) {}

  double answer(double sample) override {
    const auto time = static_cast<std::int64_t>(std::llround(1e9 * renderer_->settings().tick.period)) * ++sequence_;
    const PositionMessage message{1, sequence_, time, {&sample, 1}};
    const PeriodOutput& out = renderer_->period({time, {&message, 1}});
    const KeyOutput& key = out.key[0];
    if (has(key.faults, Fault::step_not_finite)) throw std::runtime_error("closed loop: a step that is not finite");
    if (!out.blow.empty() && hammer_speed_ == 0) hammer_speed_ = out.blow[0].speed;
    if (has(key.faults, Fault::passivity_acted)) ++guarded_;
    const ActuatorSettings& actuator = renderer_->settings().actuator;
    if (actuator.kind != ActuatorKind::mr_brake) return key.expected_force;
    return actuator.mr_brake.yield_force * -std::expm1(-key.current / actuator.mr_brake.saturation_current);
  }

  double hammer_speed() const override { return hammer_speed_; }
  double guarded() const override { return static_cast<double>(guarded_) / static_cast<double>(sequence_); }

 private:
  std::unique_ptr<Renderer> renderer_;
  std::int64_t sequence_ = 0;
  double hammer_speed_ = 0;
  long guarded_ = 0;
};

std::unique_ptr<Host> make_host(const ActionFile& action, const ClosedLoopSettings& settings) {
  if (const auto* pipeline = std::get_if<PipelineHost>(&settings.host))
    return std::make_unique<Pipeline>(action, *pipeline);
  return std::make_unique<Plain>(action, std::get<PlainHost>(settings.host), settings.period, settings.rig.actuator);
}

}  // namespace

Coupling ClosedLoopSettings::coupling() const {
  if (const auto* plain = std::get_if<PlainHost>(&host)) return plain->coupling;
  return std::get<PipelineHost>(host).rendering.coupling;
}

ForceCurve LoopTrace::finger_curve(double start) const {
  ForceCurve curve;
  for (std::size_t i = 0; i < finger.size(); ++i) {
    curve.time.push_back(start + static_cast<double>(i + 1) * period);
    curve.force.push_back(finger[i]);
  }
  return curve;
}

LoopTrace play_loop(const ActionFile& action, const ClosedLoopSettings& settings, const Keystroke& intended) {
  const std::unique_ptr<Host> host = make_host(action, settings);
  Rig rig(settings.rig, intended);
  std::deque<double> under_way(static_cast<std::size_t>(settings.delay_periods), 0.0);
  LoopTrace trace;
  trace.period = settings.period;
  const long periods = std::lround((intended.end() - intended.start()) / settings.period);
  for (long i = 0; i < periods; ++i) {
    under_way.push_back(host->answer(rig.measure()));
    trace.command.push_back(under_way.back());
    rig.advance(settings.period, under_way.front());
    under_way.pop_front();
    trace.finger.push_back(rig.state().finger_force);
    trace.lever.push_back(rig.state().lever.position);
  }
  trace.hammer_speed = host->hammer_speed();
  trace.guarded = host->guarded();
  return trace;
}

}  // namespace erard::study
