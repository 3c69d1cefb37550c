// How fast the action repeats.
#pragma once

#include <vector>

#include "erard/device/action_file.hpp"

namespace erard::study {

inline constexpr int kRepeatedStrokes = 10;  // in a run of the limit

/// Strokes of a piston that swings between two positions as a raised cosine; the first starts from rest.
///   Y = top + (bottom - top) (1 - cos 2 pi f t) / 2
/// The finger cannot pull: above the key it has left it.
struct RepeatedStroke {
  double top = 0;          // where the finger turns, below 0 above the resting key [m]
  double bottom = 0.0112;  // where it turns at the front rail [m]
};

/// A stroke sounds when the hammer meets the string in its own period with at least the softest speed that Goebl et al.
/// (2005) measured, 0.18 m/s.
struct RepeatedRun {
  int sounding = 0;   // strokes
  int late_jack = 0;  // silent strokes for which the jack was not back under the knuckle after the last impact when 0.4
                      // of their period had gone, where the others meet the string
  double farthest = 0;  // hammer from string, at most [m]; at rest 0.046
};
RepeatedRun play_repeated(const ActionFile& action, const RepeatedStroke& stroke, double rate_Hz, int strokes);

struct RepetitionLimit {
  double rate = 0;      // highest below which every rate tried sounds all strokes [Hz]; 0: not even 8 Hz
  RepeatedRun at;       // at that rate
  double beyond = 0;    // lowest rate that does not, within 1/64 Hz of the other [Hz]; 0: all up to 30 Hz
  RepeatedRun failing;  // at that one
};

/// Raises the rate from 8 Hz in steps of 0.5 Hz until one of ten strokes stays silent, then halves the step five times.
RepetitionLimit find_repetition_limit(const ActionFile& action, const RepeatedStroke& stroke);

}  // namespace erard::study
