// Many keys of one action, one after the other. All that the harness knows of many keys is here: a keyboard that lets
// keys sleep or steps several at once takes the place of this loop.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "bench/contender.hpp"
#include "erard/haptics/tick.hpp"
#include "erard/mechanics/rest.hpp"

namespace erard::bench {

/// One State a key; the Workspace, nothing of which outlives a step, serves all of them: one for each would send 88 times
/// 0.1 MB through the cache, and cost 7 to 15 % more.
class Keyboard {
 public:
  Keyboard(const Mechanism& mechanism, const TickSettings& settings, std::vector<Part> parts)
      : mechanism_(mechanism), settings_(settings), parts_(std::move(parts)), origin_(parts_.size(), 0.0) {
    keys_.assign(parts_.size(), rest_state(mechanism_, settings_.scheme.time_step));
    for (std::size_t k = 0; k < keys_.size(); ++k)
      if (parts_[k].period > 0 && origin_[k] == 0) bring_to_phase(k);
    start_ = keys_;
  }

  void start() {
    keys_ = start_;
    ticks_ = 0;
  }

  Effort tick(StepClock steps) noexcept {
    Effort effort;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      const TickReport report =
          erard::tick(mechanism_, settings_, parts_[k], keys_[k], work_,
                      [&steps](const State&, const StepReport&, double) noexcept { steps.mark(); });
      effort.iterations += report.linearisations;
      effort.sweeps += report.sweeps;
      effort.steps += report.steps;
      effort.not_converged += report.status == StepStatus::not_converged;
      effort.is_finite = effort.is_finite && report.status != StepStatus::not_finite;
      if (k == 0) force_ = report.force;
    }
    ++ticks_;
    for (std::size_t k = 0; k < keys_.size(); ++k)  // no drift by rounding
      keys_[k].time = origin_[k] + static_cast<double>(ticks_) * settings_.period;
    return effort;
  }

  double force() const noexcept { return force_; }  // of the first key [N]

 private:
  /// Plays the part of key k from rest for two periods, and hands out the states of the second to all keys with this
  /// part, each where its own begins.
  void bring_to_phase(std::size_t k) {
    const Part part = parts_[k];
    const long period = std::lround(part.period / settings_.period);  // [ticks]
    State state = keys_[k];
    for (long i = 0; i < 2 * period; ++i) {
      state.time = static_cast<double>(i) * settings_.period;
      for (std::size_t j = 0; j < keys_.size(); ++j) {
        const long begin = period + static_cast<long>(phase_of(static_cast<int>(j)) * static_cast<double>(period));
        if (parts_[j].keystroke != part.keystroke || begin != i) continue;
        keys_[j] = state;
        origin_[j] = state.time;
      }
      erard::tick(mechanism_, settings_, part, state, work_, [](auto&&...) noexcept {});
    }
  }

  const Mechanism& mechanism_;
  TickSettings settings_;
  std::vector<Part> parts_;
  std::vector<double> origin_;  // of each key's time [s]
  std::vector<State> start_, keys_;
  Workspace work_;
  long ticks_ = 0;
  double force_ = 0;
};

}  // namespace erard::bench
