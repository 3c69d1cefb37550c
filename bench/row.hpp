// One line of the results.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy.hpp"
#include "bench/distribution.hpp"
#include "bench/plan.hpp"

namespace erard::bench {

/// What was measured of one entrant. Times in s.
struct Row {
  Engine engine = Engine::erard;
  std::string scene;
  int keys = 1;
  int played = 1;  // of the keys
  double rate_Hz = 2000;
  std::string setting;
  int substeps = 1;
  Distribution tick;         // one period of all keys
  Distribution step;         // one internal step; of one key only
  Distribution undisturbed;  // the tick, each of a scene of one key at its fastest; empty: fewer than five passes
  Distribution noise;        // the fixed work, once after every period
  double iterations = 0;     // a step: Newton linearisations; of a peer its solver's iterations
  double sweeps = 0;         // a step; NaN: the solver has none
  long not_converged = 0;    // periods of a key with a step that reached a limit
  Error error;               // up to the release, against 100 internal steps a period of 2 kHz of the same engine

  /// Against the peer with the same steps: median of the tick; undisturbed, all ticks of the scene together. NaN: there
  /// is none.
  double times_peer_median = Distribution::kNone;
  double times_peer_undisturbed = Distribution::kNone;

  /// Share of the period that all but one of a thousand ticks (or all, where that is not stated) keep to [-].
  double share() const { return tick.tail() * rate_Hz; }
  /// Simulated over computing time [-].
  double real_time_factor() const { return static_cast<double>(tick.count) / (rate_Hz * tick.total); }
};

/// Fills in how erard's rows compare with the peer's.
void compare_with_peers(std::vector<Row>& rows);

}  // namespace erard::bench
