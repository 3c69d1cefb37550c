// Many keys in one period of the host: inputs in, forces out; a key at rest costs a comparison.
#pragma once

#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "erard/haptics/sleep.hpp"
#include "erard/haptics/step_budget.hpp"
#include "erard/haptics/tick.hpp"
#include "erard/mechanics/rest.hpp"

namespace erard {

/// Drive during one period: straight lines from the sample before to the newest, for value and rate alike.
struct LineInput {
  DriveSample from, to;
  double start = 0;   // [s]
  double period = 1;  // [s]

  DriveSample at(double time) const noexcept {
    const double part = (time - start) / period;
    return {from.value + part * (to.value - from.value), from.rate + part * (to.rate - from.rate)};
  }
};

/// One period of one key that is awake.
struct Turn {
  int key = 0;
  int model = 0;  // number of its mechanism among those that differ
  LineInput input;
  State* state = nullptr;
  TickReport report;  // of whoever plays it
};

/// n actions that share a clock, settings and nothing else. Memory: a Mechanism (18 kB) for each different model, for
/// each key two States (3.3 kB) and 32 bytes to look at, one Workspace (100 kB).
///
/// A key falls asleep after SleepSettings::calm_ticks periods in which neither its state nor its force changed, and keeps
/// its state, force and status; time goes on. It wakes with the first input that differs from the last. A piston that does
/// not reach the key may move as it likes meanwhile. An unstable balance that holds for so many periods counts as rest.
///
/// Once built: no heap, no exceptions, no locks. Same inputs, same bits, however the keys are shared out to threads.
class Keyboard {
 public:
  /// @param count       of equal keys
  /// @param most_steps  of all keys together, in a period
  Keyboard(const Model& model, int count, const TickSettings& settings, const SleepSettings& sleep = {},
           int most_steps = StepBudget::kUnbounded)
      : Keyboard(std::span(&model, 1), std::vector<int>(static_cast<std::size_t>(count), 0), settings, sleep,
                 most_steps) {}

  /// @param models        the different ones, all valid
  /// @param model_of_key  for each key the number of its model
  Keyboard(std::span<const Model> models, std::span<const int> model_of_key, const TickSettings& settings,
           const SleepSettings& sleep = {}, int most_steps = StepBudget::kUnbounded)
      : settings_(settings),
        budget_(settings, most_steps),
        sleep_(sleep),
        watch_(model_of_key.size()),
        force_(model_of_key.size(), 0.0),
        status_(model_of_key.size(), StepStatus::converged),
        work_(std::make_unique<Workspace>()) {
    for (const Model& model : models) mechanism_.push_back(build_mechanism(model));
    for (const int number : model_of_key) {
      assert(number >= 0 && number < static_cast<int>(models.size()));
      Key& key = key_.emplace_back();
      key.mechanism = number;
      key.state = rest_state(mechanism_[number], settings.scheme.time_step);
    }
  }

  int size() const noexcept { return static_cast<int>(key_.size()); }
  const TickSettings& settings() const noexcept { return settings_; }
  const StepBudget& budget() const noexcept { return budget_; }

  /// Advances all keys by one period.
  /// @param inputs    for each key value and rate at the end of the period; what was given last is where it starts,
  ///                  {0, 0} the first time
  /// @param observer  called as observer(key, state, report, force) after each internal step of a key that is awake,
  ///                  noexcept
  /// @return force of the finger on each key at the end of the period [N]
  /// Where an input or a result is not finite, the status of the key says so, its state stays as it was, its force is 0
  /// when no step was taken, and the next good input goes on from the last good one.
  template <typename Observer>
  std::span<const double> tick(std::span<const DriveSample> inputs, Observer&& observer) noexcept {
    begin_tick(inputs);
    tick_share(0, 1, inputs, *work_, observer);
    end_tick();
    return force_;
  }
  std::span<const double> tick(std::span<const DriveSample> inputs) noexcept {
    return tick(inputs, [](int, const State&, const StepReport&, double) noexcept {});
  }

  /// Wakes the keys that the inputs concern.
  void begin_tick(std::span<const DriveSample> inputs) noexcept {
    assert(inputs.size() == key_.size());
    Watch* const watch = watch_.data();
    int awake = 0;
    for (int k = 0; k < size(); ++k) {
      if (watch[k].is_asleep && sleeps_on(k, inputs[k])) continue;
      watch[k].is_asleep = false;
      ++awake;
    }
    budget_.choose(awake);
  }

  /// The same for the keys share, share + shares, share + 2 shares .. only: different shares may be advanced at the same
  /// time by different threads, each with a Workspace of its own. Before the first of them begin_tick(), after the last
  /// end_tick(), which moves the clock.
  template <typename Observer>
  void tick_share(int share, int shares, std::span<const DriveSample> inputs, Workspace& work,
                  Observer&& observer) noexcept {
    const Watch* const watch = watch_.data();
    for (int k = share; k < size(); k += shares)
      if (!watch[k].is_asleep) play(k, inputs[k], work, observer);
  }
  void end_tick() noexcept { ++ticks_; }

  /// The same by somebody who plays many keys together.
  /// @param play   called as play(turns), noexcept; does with each of them what erard::tick() does
  /// @param turns  scratch, with room for all keys of the share
  template <typename Play>
  void tick_share_by(Play&& play, int share, int shares, std::span<const DriveSample> inputs,
                     std::span<Turn> turns) noexcept {
    std::size_t count = 0;
    for (int k = share; k < size(); k += shares)
      if (!watch_[k].is_asleep) turns[count++] = begin_turn(k, inputs[k]);
    play(turns.first(count));
    for (const Turn& turn : turns.first(count)) end_turn(turn.key, inputs[turn.key], turn.report);
  }

