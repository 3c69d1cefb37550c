// What moves the mechanism during one step.
#pragma once

#include <cmath>

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

inline bool is_finite(const Drive& drive) noexcept {
  return std::isfinite(drive.from.value) && std::isfinite(drive.from.rate) && std::isfinite(drive.to.value) &&
         std::isfinite(drive.to.rate);
}

}  // namespace erard
