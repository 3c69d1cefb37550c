// From "a position message arrived" to "this force leaves": what a device renders, without clock, thread or network.
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "erard/haptics/actuator.hpp"
#include "erard/haptics/fault.hpp"
#include "erard/haptics/finger.hpp"
#include "erard/haptics/guard.hpp"
#include "erard/haptics/hammer_watch.hpp"
#include "erard/haptics/keyboard.hpp"
#include "erard/haptics/passivity.hpp"
#include "erard/haptics/piston_track.hpp"
#include "erard/haptics/position_watch.hpp"

namespace erard {

/// How a device is rendered; config/device.yaml.
struct RenderSettings {
  int keys = 1;                  // 1 .. 88
  TickSettings tick;             // drive piston or key, rate
  double max_steps_per_s = 2e5;  // internal, of all keys together; where they need more each is computed less finely
  SleepSettings sleep = SleepSettings::eager();
  Coupling coupling{4000, 9};  // between device and simulated key, of the drive `piston`; docs/stability.md
  PositionWatchSettings watch;
  PistonTrackSettings track;
  PassivitySettings passivity;
  GuardSettings guard;
  ActuatorSettings actuator;
};

/// What a period begins with.
struct PeriodInput {
  std::int64_t host_time = 0;                 // of this period, never decreasing [ns]
  std::span<const PositionMessage> messages;  // since the last period, in order of arrival; the newest that counts wins
};

struct KeyOutput {
  double force = 0;            // out, upwards on the key, against the finger [N]
  double current = 0;          // to ask of the actuator [A]
  double expected_force = 0;   // that it is expected to make of it [N]
  double simulated_force = 0;  // of the finger on the simulated key, before all that held it back [N]
  DriveSample piston;          // that drove the simulated key, at the end of the period [m], [m/s]
  double fade = 0;             // 0 .. 1
  double surplus = 0;          // of the joint between device and action, Passivity [J]
  Fault faults = Fault::none;
};

struct PeriodOutput {
  std::int64_t host_time = 0;             // as it came in [ns]
  Fault message = Fault::none;            // what was wrong with the messages
  bool has_input = false;                 // one of them counted
  const PositionMessage* used = nullptr;  // the newest of those; null: none
  Fault faults = Fault::none;             // of the messages and of all keys
  int asleep = 0;                         // keys
  std::span<const KeyOutput> key;         // valid until the next period
  std::span<const HammerEvent> blow;
};

/// n keys, one call a period:
///   message -> MessageWatch -> KeyWatch -> PistonTrack -> Keyboard (the actions) -> Passivity -> Guard -> Actuator
/// The result is a function of the inputs since the start and nothing else: a recording of them gives every output
/// again, bit for bit. Once built: no heap, no exceptions, no locks.
class Renderer {
 public:
  static constexpr int kMaxKeys = 88;

  /// @param model  valid, has a finger; its Kelvin-Voigt element is replaced by the coupling
  /// @param roles  of the string and the hammer, for blows
  Renderer(const Model& model, const ActionRoles& roles, const RenderSettings& settings)
      : settings_(settings),
        roles_(roles),
        period_(settings.tick.period),
        noise_energy_(noise_energy(settings)),
        message_watch_(settings.watch, settings.keys),
        keyboard_(coupled(model, settings), std::vector<int>(static_cast<std::size_t>(settings.keys), kNormal),
                  settings.tick, settings.sleep, most_steps(settings)),
        key_(static_cast<std::size_t>(settings.keys), Key(settings)),
        input_(key_.size()),
        output_(key_.size()),
        blow_(key_.size()) {
    assert(settings.keys >= 1 && settings.keys <= kMaxKeys);
  }

  int size() const noexcept { return settings_.keys; }
  const RenderSettings& settings() const noexcept { return settings_; }
  const Keyboard& keyboard() const noexcept { return keyboard_; }
  Keyboard& keyboard() noexcept { return keyboard_; }

  /// From now on `player` advances the keyboard, which is its own; it must outlive this. Null: the keyboard itself.
  void play_by(KeyboardPlayer* player) noexcept { player_ = player; }
  const FaultCounters& counters() const noexcept { return counters_; }
  std::int64_t accepted_messages() const noexcept { return accepted_messages_; }
  std::uint64_t lost_messages() const noexcept { return lost_messages_; }  // by their sequence

  /// Advances everything by one period. The output is valid until the next call.
  const PeriodOutput& period(const PeriodInput& in) noexcept {
    result_ = {};
    result_.host_time = in.host_time;
    notice_pause(in.host_time);
    take_messages(in);
    for (int k = 0; k < size(); ++k) follow(k, in);
    blow_count_ = 0;
    const std::span<const double> forces = play();
    for (int k = 0; k < size(); ++k) render(k, forces[k]);
    result_.faults |= result_.message;
    if (keyboard_.budget().level() > 0) {
      result_.faults |= Fault::coarser_steps;
      counters_.add(Fault::coarser_steps);
    }
    counters_.end_period(result_.faults);
    result_.asleep = keyboard_.asleep_count();
    result_.key = output_;
    result_.blow = std::span(blow_).first(static_cast<std::size_t>(blow_count_));
    return result_;
  }

