// The one-step non-smooth problem: find impulses r such that u = W r + q obeys the law of every row.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "erard/mechanics/state.hpp"

namespace erard {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxRows, kMaxRows>;

/// Set of admissible impulses of one row.
enum class ConeKind {
  half_line,  // r >= 0, u >= 0, r u = 0
  friction,   // |r| <= bound * r[normal], u against r
  interval,   // |r| <= bound, u against r
};

struct Cone {
  ConeKind kind = ConeKind::half_line;
  int normal = -1;          // friction: row of its normal impulse
  double bound = 0;         // friction: mu [-]; interval: largest impulse [N s] or [N m s]
  bool is_angular = false;  // unit of the row: rad/s and N m s instead of m/s and N s
};

/// u = W r + q                                                                     thesis (5.44)
/// W: Delassus operator (m x m) [1/kg], hinge rows [1/(kg m^2)]; q: free velocity (m) [m/s], hinge rows [rad/s].
/// W is symmetric but for terms of the order of a felt's mass over its carrier's.
struct OneStepProblem {
  int size = 0;
  RowMatrix W;
  RowVector q;
  std::array<Cone, kMaxRows> cone;
};

/// Nearest admissible impulse, the other rows given.
inline double project(const Cone& cone, double impulse, const RowVector& r) noexcept {
  if (cone.kind == ConeKind::half_line) return impulse > 0 ? impulse : 0.0;
  const double bound = cone.kind == ConeKind::interval ? cone.bound : cone.bound * r[cone.normal];
  return impulse > bound ? bound : impulse < -bound ? -bound : impulse;
}

/// Largest of something, kept apart for the rows in m/s and those in rad/s.
struct ByUnit {
  double linear = 0;   // [m/s]
  double angular = 0;  // [rad/s]

  double& of(const Cone& cone) noexcept { return cone.is_angular ? angular : linear; }
  void raise(const Cone& cone, double value) noexcept { of(cone) = std::max(of(cone), value); }
};

/// Largest ratio of the two units; 0 / 0 counts as 0.
inline double worst_ratio(const ByUnit& error, const ByUnit& scale) noexcept {
  const auto ratio = [](double e, double s) noexcept { return e > 0 ? e / s : 0.0; };
  return std::max(ratio(error.linear, scale.linear), ratio(error.angular, scale.angular));
}

/// How far r is from solving the problem: the largest error of any row, each in its own unit, against the largest
/// velocity of that unit that the laws have to stop.
///   max_i W_ii |r_i - proj(r_i - u_i / W_ii)|  /  max_i |u_i - W_ii r_i|        zero exactly at a solution
inline double residual(const OneStepProblem& problem, const RowVector& r) noexcept {
  ByUnit error, scale;
  for (int i = 0; i < problem.size; ++i) {
    const Cone& cone = problem.cone[i];
    const double w = problem.W(i, i);
    const double u = problem.W.row(i).dot(r) + problem.q[i];
    error.raise(cone, w * std::abs(r[i] - project(cone, r[i] - u / w, r)));
    scale.raise(cone, std::abs(u - w * r[i]));
  }
  return worst_ratio(error, scale);
}

}  // namespace erard
