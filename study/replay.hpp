// Strokes kept in memory, and the force of one as the input of another (thesis 6.3: "force-driven").
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "erard/device/simulation.hpp"
#include "study/defaults.hpp"
#include "study/study_step.hpp"

namespace erard::study {

/// Output rate of these strokes [Hz]: a row after every internal step of the default length, so that the force which is
/// replayed is the one that acted there.
inline constexpr double kReplayRate = 1 / kStudyStep;

/// A run with all its rows.
struct PlayedStroke {
  RunResult result;
  std::vector<Snapshot> row;  // kReplayRate of them a second, the first at the start of the keystroke

  const Event* find(EventKind kind) const;   // the first of that kind, or null
  const Event& event(EventKind kind) const;  // the same; throws std::runtime_error when there is none
  const Snapshot& at(double time) const;     // the row nearest to `time` [s]
};

/// Plays a keystroke from rest up to `end` [s].
PlayedStroke play(const ActionFile& action, const Keystroke& keystroke, DriveKind drive, double end);

/// The finger's force as a keystroke: driven by it, the same action must move as it did.
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

/// Relative error of a quantity of one stroke against a reference, up to `end` [s]. Both have the same rows, evenly
/// spaced: the integrals are sums.
///   eta = integral |x_ref - x| dt / integral |x_ref| dt                          thesis (6.3)
template <typename Quantity>
double relative_error(const PlayedStroke& reference, const PlayedStroke& stroke, double end, const Quantity& x) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < reference.row.size() && i < stroke.row.size() && reference.row[i].time <= end; ++i) {
    difference += std::abs(x(reference.row[i]) - x(stroke.row[i]));
    size += std::abs(x(reference.row[i]));
  }
  return size > 0 ? difference / size : 0;
}

/// Largest difference of a quantity of two strokes up to `end` [s].
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
