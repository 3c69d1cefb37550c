// The felt law and its exact mean over a step.
#pragma once

#include <algorithm>
#include <cmath>

#include "erard/model/contact.hpp"

namespace erard {

/// Elastic part k d^r, zero where the felt is not compressed [N].
inline double elastic_force(const Felt& felt, double compression) noexcept {
  return compression > 0 ? felt.stiffness * std::pow(compression, felt.exponent) : 0.0;
}

/// Force of a felt at one instant.
///   F = k d^r + b d^2 d'                                                        thesis (4.4), (4.21)
/// Departs from the thesis: 5.5.1 prints the damping with a minus sign; here d' > 0 means "compressing", so it is plus.
/// Not clipped: it is the law of the felt's own coordinate, and a felt that is left alone opens at the rate at which
/// it vanishes; it is the contact in series that cannot pull.
/// @param compression d [m]; @param rate d' [m/s]; @return [N]
inline double felt_force(const Felt& felt, double compression, double rate) noexcept {
  if (compression <= 0) return 0;
  return elastic_force(felt, compression) + felt.damping * compression * compression * rate;
}

/// Elastic energy k d^(r+1) / (r+1) [J].
inline double felt_energy(const Felt& felt, double compression) noexcept {
  return elastic_force(felt, compression) * compression / (felt.exponent + 1);
}

/// Mean force over a step and its slope.
struct MeanForce {
  double force = 0;  // [N]
  double slope = 0;  // d force / d (compression at the end) [N/m]
};

/// Mean of the felt law along the straight path d_0 -> d_1 of one step.
///   F = [E(d_1) - E(d_0)] / (d_1 - d_0) + b (d_1^3 - d_0^3) / (3 h),   E = k d^(r+1) / (r+1)
/// The elastic part gives back over a closed path exactly what it took, whatever the step, which
/// the law evaluated at a point does not.
/// Where the path is short against d the quotient cancels, and its Taylor series about the middle is used:
///   E-quotient = F(m) + F''(m) s^2/24 + O(s^4),  s = d_1 - d_0 <= 1e-3 m  (relative error below 1e-13)
/// @param start d_0 [m], @param end d_1 [m], @param time_step h [s]
inline MeanForce mean_felt_force(const Felt& felt, double start, double end, double time_step) noexcept {
  const double d0 = std::max(start, 0.0);
  const double d1 = std::max(end, 0.0);
  const double r = felt.exponent;
  const double s = end - start;
  const double middle = 0.5 * (d0 + d1);
  MeanForce mean;
  if (std::abs(s) <= 1e-3 * middle && start > 0 && end > 0) {
    const double force = elastic_force(felt, middle);
    const double bend = r * (r - 1) * force / (middle * middle);
    mean.force = force + bend * s * s / 24;
    mean.slope = 0.5 * r * force / middle + bend * s / 12;
  } else if (s != 0) {
    const double f1 = elastic_force(felt, d1);
    mean.force = (f1 * d1 - elastic_force(felt, d0) * d0) / ((r + 1) * s);
    mean.slope = (f1 - mean.force) / s;
  }
  mean.force += felt.damping * (d1 * d1 * d1 - d0 * d0 * d0) / (3 * time_step);
  mean.slope += felt.damping * d1 * d1 / time_step;
  return mean;
}

/// Mean force of a felt over a step in which a body comes at it through the air, zero until it is met:
///   F = [E(d_1) - E(d_0)] / (d_1 - s_0) + b (d_1^3 - d_0^3) / (3 h)
/// so that the body loses on its way from s_0 to d_1 what the felt takes from d_0 to d_1.
/// @param from  s_0 <= d_0: where the body is at the start, negative in the air [m]; the others as above
inline MeanForce mean_arrival_force(const Felt& felt, double from, double start, double end,
                                    double time_step) noexcept {
  MeanForce mean;
  if (end <= start || end <= 0) return mean;
  const double d0 = std::max(start, 0.0);
  const double f1 = elastic_force(felt, end);
  mean.force = (f1 * end - elastic_force(felt, d0) * d0) / ((felt.exponent + 1) * (end - from));
  mean.slope = (f1 - mean.force) / (end - from);
  mean.force += felt.damping * (end * end * end - d0 * d0 * d0) / (3 * time_step);
  mean.slope += felt.damping * end * end / time_step;
  return mean;
}

/// Compression of a felt that is left alone for a while: without a reaction its law is k d^r + b d^2 d' = 0, so that
///   d^(3-r) = d_0^(3-r) - (3-r) (k/b) t,   d = d_0 exp(-(k/b) t) where r = 3;   0 at once where b = 0
/// @param start d_0 [m], @param time t [s]; @return d [m] >= 0
inline double relaxed_compression(const Felt& felt, double start, double time) noexcept {
  if (start <= 0 || felt.damping <= 0) return 0;
  const double way = time * felt.stiffness / felt.damping;
  const double power = 3 - felt.exponent;
  if (power == 0) return start * std::exp(-way);
  const double left = std::pow(start, power) - power * way;
  return left > 0 ? std::pow(left, 1 / power) : 0.0;
}

}  // namespace erard