 private:
  static constexpr int kNormal = 0, kSafe = 1;  // models of the keyboard

  /// One period of the actions. @return the simulated force of each [N]
  std::span<const double> play() noexcept {
    if (player_ == nullptr)
      return keyboard_.tick(input_, [this](int k, const State& state, const StepReport&, double force) noexcept {
        see(k, state, force);
      });
    const auto look = [](void* self, int k, const State& state, const StepReport&, double force) noexcept {
      static_cast<Renderer*>(self)->see(k, state, force);
    };
    return player_->tick(input_, look, this);
  }

  static int most_steps(const RenderSettings& settings) noexcept {
    constexpr double kMost = StepBudget::kUnbounded;
    return static_cast<int>(std::clamp(settings.max_steps_per_s * settings.tick.period + 1e-9, 1.0, kMost));
  }

  struct Key {
    explicit Key(const RenderSettings& settings) noexcept : track(settings.track, settings.tick.period) {}

    std::int64_t last_good = 0;  // host time of the last sample that counted [ns]
    bool is_live = false;        // there was one within the timeout
    KeyWatch watch;
    Guard guard;
    Actuator actuator;
    Passivity passivity;
    HammerWatch hammer;
    double y = 0;               // of the simulated key, now [m]
    double force = 0;           // on it, at the last internal step [N]
    double given = 0;           // to it this period [J]
    bool is_held_back = false;  // the actuator is asked for less than the simulated force
    double way_from = 0;        // piston of the period before [m]
    PistonTrack track;          // large, and its first lines are what a resting key looks at
  };

  /// The model with either coupling, by kNormal and kSafe.
  static std::array<Model, 2> coupled(const Model& model, const RenderSettings& settings) noexcept {
    std::array<Model, 2> models{model, model};
    for (const int i : {kNormal, kSafe}) {
      const Coupling& coupling = i == kNormal ? settings.coupling : settings.passivity.safe_coupling;
      models[static_cast<std::size_t>(i)].finger.stiffness = coupling.stiffness;
      models[static_cast<std::size_t>(i)].finger.damping = coupling.damping;
    }
    return models;
  }

  static double noise_energy(const RenderSettings& s) noexcept {
    if (s.tick.drive != DriveKind::piston) return 0;
    const double noise = s.passivity.sensor_noise;
    return (1.5 * s.coupling.damping / s.tick.period + s.coupling.stiffness) * noise * noise;
  }

  /// A force holds for the timeout: after a longer pause of the host the device has let go by itself, and a force as
  /// before would be a blow.
  void notice_pause(std::int64_t host_time) noexcept {
    if (static_cast<double>(host_time - last_period_) * 1e-9 > settings_.watch.timeout)
      for (Key& key : key_) key.guard.let_go();
    last_period_ = host_time;
  }

  /// The newest message that counts; those before it in the same period are as good as lost to the estimators.
  void take_messages(const PeriodInput& in) noexcept {
    message_ = nullptr;
    is_first_ = false;
    between_ = 0;
    for (const PositionMessage& message : in.messages) {
      const Fault fault = message_watch_.look(message, in.host_time);
      counters_.add(fault);
      result_.message |= fault;
      if (fault != Fault::none && fault != Fault::gap) continue;
      lost_messages_ += message_watch_.lost();
      between_ += message_watch_.lost() + (message_ != nullptr ? 1 : 0);
      is_first_ = is_first_ || message_watch_.is_first();
      message_ = &message;
      ++accepted_messages_;
    }
    result_.has_input = message_ != nullptr;
    result_.used = message_;
  }

  /// Position of one key: judged, followed, or missed.
  void follow(int k, const PeriodInput& in) noexcept {
    Key& key = key_[k];
    Fault faults = Fault::none;
    SampleVerdict verdict = SampleVerdict::rejected;
    if (result_.has_input)
      verdict = key.watch.look(settings_.watch, message_->position[k],
                               static_cast<double>(message_->device_time) * 1e-9, period_, is_first_, faults);
    if (verdict == SampleVerdict::rejected) {
      key.track.miss(settings_.track, period_);
    } else {
      key.last_good = in.host_time;
      key.is_live = true;
      const int lost = static_cast<int>(std::min<std::uint64_t>(between_, 1000));
      key.track.take(settings_.track, period_, message_->position[k], lost, verdict == SampleVerdict::resumed);
    }
    const double age = static_cast<double>(in.host_time - key.last_good) * 1e-9;
    if (age > settings_.watch.timeout) key.is_live = false;
    if (!key.is_live) faults |= Fault::no_input;
    if (!key.track.is_aligned()) faults |= Fault::realigned;
    output_[k].faults = faults;
    key.way_from = key.track.piston().value;
    input_[k] = key.track.advance(settings_.track, period_, key.guard.fade() == 0);
  }

