#include "calls.hpp"

#include "erard/mechanics/felt_law.hpp"
#include "erard/solver/assemble_rows.hpp"
#include "erard/solver/gauss_seidel.hpp"

namespace erard::lanes {
namespace {

void turn(int count, int lanes, const bool* is_wanted, const double* angle, double* cosine, double* sine) noexcept {
  for (int l = 0; l < lanes; ++l) {
    if (!is_wanted[l]) continue;
    for (int i = l; i < count * lanes; i += lanes) {
      const Vector2 axis = unit_vector(angle[i]);
      cosine[i] = axis.x();
      sine[i] = axis.y();
    }
  }
}

void power(int count, const double* base, const double* exponent, double* result) noexcept {
  for (int i = 0; i < count; ++i) result[i] = base[i] > 0 ? std::pow(base[i], exponent[i]) : 0.0;
}

void relax(int count, double time, const double* stiffness, const double* exponent, const double* damping,
           const double* compression, double* left) noexcept {
  for (int i = 0; i < count; ++i) {
    left[i] = 0;
    if (!(compression[i] > 0)) continue;
    Felt felt;
    felt.stiffness = stiffness[i];
    felt.exponent = exponent[i];
    felt.damping = damping[i];
    left[i] = relaxed_compression(felt, compression[i], time);
  }
}

/// The rows in play of one lane as a problem of its own. @return their numbers
int extract(const SweepTask& task, int lane, OneStepProblem& problem, RowVector& impulse,
            int (&row)[kMaxFrictionRows]) noexcept {
  int m = 0;
  for (int r = 0; r < task.size; ++r)
    if (task.is_in_play[r * task.lanes + lane] > 0) row[m++] = r;
  problem.size = m;
  problem.W.resize(m, m);
  problem.q.resize(m);
  impulse.resize(m);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < m; ++j) problem.W(i, j) = task.W[(row[i] * task.size + row[j]) * task.lanes + lane];
    const int place = row[i] * task.lanes + lane;
    problem.q[i] = task.q[place];
    problem.cone[i] = {ConeKind::interval, -1, task.bound[place], task.plan->friction_row[row[i]].is_angular};
    impulse[i] = task.impulse[place];
  }
  idle_fixed_rows(problem);
  return m;
}

void sweep(const void* scheme, const SweepTask& task) noexcept {
  OneStepProblem problem;
  RowVector impulse;
  int row[kMaxFrictionRows];
  for (int l = 0; l < task.lanes; ++l) {
    if (!task.is_wanted[l]) continue;
    const int m = extract(task, l, problem, impulse, row);
    const SweepReport report = sweep_gauss_seidel(problem, *static_cast<const Scheme*>(scheme), impulse);
    for (int r = 0; r < task.size; ++r) task.impulse[r * task.lanes + l] = 0;
    for (int i = 0; i < m; ++i) task.impulse[row[i] * task.lanes + l] = impulse[i];
    task.sweeps[l] += report.sweeps;
    task.error[l] = report.error;
    task.is_converged[l] = report.is_converged;
  }
}

}  // namespace

Calls calls_of(const Scheme& scheme) noexcept { return {&scheme, turn, power, relax, sweep}; }

}  // namespace erard::lanes
