// When things happen in a keystroke, by the definitions of the measurements on grands.
#pragma once

#include <limits>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/keystroke.hpp"
#include "erard/haptics/events.hpp"
#include "erard/solver/drive.hpp"

namespace erard::study {

/// Key and hammer over time, equally long.
struct StrokeTrace {
  std::vector<double> time;          // [s]
  std::vector<double> key;           // y [m], down positive
  std::vector<double> key_speed;     // y' [m/s]
  std::vector<double> hammer_speed;  // of the head, towards the string [m/s]
};

/// Instants of one stroke [s], hammer speeds [m/s]; NaN where the stroke has none.
struct StrokeTimes {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double finger_key = kNone;     // the key has moved by kKeyStart
  double hammer_string = kNone;  // first force at the string
  double key_bottom = kNone;     // first force of the front rail punching
  double key_braked = kNone;     // the key has lost half the speed with which it met the punching
  double escapement = kNone;     // the jack leaves the knuckle for the last time before the string
  double fastest = kNone;        // the hammer is fastest, before the string
  double maximum_speed = kNone;  // then: the "maximum hammer velocity" of Goebl et al.
  double free_way = kNone;       // of the hammer from the escapement to the string [m]
  double string_speed = kNone;   // at the string

  double travel() const noexcept { return hammer_string - finger_key; }
  double bottom() const noexcept { return key_bottom - hammer_string; }   // positive: after the string
  double braked() const noexcept { return key_braked - hammer_string; }   // the same, braked
  double flight() const noexcept { return hammer_string - fastest; }      // from the greatest speed on
  double release() const noexcept { return hammer_string - escapement; }  // from the jack's release on
  double free_hammer_way() const noexcept { return free_way; }            // [m]
};

/// Key travel at which the stroke counts as begun [m]: the resolution of all-key position sensing in research (Oku and
/// Furuya, Sensors 22(13):4891, 2022).
inline constexpr double kKeyStart = 1e-5;

/// Finds them. The events are those of the same stroke; of several strikes the first counts.
/// @param key_start  [m]
StrokeTimes time_stroke(const StrokeTrace& trace, const std::vector<Event>& events, double key_start = kKeyStart);

/// A stroke played from rest at the default internal step, with a row for each.
struct TracedStroke {
  StrokeTrace trace;
  std::vector<Event> events;
};
TracedStroke trace_stroke(const ActionFile& action, const Keystroke& keystroke, DriveKind drive);

}  // namespace erard::study
