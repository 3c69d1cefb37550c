// Where the power and the sine of a lane begin: values at closely spaced points, to more than double precision.
#pragma once

namespace erard::lanes {

/// Each as the sum of two numbers, the second below the last bit of the first.
struct Tables {
  static constexpr int kPoints = 128;                      // an octave
  double inverse[kPoints];                                 // of a point of each interval of [kLeast, 2 kLeast)
  double log[kPoints], log_rest[kPoints];                  // -ln(inverse); the first a multiple of 2^-42
  double exponential[kPoints], exponential_rest[kPoints];  // 2^(i / kPoints)
  static constexpr int kTurns = 64;                        // angles a radian, up to kMostAngle
  static constexpr double kMostAngle = 1;
  double sine[kTurns + 2], sine_rest[kTurns + 2], cosine[kTurns + 2], cosine_rest[kTurns + 2];
};

/// Bits of the least number of the octave in which logarithms are taken, about 0.7.
inline constexpr unsigned long kLeastBits = 0x3fe6955500000000;

const Tables& tables() noexcept;

}  // namespace erard::lanes
