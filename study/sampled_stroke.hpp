// Strokes given by a formula, played on the default action: what several studies need.
#pragma once

#include <functional>
#include <vector>

#include "erard/device/simulation.hpp"
#include "study/defaults.hpp"

namespace erard::study {

/// A run with all its rows.
struct SampledStroke {
  RunResult result;
  std::vector<Snapshot> rows;  // one a period, the start included
};

/// Keystroke through value(t) at 0, spacing, 2 spacing ... up to `duration` [s]. The spline between samples follows a
/// corner of value(t) to within a sample or two.
Keystroke sampled_keystroke(KeystrokeQuantity quantity, double duration, double spacing,
                            const std::function<double(double)>& value);

/// Settings of a run at `rate_Hz` rows a second.
/// @param internal_steps  a period; 0: as few as keep the internal step at its default or below
TickSettings tick_at(DriveKind drive, double rate_Hz, int internal_steps = 0);

/// Plays the whole keystroke from rest.
SampledStroke play_sampled(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick);

/// First event of that kind, or null.
const Event* first_event(const std::vector<Event>& events, EventKind kind);

}  // namespace erard::study
