// Where the power and the sine of a lane begin: values at closely spaced points, to more than double precision.
#pragma once

namespace erard::lanes {

/// A line is what a lane loads at once: two values, each as the sum of two numbers, the second below the last bit of the
/// first.
using TableLine = double[4];

struct Tables {
  static constexpr int kPoints = 128;          // an octave
  alignas(32) TableLine logarithm[kPoints];    // -ln(i), first part a multiple of 2^-42; its rest; i; 0. i is the
                                               // inverse of a point of each interval of [kLeast, 2 kLeast)
  alignas(32) TableLine exponential[kPoints];  // 2^(i / kPoints), 0
  static constexpr int kTurns = 64;            // angles a radian, up to kMostAngle
  static constexpr double kMostAngle = 1;
  alignas(32) TableLine turn[kTurns + 2];  // sine, cosine
};

/// Bits of the least number of the octave in which logarithms are taken, about 0.7.
inline constexpr unsigned long kLeastBits = 0x3fe6955500000000;

const Tables& tables() noexcept;

}  // namespace erard::lanes
