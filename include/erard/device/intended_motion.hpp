// What a finger means to do: motions for the virtual device, as keystrokes of position.
#pragma once

#include "erard/device/keystroke.hpp"

namespace erard {

/// A finger that waits at 0 for `rest`, goes down to `depth` within `press`, and stays there until `rest + press + hold`.
/// Down the smoothest way: depth (10 s^3 - 15 s^4 + 6 s^5), which is the least jerk between two rests. [s], [m]
/// Throws std::invalid_argument when a duration is not positive.
Keystroke press_and_hold(double depth, double rest, double press, double hold);

/// `count` equal notes, `rate_Hz` a second. Each goes down and up by least jerk, stays down for `dwell` and up for the
/// rest of its time; down and up take `travel` each. [m], [s]
/// Throws std::invalid_argument when a note has no time for that.
Keystroke repeated_notes(double depth, double rate_Hz, int count, double travel, double dwell);

}  // namespace erard
