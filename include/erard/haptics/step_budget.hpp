// What the keys of a keyboard may cost together in one period.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "erard/haptics/tick.hpp"

namespace erard {

/// How hard the keys of a keyboard are computed in one period: less when many are awake, so that what a period costs has a
/// bound that no playing exceeds. From the most exact on:
///   as set      substeps, each split where its scheme refuses it
///   unsplit     substeps
///   one step    of the whole period
/// Taken is the first of them whose steps, at their most, do not exceed the budget for the keys that are awake; the last
/// one where none does. It is the same for all of them, and chosen before the first is played: threads and lanes see the
/// same.
class StepBudget {
 public:
  static constexpr int kUnbounded = std::numeric_limits<int>::max();

  /// @param most_steps  of all keys together, in a period
  StepBudget(const TickSettings& settings, int most_steps) noexcept
      : levels_{settings, settings, settings}, most_steps_(most_steps) {
    levels_[1].set_rate(1 / settings.period, settings.substeps);
    levels_[2].set_rate(1 / settings.period, 1);
  }

  void choose(int awake) noexcept {
    level_ = 0;
    while (level_ < kLevels - 1 && awake > most_steps_ / most_steps_of(levels_[level_])) ++level_;
  }
  int level() const noexcept { return level_; }
  const TickSettings& settings() const noexcept { return levels_[level_]; }
  std::span<const TickSettings> levels() const noexcept { return levels_; }

 private:
  static constexpr int kLevels = 3;
  static int most_steps_of(const TickSettings& settings) noexcept {
    return settings.substeps * (settings.refinement > 1 ? 1 + settings.refinement : 1);
  }

  std::array<TickSettings, kLevels> levels_;
  int most_steps_;
  int level_ = 0;
};

}  // namespace erard
