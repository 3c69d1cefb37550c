// Placing and linearisation: solver/{place_middle,linearise,branch_factor}.hpp in lanes, operation by operation.
#pragma once

#include "dynamics.hpp"
#include "felts.hpp"

namespace erard::lanes {

/// Mean rate over the step that ends with rate `end`.
template <typename T>
T mean_rate(double theta, const T& start, const T& end) noexcept {
  return T(1 - theta) * start + T(theta) * end;
}

template <typename T>
void find_middle(const Batch& batch, Work<T>& work) noexcept {
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  const double theta = batch.settings->theta;
  for (int i = 0; i < batch.plan->body_count; ++i) {
    work.middle_velocity[i] = mean_rate(theta, state.v[i], work.end_velocity[i]);
    work.middle_position[i] = state.x[i] + T(theta * batch.settings->time_step) * work.middle_velocity[i];
  }
}

template <typename T>
void find_shift(const Batch& batch, const Work<T>& work, const T* v, T* shift) noexcept {
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  const Settings& settings = *batch.settings;
  for (int i = 0; i < batch.plan->body_count; ++i)
    shift[i] =
        state.x[i] + T(settings.time_step) * mean_rate(settings.theta, state.v[i], v[i]) - work.placed_position[i];
}

/// Places some lanes at the middle of their iterate; to the others, worked out anew from what they were placed at, it does
/// nothing.
template <typename T>
void place_middle(const Batch& batch, const Mask<T>& is_moved, Work<T>& work) noexcept {
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  find_middle(batch, work);
  for (int i = 0; i < batch.plan->body_count; ++i) {
    work.placed_velocity[i] = select(is_moved, work.end_velocity[i], work.placed_velocity[i]);
    work.placed_position[i] = select(is_moved, work.middle_position[i], work.placed_position[i]);
    work.placed_rate[i] = select(is_moved, work.middle_velocity[i], work.placed_rate[i]);
    work.start_shift[i] = state.x[i] - work.placed_position[i];
  }
  place_bodies(batch, is_moved, work);
  locate_contacts(batch, work);
  assemble_mass_matrix(batch, work);
  assemble_bias(batch, work);
}

/// Element of a symmetric matrix of which the lower half is stored.
template <typename T>
const T& element(const T (&matrix)[kMaxBodies][kMaxBodies], int i, int j) noexcept {
  return j <= i ? matrix[i][j] : matrix[j][i];
}

template <typename T>
void add_inertia(const Batch& batch, Work<T>& work) noexcept {
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  const int n = batch.plan->body_count;
  T gained[kMaxBodies];
  for (int i = 0; i < n; ++i) gained[i] = work.end_velocity[i] - state.v[i];
  for (int i = 0; i < n; ++i) {
    T sum = T(batch.settings->time_step) * work.bias[i];
    for (int j = 0; j < n; ++j) sum += element(work.mass_matrix, i, j) * gained[j];
    work.smooth_residual[i] = sum;
    for (int j = 0; j <= i; ++j) work.iteration_matrix[i][j] = work.mass_matrix[i][j];
  }
}

template <typename T>
void add_own_laws(const Batch& batch, Work<T>& work) noexcept {
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const double h = batch.settings->time_step, theta = batch.settings->theta;
  for (int i = 0; i < batch.plan->body_count; ++i) {
    const BodyNumbers<T>& body = action.body[i];
    const T stretch = work.middle_position[i] - body.rest;
    work.smooth_residual[i] += T(h) * (body.viscous * work.middle_velocity[i] + body.stiffness * stretch);
    work.iteration_matrix[i][i] += T(h * theta) * body.viscous + T(h * h * theta * theta) * body.stiffness;
  }
}

template <typename T>
void add_finger(const Batch& batch, Work<T>& work) noexcept {
  const T zero(0.0);
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const auto& drive = *static_cast<const DriveNumbers<T>*>(batch.drive);
  const double h = batch.settings->time_step, theta = batch.settings->theta;
  work.finger_impulse = work.finger_loss = zero;
  if (batch.settings->push == Push::none) return;
  const int body = batch.plan->finger_body;
  const T value = mean_rate(theta, drive.from_value, drive.to_value), arm = action.finger_arm;
  if (batch.settings->push == Push::force) {
    work.finger_impulse = T(h) * value;
  } else {
    const T a = action.finger_stiffness, b = action.finger_damping;
    const T rate = mean_rate(theta, drive.from_rate, drive.to_rate);
    const T y = -arm * (work.middle_position[body] - action.body[body].initial);
    const T force = a * (value - y) + b * (rate + arm * work.middle_velocity[body]);
    work.finger_impulse = select(force > zero, T(h) * force, zero);
    work.finger_loss = select(force > zero, T(h * theta) * (a * T(theta) * T(h) + b), zero);
  }
  work.smooth_residual[body] += arm * work.finger_impulse;
  work.iteration_matrix[body][body] += arm * arm * work.finger_loss;
}

template <typename T>
void linearise(const Batch& batch, const Mask<T>& is_active, Work<T>& work) noexcept {
  find_middle(batch, work);
  find_shift(batch, work, work.end_velocity, work.end_shift);
  add_inertia(batch, work);
  add_own_laws(batch, work);
  add_massless_felts(batch, is_active, work);
  add_finger(batch, work);
}

/// Factors A with some coordinates taken out: their change is what stands in the load.
template <typename T>
void factorise_without(const Plan& plan, const Mask<T>* is_out, Work<T>& work) noexcept {
  const T zero(0.0), one(1.0);
  auto& F = work.factor;
  for (int i = 0; i < plan.body_count; ++i) {
    const BodyPlan& body = plan.body[i];
    F[i][i] = select(is_out[i], one, work.iteration_matrix[i][i]);
    for (int a = 0; a < body.above_count; ++a) {
      const int j = body.above[a];
      F[i][j] = select(is_out[i] | is_out[j], zero, work.iteration_matrix[i][j]);
    }
  }
  for (int k = plan.body_count - 1; k >= 0; --k) {
    const BodyPlan& body = plan.body[k];
    const T inverse = one / F[k][k];
    F[k][k] = inverse;
    for (int a = 0; a < body.above_count; ++a) {
      const int i = body.above[a];
      const T l = F[k][i] * inverse;
      for (int b = a; b < body.above_count; ++b) F[i][body.above[b]] -= l * F[k][body.above[b]];
      F[k][i] = l;
    }
  }
}

template <typename T>
void solve_upwards(const Plan& plan, const Work<T>& work, int last, T* b) noexcept {
  for (int i = last; i > 0; --i) {
    const BodyPlan& body = plan.body[i];
    for (int a = 0; a < body.above_count; ++a) b[body.above[a]] -= work.factor[i][body.above[a]] * b[i];
  }
}

template <typename T>
void solve_downwards(const Plan& plan, const Work<T>& work, T* b) noexcept {
  for (int i = 0; i < plan.body_count; ++i) {
    const BodyPlan& body = plan.body[i];
    T sum = work.factor[i][i] * b[i];
    for (int a = 0; a < body.above_count; ++a) sum -= work.factor[i][body.above[a]] * b[body.above[a]];
    b[i] = sum;
  }
}

}  // namespace erard::lanes
