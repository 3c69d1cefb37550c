// Augmented-Lagrangian projected Gauss-Seidel over all rows.
#pragma once

#include "erard/solver/one_step_problem.hpp"
#include "erard/solver/scheme.hpp"

namespace erard {

struct SweepReport {
  int sweeps = 0;
  bool is_converged = false;
  double error = 0;  // last known: change of any row in a sweep or residual, relative [-]
};

/// Solves the one-step problem by sweeping
///   r_i <- proj_i( r_i - u_i / W_ii ),   u_i = (W r)_i + q_i                       thesis (5.43)-(5.46), 5.2.2
/// The augmented-Lagrangian parameter of each row is 1 / W_ii, so that a row alone is solved in one visit.
/// @param r (m) first guess (warm start) in, impulses out
/// Stops when no row moves by more than the tolerance, each in its own unit, or at the sweep limit. Where everything
/// sticks, impulses are not unique and may go on drifting along directions that no velocity depends on: therefore the
/// residual is looked at now and then. Cost m^2 a sweep.
inline SweepReport sweep_gauss_seidel(const OneStepProblem& problem, const Scheme& scheme, RowVector& r) noexcept {
  constexpr int kResidualEvery = 10;  // sweeps; a residual costs as much as one
  SweepReport report;
  while (!report.is_converged && report.sweeps < scheme.sweep_limit) {
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
    report.error = worst_ratio(change, scale);
    if (report.error > scheme.sweep_tolerance && report.sweeps % kResidualEvery == 0)
      report.error = residual(problem, r);
    report.is_converged = report.error <= scheme.sweep_tolerance;
  }
  return report;
}

}  // namespace erard