  /// From the next period on a key is an action of another of the models, in the state that it has: they may differ in
  /// numbers, not in bodies and contacts.
  void exchange_model(int key, int number) noexcept {
    key_[key].mechanism = number;
    key_[key].calm_ticks = 0;
    watch_[key].is_asleep = false;
  }

  double time() const noexcept { return static_cast<double>(ticks_) * settings_.period; }  // [s]
  std::span<const double> forces() const noexcept { return force_; }                       // [N]
  std::span<const StepStatus> statuses() const noexcept { return status_; }  // of the last period each was awake
  bool is_asleep(int key) const noexcept { return watch_[key].is_asleep; }
  int asleep_count() const noexcept {
    return static_cast<int>(std::count_if(watch_.begin(), watch_.end(), [](const Watch& w) { return w.is_asleep; }));
  }

  const Mechanism& mechanism(int key) const noexcept { return mechanism_[key_[key].mechanism]; }
  std::span<const Mechanism> mechanisms() const noexcept { return mechanism_; }  // that differ, by Turn::model

  /// State of a key now, asleep or not.
  State state(int key) const noexcept {
    State now = key_[key].state;
    now.time = time();
    return now;
  }

 private:
  struct Watch {  // what a resting key is looked at by, close together
    DriveSample last;
    double air = 0;  // load of a piston that leaves the sleeper alone, at most [N]
    bool is_asleep = false;
  };
  struct alignas(64) Key {  // no cache line belongs to two of them
    int mechanism = 0;
    State state;
    int calm_ticks = 0;     // so far
    State rest;             // at the first of them
    double rest_force = 0;  // of the finger, then [N]
  };

  bool sleeps_on(int k, const DriveSample& input) noexcept {
    Watch& watch = watch_[k];
    if (is_same(input, watch.last)) return true;
    const double load = piston_load(mechanism(k).model.finger, input);
    if (!(load <= watch.air && load >= std::numeric_limits<double>::lowest())) return false;
    watch.last = input;
    return true;
  }

  Turn begin_turn(int k, const DriveSample& input) noexcept {
    Key& key = key_[k];
    key.state.time = time();
    return {k, key.mechanism, {watch_[k].last, input, time(), settings_.period}, &key.state, {}};
  }

  void end_turn(int k, const DriveSample& input, const TickReport& report) noexcept {
    force_[k] = report.force;
    status_[k] = report.status;
    if (report.status != StepStatus::not_finite) watch_[k].last = input;
    if (sleep_.is_on) fall_asleep(k, report.status == StepStatus::converged);
  }

  template <typename Observer>
  void play(int k, const DriveSample& input, Workspace& work, Observer&& observer) noexcept {
    const Turn turn = begin_turn(k, input);
    end_turn(
        k, input,
        erard::tick(mechanism_[turn.model], budget_.settings(), turn.input, *turn.state, work,
                    [&](const State& s, const StepReport& r, double force) noexcept { observer(k, s, r, force); }));
  }

  /// Load up to which a piston leaves the key alone where it is; none does where something else drives it.
  double quiet_load(int k) const noexcept {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (settings_.drive == DriveKind::none) return kInfinity;
    const Model& model = mechanism(k).model;
    if (settings_.drive != DriveKind::piston || model.finger.body == kGround) return -kInfinity;
    return air_load(model, key_[k].state);
  }

  /// Counts ticks at rest. The input needs no look: what it does shows in the force, and the next one that differs wakes.
  void fall_asleep(int k, bool is_converged) noexcept {
    Key& key = key_[k];
    if (!is_converged || !is_still(sleep_, key.state)) {
      key.calm_ticks = 0;
      return;
    }
    if (key.calm_ticks == 0 || !is_same_rest(sleep_, key.rest, key.state) ||
        !(std::abs(force_[k] - key.rest_force) <= sleep_.force)) {
      key.calm_ticks = 0;
      key.rest = key.state;
      key.rest_force = force_[k];
    }
    if (++key.calm_ticks <= sleep_.calm_ticks) return;
    key.calm_ticks = 0;
    watch_[k].is_asleep = true;
    watch_[k].air = force_[k] <= sleep_.force ? quiet_load(k) : -std::numeric_limits<double>::infinity();
  }

  TickSettings settings_;
  StepBudget budget_;
  SleepSettings sleep_;
  long ticks_ = 0;
  std::vector<Mechanism> mechanism_;  // one for each model
  std::vector<Watch> watch_;          // one for each key, as all that follow
  std::vector<Key> key_;
  std::vector<double> force_;  // [N]
  std::vector<StepStatus> status_;
  std::unique_ptr<Workspace> work_;
};

/// Somebody who advances a keyboard by the same steps in another way: KeyLanes of erard::lanes.
class KeyboardPlayer {
 public:
  /// Called after each internal step of a key.
  using Observer = void (*)(void* context, int key, const State& state, const StepReport& report,
                            double force) noexcept;
  virtual ~KeyboardPlayer() = default;
  /// As Keyboard::tick(), which see.
  virtual std::span<const double> tick(std::span<const DriveSample> inputs, Observer observer,
                                       void* context) noexcept = 0;
};

}  // namespace erard
