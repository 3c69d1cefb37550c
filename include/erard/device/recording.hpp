// From the recorded position of a real key to a keystroke the model can play. The method and its figures:
// docs/recordings.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "erard/device/keystroke.hpp"

namespace erard {

/// Position of a key front and of its hammer, uniformly sampled, in the sensors' own scales.
struct Recording {
  double rate = 0;                // samples per second [Hz]
  std::vector<double> times;      // [s]
  std::vector<double> key_front;  // [m] down positive, 0 to the reading at which the sensor clips
  std::vector<double> hammer;     // [m] shank near its flange, up positive; empty if not recorded
};

/// What a conversion may choose. Lengths are in the scale of the recording, except the dip.
struct ImportSettings {
  double dip = 0.0098;           // [m] in the model: where the key meets the front rail, hence what full_scale becomes
  double full_scale = 0.011906;  // [m] reading at which the sensor clips: key-bed contact
  double rest = 0.0005;      // [m] a movement reaches beyond this; a reading below says no more than "less than this"
  double slow_cutoff = 15;   // [Hz] of the smoothing where the key is slow; applies at the noise of rest
  double fast_cutoff = 350;  // [Hz] where it is fast
  double fast_speed = 0.25;  // [m/s] what counts as fast; the cutoff is proportional to the speed below it
  double press = 0.0002;     // [m] how far a finger is expected to press beyond full_scale
};

/// What a conversion did. Speeds and lengths in the scale of the recording.
struct ImportFigures {
  int sample_count = 0;
  int clipped_count = 0;      // samples at full_scale
  int rest_count = 0;         // samples that became exactly zero
  int movement_count = 0;     // stretches between rests
  double onset = 0;           // [s] end of the first rest
  double deepest_press = 0;   // [m] most the key went beyond full_scale
  double residual_low = 0;    // [m] rms of output minus recording, readings from `rest` to a third of full_scale
  double residual_high = 0;   // [m] rms of the same above, clipped readings apart
  double recorded_speed = 0;  // [m/s] peak downward speed of the recording, by the local cubic of peak_speed()
  double kept_speed = 0;      // [m/s] the same of the output, clipped as the sensor clips
  double peak_rate = 0;       // [m/s] peak downward rate of the output
};

struct Import {
  Keystroke keystroke;  // [m] in the model's scale, to the nanometre, on the times of the recording
  ImportFigures figures;
};

/// Reads a CSV file with the columns `t_s`, `key_front_mm` and, if present, `hammer_sensor_mm`.
/// Throws InputError when the file is not like that, when its samples are not uniform, and when a value is not finite.
Recording read_recording(const std::filesystem::path& file);

/// Turns a recording into a keystroke: at rest exactly zero, smooth where it moves, at or beyond the dip where the
/// sensor clips. Same recording and settings: same keystroke to the last bit.
/// @param file  name of the recording, for complaints
/// Throws InputError when the settings are impossible, when the recording does not start at rest or never moves, or
/// when it goes beyond full_scale.
Import import_recording(const Recording& recording, const ImportSettings& settings, const std::filesystem::path& file);

/// Peak downward speed [m/s] of uniform samples: slope of the cubic through nine neighbours (Savitzky and Golay), which
/// passes a strike and damps the noise of single samples.
double peak_speed(const std::vector<double>& positions, double rate);

/// The lines that say, on top of the keystroke's file, what was done: `command`, conversion and figures.
std::vector<std::string> describe_import(const ImportSettings& settings, const ImportFigures& figures,
                                         const std::string& command);

}  // namespace erard
