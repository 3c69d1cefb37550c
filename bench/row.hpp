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
  int threads = 1;
  bool may_sleep = false;  // keys that rest are left alone
  FeltModel felts = FeltModel::massless;
  std::string lanes = "off";
  std::string setting;
  int substeps = 1;
  Distribution tick;         // one period of all keys
  Distribution step;         // one internal step; of one key only
  Distribution undisturbed;  // the tick, each of the scene at its fastest of all passes; empty: fewer than five
  Distribution noise;        // the fixed work, once after every period
  double iterations =
      Distribution::kNone;              // a step of one key: Newton linearisations; of a peer its solver's iterations
  double sweeps = Distribution::kNone;  // a step of one key; NaN: the solver has none
  double asleep = 0;                    // keys, on average
  long not_converged = 0;               // periods of a key with a step that reached a limit
  Error error;  // up to the release, against 100 internal steps a period of 2 kHz of the same engine

  /// Against the peer with the same steps: median of the tick; undisturbed, all ticks of the scene together. NaN: there
  /// is none.
  double times_peer_median = Distribution::kNone;
  double times_peer_undisturbed = Distribution::kNone;

  /// Share of the period that all but one of a thousand ticks (or all, where that is not stated) keep to [-].
  double share() const { return tick.tail() * rate_Hz; }
  /// Simulated over computing time [-].
  double real_time_factor() const { return static_cast<double>(tick.count) / (rate_Hz * tick.total); }
};

/// Which row is meant. `setting` "cheapest" or "default" finds "both" as well.
struct RowKey {
  std::string scene;
  int keys = 1;
  double rate_Hz = 2000;
  std::string setting;
  int threads = 1;
  Engine engine = Engine::erard;
  FeltModel felts = FeltModel::massless;
};

/// Null when there is none.
const Row* find_row(const std::vector<Row>& rows, const RowKey& key);

/// Fills in how erard's rows compare with the peer's.
void compare_with_peers(std::vector<Row>& rows);

}  // namespace erard::bench
