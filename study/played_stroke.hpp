// Strokes played on an action and kept in memory, and what several studies ask of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "erard/device/force_curve.hpp"
#include "erard/device/simulation.hpp"
#include "study/defaults.hpp"

namespace erard::study {

/// Fixed internal step of the runs whose rows are looked at one by one or replayed [s]: forte within 0.05 N rms.
inline constexpr double kStudyStep = 1.25e-4;

/// Settings of a run at `rate_Hz` rows a second.
/// @param internal_steps  a period, fixed; 0: as erard-sim takes them
TickSettings tick_at(DriveKind drive, double rate_Hz, int internal_steps = 0);

/// A row after each fixed internal step, so that a force which is replayed is the one that acted there.
inline TickSettings study_tick(DriveKind drive) { return tick_at(drive, 1 / kStudyStep, 1); }

/// Keystroke through value(t) at 0, spacing, 2 spacing ... up to `duration` [s]. The spline between samples follows a
/// corner of value(t) to within a sample or two.
Keystroke sampled_keystroke(KeystrokeQuantity quantity, double duration, double spacing,
                            const std::function<double(double)>& value);

/// First event of that kind, or null.
const Event* first_event(const std::vector<Event>& events, EventKind kind);

/// A run with all its rows.
struct PlayedStroke {
  RunResult result;
  std::vector<Snapshot> row;  // one a period, the first at the start of the keystroke

  const Event* find(EventKind kind) const { return first_event(result.events, kind); }
  const Event& event(EventKind kind) const;  // the first; throws std::runtime_error when there is none
  const Snapshot& at(double time) const;     // the row nearest to `time` [s]
};

/// Plays a keystroke from rest, all of it or up to `end` [s].
PlayedStroke play(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick);
PlayedStroke play(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick, double end);

/// The finger's force as a keystroke: driven by it, the same action must move as it did (thesis 6.3: "force-driven").
Keystroke force_of(const PlayedStroke& stroke);

/// The row with the largest force before the jack meets the let-off button.
const Snapshot& hardest_push(const PlayedStroke& stroke);

/// One of the two strokes of thesis 6.2 and 6.3. The measured Y is not published: the keystrokes are reconstructions.
struct StrokeCase {
  const char* name;  // of its file in config/keystrokes
  double release;    // up to which the thesis takes its errors [s]                 thesis 6.4.1, footnote 3
};
inline constexpr StrokeCase kPiano{"piano", 0.22}, kForte{"forte", 0.13};

// Quantities of a row, for the functions below.
inline double finger_force(const Snapshot& row) { return row.force; }         // [N]
inline double key_position(const Snapshot& row) { return row.key_position; }  // [m]

/// A quantity over time, whatever its unit.
template <typename Quantity>
ForceCurve curve_of(const PlayedStroke& stroke, const Quantity& x) {
  ForceCurve curve;
  for (const Snapshot& row : stroke.row) {
    curve.time.push_back(row.time);
    curve.force.push_back(x(row));
  }
  return curve;
}

/// Relative error (6.3) of a quantity of one stroke against a reference, up to `end` [s].
template <typename Quantity>
double relative_error(const PlayedStroke& reference, const PlayedStroke& stroke, double end, const Quantity& x) {
  return relative_error(curve_of(reference, x), curve_of(stroke, x), end);
}

/// Largest difference of a quantity of two strokes with the same instants, up to `end` [s].
template <typename Quantity>
double largest_difference(const PlayedStroke& a, const PlayedStroke& b, double end, const Quantity& x) {
  double largest = 0;
  for (std::size_t i = 0; i < a.row.size() && i < b.row.size() && a.row[i].time <= end; ++i)
    largest = std::max(largest, std::abs(x(a.row[i]) - x(b.row[i])));
  return largest;
}

/// Largest less smallest value of a quantity between two times [s].
template <typename Quantity>
double spread(const PlayedStroke& stroke, double from, double until, const Quantity& x) {
  double least = INFINITY, most = -INFINITY;
  for (const Snapshot& row : stroke.row) {
    if (row.time < from || row.time > until) continue;
    least = std::min(least, x(row));
    most = std::max(most, x(row));
  }
  return most - least;
}

/// Points of a plot: times in ms, the quantity times `scale`, every `stride`-th row.
struct Points {
  std::vector<double> x, y;
};
template <typename Quantity>
Points points_of(const PlayedStroke& stroke, double end, const Quantity& x, double scale, std::size_t stride = 4) {
  Points points;
  for (std::size_t i = 0; i < stroke.row.size() && stroke.row[i].time <= end; i += stride) {
    points.x.push_back(1e3 * stroke.row[i].time);
    points.y.push_back(scale * x(stroke.row[i]));
  }
  return points;
}

}  // namespace erard::study
