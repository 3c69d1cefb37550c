// The one-step problem when nothing starts or stops: solver/slide_on.hpp in lanes, operation by operation.
#pragma once

#include "linearise.hpp"

namespace erard::lanes {

/// In the order of the rows: a lane whose friction is refused keeps its guesses from there on, since its sweeps begin with
/// them.
/// @return the lanes in which the last friction is worth a try
template <typename T>
Mask<T> recall_friction(const Batch& batch, const Mask<T>& is_active, Work<T>& work) noexcept {
  const T zero(0.0), at_bound(0.99);
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  Mask<T> is_recalled = is_active;
  for (int i = 0; i < plan.body_count; ++i) {
    work.is_out[i] = Mask<T>(plan.body[i].is_fixed);
    work.load[i] = zero;
  }
  for (int r = 0; r < plan.friction_row_count; ++r) {
    T& guess = work.guess[plan.friction_row[r].row];
    if (plan.friction_row[r].contact >= 0) {
      const int c = plan.friction_row[r].contact;
      const ContactPlan& contact = plan.contact[c];
      const T mu = action.contact[c].friction, bound = mu * work.felt_impulse[c];
      const auto is_closed = work.felt_impulse[c] > zero;
      is_recalled = is_recalled & !(is_closed & (abs(guess) < at_bound * mu * work.guess[contact.row]));
      guess = select(is_recalled, select(is_closed, copysign(bound, guess), zero), guess);
      const T pushed = select(is_recalled & is_closed, guess, zero);
      for (int k = 0; k < contact.path_count; ++k)
        work.load[contact.path[k]] += pushed * work.contact[c].tangent_lever[k];
    } else {
      const int i = plan.friction_row[r].coordinate;
      const T bound = action.body[i].dry * T(batch.settings->time_step);
      const auto is_sliding = abs(guess) >= at_bound * bound;
      guess = select(is_recalled & is_sliding, copysign(bound, guess), guess);
      work.load[i] = select(is_recalled & is_sliding, work.load[i] + guess, work.load[i]);
      work.is_out[i] = !is_sliding;
    }
  }
  return is_recalled;
}

template <typename T>
T needed_load(const Plan& plan, const Work<T>& work, int i) noexcept {
  T sum = work.smooth_residual[i];
  for (int j = 0; j < plan.body_count; ++j) sum += element(work.iteration_matrix, i, j) * work.change[j];
  return sum;
}

template <typename T>
void move_with_friction(const Plan& plan, Work<T>& work) noexcept {
  const T zero(0.0);
  T* dv = work.change;
  for (int i = 0; i < plan.body_count; ++i) dv[i] = work.load[i] - work.smooth_residual[i];
  for (int s = 0; s < plan.body_count; ++s) {
    const T stopped = plan.body[s].is_fixed ? zero : -work.end_velocity[s];
    dv[s] = select(work.is_out[s], stopped, dv[s]);
    if (none(work.is_out[s])) continue;
    const T step = select(work.is_out[s], stopped, zero);
    for (int i = 0; i < plan.body_count; ++i)
      if (i != s) dv[i] = select(work.is_out[i], dv[i], dv[i] - element(work.iteration_matrix, i, s) * step);
  }
  factorise_without(plan, work.is_out, work);
  solve_upwards(plan, work, plan.body_count - 1, dv);
  solve_downwards(plan, work, dv);
}

/// @return the lanes in which the friction obeys its laws
template <typename T>
Mask<T> obeys_friction(const Batch& batch, const Mask<T>& is_recalled, Work<T>& work) noexcept {
  const T zero(0.0);
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  Mask<T> obeys = is_recalled;
  for (int r = 0; r < plan.friction_row_count; ++r) {
    T& guess = work.guess[plan.friction_row[r].row];
    if (plan.friction_row[r].contact >= 0) {
      const ContactPlan& contact = plan.contact[plan.friction_row[r].contact];
      const T* lever = work.contact[plan.friction_row[r].contact].tangent_lever;
      const T rate = along(contact, lever, work.end_velocity) + along(contact, lever, work.change);
      obeys = obeys & !(guess * rate > zero);
    } else {
      const int i = plan.friction_row[r].coordinate;
      const auto is_out = work.is_out[i];
      guess = select(obeys & is_out, needed_load(plan, work, i) - work.load[i], guess);
      const auto breaks = abs(guess) > action.body[i].dry * T(batch.settings->time_step);
      const auto turns = guess * (work.end_velocity[i] + work.change[i]) > zero;
      obeys = obeys & !((is_out & breaks) | ((!is_out) & turns));
    }
  }
  return obeys;
}

/// @return the lanes solved
template <typename T>
Mask<T> slide_on(const Batch& batch, const Mask<T>& is_active, Work<T>& work) noexcept {
  if (!batch.settings->is_friction_recalled) return Mask<T>(false);
  const Mask<T> is_recalled = recall_friction(batch, is_active, work);
  if (none(is_recalled)) return is_recalled;
  move_with_friction(*batch.plan, work);
  return obeys_friction(batch, is_recalled, work);
}

}  // namespace erard::lanes