  /// One internal step of a key that is awake.
  void see(int k, const State& state, double force) noexcept {
    Key& key = key_[k];
    const Mechanism& mechanism = keyboard_.mechanism(k);
    const double y = key_position(mechanism.model, state);
    key.given += 0.5 * (key.force + force) * (y - key.y);
    key.force = force;
    key.y = y;
    // the lock-out is longer than a period: never more than one a key
    if (key.hammer.observe(mechanism, roles_, state) && blow_count_ < size())
      blow_[static_cast<std::size_t>(blow_count_++)] = {k, state.time, key.hammer.speed()};
  }

  /// Force of one key on its way out.
  void render(int k, double simulated) noexcept {
    Key& key = key_[k];
    KeyOutput& out = output_[k];
    const StepStatus status = keyboard_.statuses()[k];
    const bool is_finite = status != StepStatus::not_finite;
    if (status == StepStatus::not_converged && !keyboard_.is_asleep(k)) out.faults |= Fault::step_not_converged;
    out.piston = input_[k];
    out.simulated_force = simulated;
    const bool is_well = key.is_live && key.track.is_aligned() && is_finite;
    const double wanted = is_finite ? passive_force(k, out, is_well) : std::numeric_limits<double>::quiet_NaN();
    out.force = key.guard.pass(settings_.guard, period_, wanted, is_well, out.faults);
    out.fade = key.guard.fade();
    const ActuatorCommand command =
        key.actuator.command(settings_.actuator, period_, out.force, out.piston.rate, out.faults);
    out.current = command.current;
    out.expected_force = command.force;
    key.is_held_back = has(out.faults, Fault::force_limited | Fault::current_limited | Fault::thermal_limited);
    key.passivity.remember(command.force);
    out.surplus = key.passivity.surplus();
    key.given = 0;
    if (out.faults != Fault::none) counters_.add(out.faults);
    result_.faults |= out.faults;
  }

  /// What is to be rendered of the simulated force.
  double passive_force(int k, const KeyOutput& out, bool is_well) noexcept {
    Key& key = key_[k];
    const PassivitySettings& passivity = settings_.passivity;
    // a brake cannot give energy
    if (!passivity.is_on || settings_.actuator.kind == ActuatorKind::mr_brake) return out.simulated_force;
    const bool is_piston = settings_.tick.drive == DriveKind::piston, was_acting = key.passivity.is_acting();
    const double stretch = is_piston ? std::max(out.piston.value - key.y, 0.0) : 0.0;
    const auto stored = [&] {
      return 0.5 * (key.passivity.is_acting() ? passivity.safe_coupling : settings_.coupling).stiffness * stretch *
             stretch;
    };
    // a force that is fading has little to do with the simulated one
    if (is_well && key.guard.fade() == 1) {
      key.passivity.observe(passivity, period_, noise_energy_,
                            {out.piston.value - key.way_from, key.given, stored(), key.is_held_back});
    } else {
      key.passivity.restart(passivity, stored());
    }
    const bool is_acting = key.passivity.act(passivity, period_, out.simulated_force == 0);
    if (is_acting != was_acting && is_piston) {
      keyboard_.exchange_model(k, is_acting ? kSafe : kNormal);
      key.passivity.restart(passivity, stored());
    }
    if (is_acting) output_[k].faults |= Fault::passivity_acted;
    const double damping = is_acting && !is_piston ? passivity.safe_coupling.damping : 0.0;
    return out.simulated_force + damping * out.piston.rate;
  }

  RenderSettings settings_;
  ActionRoles roles_;
  double period_;        // [s]
  double noise_energy_;  // n of Passivity [J]
  MessageWatch message_watch_;
  std::int64_t last_period_ = 0;  // host time [ns]
  Keyboard keyboard_;
  KeyboardPlayer* player_ = nullptr;
  std::vector<Key> key_;
  std::vector<DriveSample> input_;
  std::vector<KeyOutput> output_;
  std::vector<HammerEvent> blow_;
  int blow_count_ = 0;
  const PositionMessage* message_ = nullptr;  // of this period; null: none
  bool is_first_ = false;                     // it began the stream anew
  std::uint64_t between_ = 0;                 // messages between it and the one used before
  std::int64_t accepted_messages_ = 0;
  FaultCounters counters_;
  std::uint64_t lost_messages_ = 0;
  PeriodOutput result_;
};

}  // namespace erard
