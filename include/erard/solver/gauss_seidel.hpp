// Augmented-Lagrangian projected Gauss-Seidel over all rows.
#pragma once

#include "erard/solver/one_step_problem.hpp"
#include "erard/solver/scheme.hpp"

namespace erard {

struct SweepReport {
  int sweeps = 0;
  double last_change = 0;  // of any row in the last sweep, relative [-]
};

/// Solves the one-step problem by sweeping
///   r_i <- proj_i( r_i - u_i / W_ii ),   u_i = (W r)_i + q_i                       thesis (5.43)-(5.46), 5.2.2
/// The augmented-Lagrangian parameter of each row is 1 / W_ii, so that a row alone is solved in one visit.
/// @param r (m) first guess (warm start) in, impulses out
/// Stops when no row moves by more than the tolerance, each in its own unit, or at the sweep limit. Cost m^2 a sweep.
inline SweepReport sweep_gauss_seidel(const OneStepProblem& problem, const Scheme& scheme, RowVector& r) noexcept {
  SweepReport report;
  do {
    ++report.sweeps;
    ByUnit change, scale;
    for (int i = 0; i < problem.size; ++i) {
      const Cone& cone = problem.cone[i];
      const double w = problem.W(i, i);
      const double u = problem.W.row(i).dot(r) + problem.q[i];
      const double impulse = project(cone, r[i] - u / w, r);
      change.raise(cone, w * std::abs(impulse - r[i]));
      scale.raise(cone, std::abs(u - w * r[i]));
      r[i] = impulse;
    }
    report.last_change = worst_ratio(change, scale);
  } while (report.last_change > scheme.sweep_tolerance && report.sweeps < scheme.sweep_limit);
  return report;
}

}  // namespace erard
