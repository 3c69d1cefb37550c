// The one-step problem when friction starts or stops: solver/assemble_rows.hpp in lanes, operation by operation.
#pragma once

#include "friction.hpp"
#include "sweeps.hpp"

namespace erard::lanes {

/// L^-T H of one row, the loads on fixed coordinates left out. @return the last coordinate that it may reach
template <typename T>
int set_half(const Plan& plan, int r, Work<T>& work) noexcept {
  T* half = work.half[r];
  for (int i = 0; i < plan.body_count; ++i) half[i] = T(0.0);
  int last = plan.friction_row[r].coordinate;
  if (plan.friction_row[r].contact >= 0) {
    const ContactPlan& contact = plan.contact[plan.friction_row[r].contact];
    for (int k = 0; k < contact.path_count; ++k)
      if (!plan.body[contact.path[k]].is_fixed)
        half[contact.path[k]] = work.contact[plan.friction_row[r].contact].tangent_lever[k];
    last = contact.path[contact.path_count - 1];
  } else {
    half[last] = T(1.0);
  }
  solve_upwards(plan, work, last, half);
  return last;
}

/// W, q and bounds of all rows with friction, whether or not they are in play. A row once in play stays for the rest of the
/// step.
template <typename T>
void assemble_problem(const Batch& batch, const Mask<T>& is_wanted, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const int m = plan.friction_row_count;
  T free_velocity[kMaxBodies];
  for (int i = 0; i < plan.body_count; ++i) free_velocity[i] = work.end_velocity[i] + work.change[i];
  int last[kMaxFrictionRows];
  for (int r = 0; r < m; ++r) last[r] = set_half(plan, r, work);
  for (int r = 0; r < m; ++r) {
    T left[kMaxBodies];
    for (int k = 0; k <= last[r]; ++k) left[k] = work.half[r][k] * work.factor[k][k];
    for (int j = 0; j < m; ++j) {
      T sum(0.0);
      for (int k = 0; k <= (last[r] < last[j] ? last[r] : last[j]); ++k) sum += left[k] * work.half[j][k];
      work.W[r][j] = sum;
    }
    if (plan.friction_row[r].contact >= 0) {
      const int c = plan.friction_row[r].contact;
      work.q[r] = along(plan.contact[c], work.contact[c].tangent_lever, free_velocity);
      work.bound[r] = action.contact[c].friction * work.felt_impulse[c];
      work.is_in_play[r] = work.is_in_play[r] | (is_wanted & (work.felt_impulse[c] > T(0.0)));
    } else {
      work.q[r] = free_velocity[plan.friction_row[r].coordinate];
      work.bound[r] = action.body[plan.friction_row[r].coordinate].dry * T(batch.settings->time_step);
      work.is_in_play[r] = work.is_in_play[r] | is_wanted;
    }
    work.row_impulse[r] = work.guess[plan.friction_row[r].row];
  }
}

/// Impulses of the rows in play, from the last ones known, and the change of the end velocity with them, in some lanes.
template <typename T>
void sweep_rows(const Batch& batch, const Mask<T>& is_wanted, Sweeps<T>& sweeps, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const int n = plan.body_count, m = plan.friction_row_count;
  T solved[kMaxBodies];  // of the lanes that need no sweeps
  Mask<T> is_fixed[kMaxBodies];
  for (int i = 0; i < n; ++i) {
    solved[i] = work.change[i];
    is_fixed[i] = Mask<T>(plan.body[i].is_fixed);
  }
  factorise_without(plan, is_fixed, work);
  for (int i = 0; i < n; ++i) work.change[i] = plan.body[i].is_fixed ? T(0.0) : -work.smooth_residual[i];
  solve_upwards(plan, work, n - 1, work.change);
  solve_downwards(plan, work, work.change);
  assemble_problem(batch, is_wanted, work);

  sweep(batch, is_wanted, sweeps, work);
  T gain[kMaxBodies];
  for (int i = 0; i < n; ++i) gain[i] = T(0.0);
  for (int r = 0; r < m; ++r) {
    work.guess[plan.friction_row[r].row] = select(is_wanted, work.row_impulse[r], work.guess[plan.friction_row[r].row]);
    for (int i = 0; i < n; ++i) gain[i] += work.half[r][i] * work.row_impulse[r];
  }
  solve_downwards(plan, work, gain);
  for (int i = 0; i < n; ++i) work.change[i] = select(is_wanted, work.change[i] + gain[i], solved[i]);
}

}  // namespace erard::lanes
