// The recorded keystrokes played as key position: the hammer of the model against the hammer recorded beside the key.
#pragma once

#include <string>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/recording.hpp"
#include "study/section.hpp"

namespace erard::study {

/// Last calibration point of the hammer's sensor, where it clips: 9.5 steps of 1/64 inch, the shank at its stop.
inline constexpr double kHammerFullScale = 3.770e-3;  // [m]

/// A hammer on its way to the string. Ways are fractions of the whole: 0 at rest, 1 at the string or the stop.
struct Arrival {
  double time = 0;        // [s] passes 98 % of the way
  double from = 0;        // [-] lowest in the 60 ms before
  double mean_speed = 0;  // [m/s] from 60 to 90 % of the way; NaN when the hammer does not come from below 60 % in them
  double peak_speed = 0;  // [m/s] highest slope of the cubic through nine samples in the 20 ms before
};

/// Every passage of 98 % of the way after one below 60 %.
/// @param time  [s], uniform
/// @param way   [-] of each instant
/// @param blow  [m] what the whole way is long
std::vector<Arrival> find_arrivals(const std::vector<double>& time, const std::vector<double>& way, double blow);

/// When `values` first rise through `level` between two instants, by a straight line between samples; NaN if never.
double rise_time(const std::vector<double>& time, const std::vector<double>& values, double level, double from,
                 double until);

/// Angles of the model's hammer at rest and where its head touches the string, and the way of the head between them.
struct HammerWay {
  double rest = 0;    // [rad]
  double string = 0;  // [rad]
  double blow = 0;    // [m] along the arc of the head circle's centre
  double fraction(double angle) const { return (angle - rest) / (string - rest); }
};
HammerWay measure_hammer_way(const ActionFile& action);

/// A recorded strike and what the model makes of its key.
struct StrikePair {
  Arrival recorded, predicted;  // predicted.time is NaN when no hammer arrives within 20 ms of the recorded one
  double recorded_bottom = 0;   // [s] when the key passes 99.9 % of its way down
  double predicted_bottom = 0;  // [s]
  double recorded_delay() const { return recorded_bottom - recorded.time; }     // key bottom after hammer [s]
  double predicted_delay() const { return predicted_bottom - predicted.time; }  // [s]
};

/// One recording, on its own instants. Ways are fractions: of the key, of the hammer.
struct RecordingRun {
  std::string recording;
  std::vector<double> time;                               // [s]
  std::vector<double> recorded_key, predicted_key;        // 1: the reading at which the sensor clips; the dip
  std::vector<double> recorded_hammer, predicted_hammer;  // 1: the reading at which the sensor clips; the string
  std::vector<StrikePair> strikes;                        // one for each recorded arrival
};

/// Imports config/recordings/NAME.csv, plays it with the drive `key`, the action's damper as it was loaded.
/// @param dip  [m] what full scale becomes in the model; the shape of the keystroke does not depend on it
/// Throws InputError when the recording cannot be read or has no hammer.
RecordingRun play_recording(const ActionFile& action, const std::string& name, double dip = ImportSettings{}.dip);

/// The strikes that come with erard, and the very slow press.
const std::vector<std::string>& struck_recordings();
inline constexpr const char* kSlowRecording = "s1_very_slow_press_release";

Section recordings_section(const Pictures& pictures);

}  // namespace erard::study
