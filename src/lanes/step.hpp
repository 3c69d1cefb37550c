// START HERE: solver/step.hpp for several keys at once.
//
// Every lane computes what the scalar engine computes, in its order, and takes its decisions; conditions are masks. What
// rounds otherwise in lanes (sines, powers, the dot products of the sweeps) is left to the scalar code, so that the bits are the
// same. Where a lane needs nothing more it is put aside, and what the others do to it does not matter.
#pragma once

#include "rows.hpp"

namespace erard::lanes {

template <typename T>
void predict(const Batch& batch, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  const double h = batch.settings->time_step;
  for (int i = 0; i < plan.body_count; ++i) {
    work.end_velocity[i] = plan.body[i].is_fixed ? T(0.0) : state.v[i] + T(h) * state.acceleration[i];
    work.placed_velocity[i] = work.placed_position[i] = work.placed_rate[i] = T(0.0);
  }
  for (int k = 0; k < plan.row_count; ++k) work.guess[k] = T(h) / state.time_step * state.impulse[k];
  for (int r = 0; r < plan.friction_row_count; ++r) work.is_in_play[r] = Mask<T>(false);
  for (int c = 0; c < plan.contact_count; ++c) work.is_start_raised[c] = Mask<T>(false);
}

template <typename T>
void update_velocity(const Batch& batch, Work<T>& work) noexcept {
  const T zero(0.0);
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  for (int i = 0; i < plan.body_count; ++i) work.end_velocity[i] += work.change[i];
  find_shift(batch, work, work.end_velocity, work.end_shift);
  for (int c = 0; c < plan.contact_count; ++c) {
    const ContactPlan& contact = plan.contact[c];
    T& guess = work.guess[contact.row];
    guess = zero;
    if (!work.acts[c]) continue;
    const T left = work.felt_impulse[c] - work.felt_loss[c] * along(contact, work.contact[c].normal_lever, work.change);
    guess = select((work.felt_impulse[c] > zero) & (zero < left), left, zero);
  }
  if (batch.settings->push == Push::piston)
    work.finger_impulse += action.finger_arm * work.finger_loss * work.change[plan.finger_body];
}

template <typename T>
struct Movement {
  T last, acceleration, since_placed;
};

template <typename T>
Movement<T> measure_movement(const Batch& batch, const Work<T>& work) noexcept {
  const T zero(0.0), h(batch.settings->time_step);
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  T last = zero, since_placed = zero;
  T whole = action.total_mass * h * h * dot(action.gravity, action.gravity);
  for (int i = 0; i < batch.plan->body_count; ++i) {
    const T mass = work.mass_matrix[i][i];
    const T since = work.end_velocity[i] - work.placed_velocity[i];
    last += mass * work.change[i] * work.change[i];
    since_placed += mass * since * since;
    whole += mass * work.end_velocity[i] * work.end_velocity[i];
  }
  const auto is_something = whole > zero;
  return {select(is_something, sqrt(last / whole), zero),
          select(is_something, sqrt(last / action.total_mass) / h, zero),
          select(is_something, sqrt(since_placed / whole), zero)};
}

/// Puts the result of some lanes aside.
template <typename T>
void keep(const Plan& plan, const Mask<T>& which, Work<T>& work) noexcept {
  for (int i = 0; i < plan.body_count; ++i) {
    work.done_velocity[i] = select(which, work.end_velocity[i], work.done_velocity[i]);
    work.done_shift[i] = select(which, work.end_shift[i], work.done_shift[i]);
  }
  for (int k = 0; k < plan.row_count; ++k) work.done_guess[k] = select(which, work.guess[k], work.done_guess[k]);
  work.done_finger = select(which, work.finger_impulse, work.done_finger);
}

/// Writes down how the lanes that end here got there.
template <typename T>
void report(const Mask<T>& ends, const Mask<T>& is_sliding, int count, const T& change, const Sweeps<T>& sweeps,
            Outcome& outcome, bool* is_converged) noexcept {
  bool ended[kMaxLanes], slid[kMaxLanes], converged[kMaxLanes];
  double changes[kMaxLanes], errors[kMaxLanes], counts[kMaxLanes];
  ends.store_unaligned(ended);
  is_sliding.store_unaligned(slid);
  sweeps.is_converged.store_unaligned(converged);
  change.store_unaligned(changes);
  sweeps.error.store_unaligned(errors);
  sweeps.count.store_unaligned(counts);
  for (int l = 0; l < Work<T>::kLanes; ++l) {
    if (!ended[l]) continue;
    outcome.linearisations[l] = count;
    outcome.sweeps[l] = static_cast<int>(counts[l]);
    outcome.tangents[l] = sweeps.tangents[l];
    outcome.newton_change[l] = changes[l];
    outcome.sweep_error[l] = slid[l] ? 0 : errors[l];
    is_converged[l] = slid[l] || converged[l];
  }
}

/// Iterates until each lane has found its end, or is refused, or is lost to the scalar engine.
/// @return the lanes whose end is found
template <typename T>
Mask<T> find_end(const Batch& batch, Work<T>& work) noexcept {
  const Settings& settings = *batch.settings;
  Outcome& outcome = *batch.outcome;
  bool is_converged[kMaxLanes] = {};
  Sweeps<T> sweeps;
  Mask<T> is_active = Mask<T>::load_unaligned(batch.is_used), is_done(false);
  is_done.store_unaligned(outcome.is_at_limit);
  predict(batch, work);
  place_middle(batch, is_active, work);
  for (int count = 1; any(is_active); ++count) {
    linearise(batch, is_active, work);
    const Mask<T> is_sliding = slide_on(batch, is_active, work), is_swept = is_active & !is_sliding;
    if (any(is_swept)) sweep_rows(batch, is_swept, sweeps, work);
    update_velocity(batch, work);
    const Movement<T> moved = measure_movement(batch, work);
    Mask<T> is_refused(false);
    if (count == 1) {
      is_refused = is_active & (moved.acceleration > T(settings.surprise_limit));
      is_refused.store_unaligned(outcome.is_refused);
      moved.acceleration.store_unaligned(outcome.surprise);
    }
    const Mask<T> is_placed = moved.since_placed <= T(settings.placement_tolerance);
    const Mask<T> is_near = is_placed & (moved.last <= T(settings.newton_tolerance));
    const bool is_last = count == settings.newton_limit;
    const Mask<T> ends = is_active & !is_refused & (is_near | Mask<T>(is_last));
    if (is_last) (ends & !is_near).store_unaligned(outcome.is_at_limit);
    report(ends | is_refused, is_sliding, count, moved.last, sweeps, outcome, is_converged);
    if (any(ends)) keep(*batch.plan, ends, work);
    is_done = is_done | ends;
    is_active = is_active & !ends & !is_refused;
    if (any(is_active & !is_placed)) place_middle(batch, is_active & !is_placed, work);
  }
  return is_done & Mask<T>::load_unaligned(is_converged);
}

/// Compression of felts left alone for the step, in some lanes.
template <typename T>
T relaxed(const Batch& batch, const Mask<T>& which, const ContactNumbers<T>& felt, const T& compression) noexcept {
  double stiffness[kMaxLanes], exponent[kMaxLanes], damping[kMaxLanes], left[kMaxLanes];
  bool wanted[kMaxLanes];
  which.store_unaligned(wanted);
  felt.stiffness.store_unaligned(stiffness);
  felt.exponent.store_unaligned(exponent);
  felt.damping.store_unaligned(damping);
  compression.store_unaligned(left);
  for (int l = 0; l < Work<T>::kLanes; ++l)
    left[l] =
        wanted[l] ? batch.calls->relax(batch.settings->time_step, stiffness[l], exponent[l], damping[l], left[l]) : 0;
  return T::load_unaligned(left);
}

/// Compressions of the felts at the end of the step.
template <typename T>
void keep_felt_history(const Batch& batch, const Mask<T>& is_done, Work<T>& work) noexcept {
  const T zero(0.0);
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  auto& state = *static_cast<StateNumbers<T>*>(batch.state);
  for (int c = 0; c < plan.contact_count; ++c) {
    const auto is_left = is_done & (work.done_guess[plan.contact[c].row] <= zero) & (state.compression[c] > zero);
    const T left = any(is_left) ? relaxed(batch, is_left, action.contact[c], state.compression[c]) : zero;
    const T overlap = -gap_at(plan.contact[c], work.contact[c], work.done_shift);
    const auto is_open = (work.done_guess[plan.contact[c].row] <= zero) & (state.compression[c] <= zero);
    state.compression[c] = select(is_open, state.compression[c], larger(larger(overlap, left), zero));
  }
}

template <typename T>
Mask<T> is_finite(const Plan& plan, const Work<T>& work) noexcept {
  const T zero(0.0);
  T sum = zero;  // 0 of numbers, else not a number
  for (int k = 0; k < plan.row_count; ++k) sum += work.done_guess[k] * zero;
  for (int i = 0; i < plan.body_count; ++i) sum += work.done_velocity[i] * zero + work.done_shift[i] * zero;
  return sum == zero;
}

/// One step of each lane.
template <typename T>
void step(const Batch& batch) noexcept {
  const Plan& plan = *batch.plan;
  Work<T>& work = *static_cast<Work<T>*>(batch.work);
  auto& state = *static_cast<StateNumbers<T>*>(batch.state);
  const T h(batch.settings->time_step);
  const Mask<T> is_done = find_end(batch, work);
  const Mask<T> is_taken = is_done & is_finite(plan, work);
  is_taken.store_unaligned(batch.outcome->is_taken);
  keep_felt_history(batch, is_taken, work);
  for (int i = 0; i < plan.body_count; ++i) {
    state.x[i] = work.placed_position[i] + work.done_shift[i];
    state.acceleration[i] = (work.done_velocity[i] - state.v[i]) / h;
    state.v[i] = work.done_velocity[i];
  }
  for (int k = 0; k < plan.row_count; ++k) state.impulse[k] = work.done_guess[k];
  (work.done_finger / h).store_unaligned(batch.outcome->finger_force);
}

template <typename T>
constexpr Kernel kernel_of() noexcept {
  static_assert(sizeof(T) == T::size * sizeof(double) && T::size <= kMaxLanes);
  return {static_cast<int>(T::size), sizeof(Work<T>), &step<T>};
}

}  // namespace erard::lanes
