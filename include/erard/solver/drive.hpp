// What moves the mechanism during one step.
#pragma once

namespace erard {

enum class DriveKind {
  none,    // nobody touches the key
  force,   // value: force of the finger [N], down positive
  piston,  // value: position Y of the free end of the Kelvin-Voigt element [m]   thesis 5.4.1
  key,     // value: displacement y of the key [m]; its reaction is the result
};

/// Value and rate of the driving quantity at one instant; down positive.
struct DriveSample {
  double value = 0;  // [m] or [N]
  double rate = 0;   // [m/s] or [N/s]
};

struct Drive {
  DriveKind kind = DriveKind::none;
  DriveSample from;  // at the start of the step
  DriveSample to;    // at its end
};

}  // namespace erard
