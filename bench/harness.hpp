// Plays the plan in front of the clock.
#pragma once

#include <functional>
#include <vector>

#include "bench/row.hpp"

namespace erard::bench {

/// Asked all the time, never while the clock runs: `done` is the share of the plan that is done. No: stop here.
using Monitor = std::function<bool(double done)>;

struct Harness {
  const Stage& stage;
  double clock_overhead;         // [s]
  bool leaves_room;              // real-time scheduling: sleep between ticks now and then, see Breather
  std::vector<int> worker_cpus;  // for threads beyond the first
  Monitor goes_on;
};

/// Rows in the order of the plan. Stopped early: rows of what had been timed, each whole in itself.
/// Throws std::runtime_error when an engine loses its numbers.
std::vector<Row> measure(const Harness& harness, const std::vector<Match>& plan);

}  // namespace erard::bench
