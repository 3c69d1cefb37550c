#include "bench/contender.hpp"
#include "bench/lanes.hpp"
#include "erard/device/key_pool.hpp"

namespace erard::bench {
namespace {

TickSettings settings_of(const Job& job) {
  TickSettings settings;
  settings.set_rate(job.rate_Hz, job.is_split ? 0 : job.substeps);
  return settings;
}

/// One key. tick() asks the keystroke itself for every instant, so that the error of the force is that of the steps alone.
class Stroke : public Contender {
 public:
  Stroke(const Stage& stage, const Job& job)
      : mechanism_(stage.mechanism(job.felts)),
        settings_(settings_of(job)),
        part_(cast(*job.scene, stage, 1).front()),
        rest_(rest_state(mechanism_, settings_.scheme.time_step)) {
    Stroke::start();
  }

  void start() override {
    state_ = rest_;
    ticks_ = 0;
  }
  void tick(StepClock steps) override {
    state_.time = static_cast<double>(ticks_++) * settings_.period;  // no drift by rounding
    report_ = erard::tick(mechanism_, settings_, part_, state_, *work_,
                          [&steps](const State&, const StepReport&, double) noexcept { steps.mark(); });
  }
  Effort effort() const override {
    return {report_.linearisations,
            report_.sweeps,
            report_.steps,
            report_.status == StepStatus::not_converged,
            0,
            report_.status != StepStatus::not_finite};
  }
  double force() const override { return report_.force; }

 private:
  const Mechanism& mechanism_;
  TickSettings settings_;
  Part part_;
  State rest_, state_;
  TickReport report_;
  long ticks_ = 0;
  std::unique_ptr<Workspace> work_ = std::make_unique<Workspace>();
};

/// Many keys, as a host has them: one input a key and period.
class Keys : public Contender {
 public:
  Keys(const Stage& stage, const Job& job)
      : model_(stage.mechanism(job.felts).model),
        settings_(settings_of(job)),
        worker_cpus_(job.worker_cpus),
        lanes_name_(job.lanes),
        play_in_(std::lround(duration_of(*job.scene, stage) * job.rate_Hz)),
        parts_(cast(*job.scene, stage, job.keys)),
        inputs_(parts_.size()) {
    sleep_.is_on = job.may_sleep;
  }

  void start() override {
    pool_.reset();
    lanes_.reset();
    keyboard_ = std::make_unique<Keyboard>(model_, static_cast<int>(parts_.size()), settings_, sleep_);
    if (lanes_name_ != "off") lanes_ = make_lanes(*keyboard_, lanes_name_);
    if (!worker_cpus_.empty()) pool_ = std::make_unique<KeyPool>(*keyboard_, worker_cpus_, kSpinTime);
    for (long i = 0; i < play_in_; ++i) {
      prepare();
      tick({});
    }
  }
  void prepare() override {
    const double end = keyboard_->time() + settings_.period;
    for (std::size_t k = 0; k < parts_.size(); ++k) inputs_[k] = parts_[k].at(end);
  }
  void tick(StepClock) override {
    if (pool_)
      pool_->tick(inputs_);
    else if (lanes_)
      lanes_->tick(inputs_);
    else
      keyboard_->tick(inputs_);
  }
  Effort effort() const override {
    Effort effort;
    effort.asleep = keyboard_->asleep_count();
    for (int k = 0; k < keyboard_->size(); ++k) {
      const StepStatus status = keyboard_->statuses()[static_cast<std::size_t>(k)];
      effort.not_converged += !keyboard_->is_asleep(k) && status == StepStatus::not_converged;
      effort.is_finite = effort.is_finite && status != StepStatus::not_finite;
    }
    return effort;
  }
  double force() const override { return keyboard_->forces().front(); }

 private:
  /// Longer than what the harness does between two periods, shorter than the Breather's rest: then the workers rest too.
  static constexpr double kSpinTime = 2e-4;  // [s]

  const Model& model_;
  TickSettings settings_;
  SleepSettings sleep_;
  std::vector<int> worker_cpus_;
  std::string lanes_name_;
  long play_in_;  // [ticks]
  std::vector<Part> parts_;
  std::vector<DriveSample> inputs_;
  std::unique_ptr<Keyboard> keyboard_;
  std::unique_ptr<KeyPool> pool_;
  std::unique_ptr<Lanes> lanes_;
};

}  // namespace

std::unique_ptr<Contender> make_erard(const Stage& stage, const Job& job) {
  if (job.scene->is_keyboard) return std::make_unique<Keys>(stage, job);
  return std::make_unique<Stroke>(stage, job);
}

}  // namespace erard::bench
