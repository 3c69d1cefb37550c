// The grand action and its keystrokes, played in a test.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/keystroke_input.hpp"
#include "erard/device/results.hpp"
#include "erard/erard.hpp"

namespace erard::test {

inline ActionFile grand_action(const ActionOptions& options = {}) {
  return load_action(std::filesystem::path(ERARD_CONFIG_DIR) / "grand_action.yaml", options);
}

inline Keystroke keystroke(const std::string& name) {
  return read_keystroke(std::filesystem::path(ERARD_CONFIG_DIR) / "keystrokes" / (name + ".csv"));
}

/// Settings of `erard-sim` without options.
inline TickSettings default_tick(DriveKind drive = DriveKind::piston) {
  TickSettings settings;
  settings.drive = drive;
  settings.set_rate(2000);
  return settings;
}

/// Everything of one run, in memory.
struct Stroke {
  RunResult result;
  std::vector<Snapshot> row;

  ForceCurve force() const {
    ForceCurve curve;
    for (const Snapshot& r : row) {
      curve.time.push_back(r.time);
      curve.force.push_back(r.force);
    }
    return curve;
  }
  /// The n-th event of a kind (from 0), or null.
  const Event* find(EventKind kind, int n = 0) const {
    for (const Event& event : result.events)
      if (event.kind == kind && n-- == 0) return &event;
    return nullptr;
  }
};

inline Stroke play(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick = default_tick(),
                   double duration = 0) {
  Stroke stroke;
  RunSettings settings;
  settings.tick = tick;
  settings.duration = duration > 0 ? duration : keystroke.end() - keystroke.start();
  settings.start = keystroke.start();
  settings.on_row = [&stroke](const Snapshot& row) { stroke.row.push_back(row); };
  stroke.result = run(action, keystroke, settings);
  return stroke;
}

/// Largest difference of the force of two runs, and its root mean square, over the rows up to `end`.
struct Difference {
  double rms = 0, largest = 0;
};
inline Difference difference(const Stroke& a, const Stroke& b, double end) {
  Difference d;
  int n = 0;
  for (std::size_t i = 0; i < a.row.size() && i < b.row.size() && a.row[i].time <= end; ++i, ++n) {
    const double e = a.row[i].force - b.row[i].force;
    d.rms += e * e;
    d.largest = std::max(d.largest, std::abs(e));
  }
  d.rms = std::sqrt(d.rms / std::max(n, 1));
  return d;
}

}  // namespace erard::test
