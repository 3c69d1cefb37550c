// Felts without mass: mechanics/felt_law.hpp in lanes, operation by operation. Both laws are worked out and chosen from;
// their powers are taken one by one, of those that are wanted alone.
#pragma once

#include "functions.hpp"

namespace erard::lanes {

/// Velocity or way along a direction.
template <typename T>
T along(const ContactPlan& contact, const T* lever, const T* rate) noexcept {
  T sum(0.0);
  for (int k = 0; k < contact.path_count; ++k) sum += lever[k] * rate[contact.path[k]];
  return sum;
}

template <typename T>
T gap_at(const ContactPlan& contact, const PlacedContact<T>& place, const T* shift) noexcept {
  return place.gap + along(contact, place.normal_lever, shift);
}

/// Whether the path of a compression is so short that the law is taken at its middle.
template <typename T>
Mask<T> is_short(const T& start, const T& end, const T& middle) noexcept {
  return (abs(end - start) <= T(1e-3) * middle) & (start > T(0.0)) & (end > T(0.0));
}

/// Adds the numbers > 0 among base to those that are raised to a power. The other lanes of the result stay as they are.
template <typename T>
void list_powers(const T& base, const T& exponent, T* result, Work<T>& work) noexcept {
  double bases[kMaxLanes], exponents[kMaxLanes];
  base.store_unaligned(bases);
  exponent.store_unaligned(exponents);
  const int place = static_cast<int>(reinterpret_cast<double*>(result) - reinterpret_cast<double*>(work.raised));
  for (int l = 0; l < Work<T>::kLanes; ++l) {
    work.base[work.power_count] = bases[l];
    work.exponent[work.power_count] = exponents[l];
    work.power_of[work.power_count] = place + l;
    work.power_count += bases[l] > 0;
  }
}

/// First pass: which felts act, and the powers of their compressions.
template <typename T>
void find_powers(const Batch& batch, const Mask<T>& is_active, Work<T>& work) noexcept {
  const T zero(0.0);
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  work.power_count = 0;
  for (int c = 0; c < plan.contact_count; ++c) {
    const ContactPlan& contact = plan.contact[c];
    const T start = state.compression[c], end = -gap_at(contact, work.contact[c], work.end_shift);
    const Mask<T> was_closed = state.impulse[contact.row] > zero;
    // one that arrives gives nothing until it is compressed further than it was
    const Mask<T> is_acting =
        is_active & !((start <= zero) & (end <= zero)) & (was_closed | !((end <= start) | (end <= zero)));
    work.end[c] = end;
    work.is_acting[c] = is_acting;
    work.acts[c] = any(is_acting);
    if (!work.acts[c]) continue;
    const T d0 = larger(start, zero), d1 = larger(end, zero), middle = T(0.5) * (d0 + d1);
    const Mask<T> is_at_middle = was_closed & is_short(start, end, middle);
    const T exponent = action.contact[c].exponent;
    work.raised[2 * c] = zero;
    list_powers(select(is_acting, select(is_at_middle, middle, d1), zero), exponent, &work.raised[2 * c], work);
    // that of the start, once a step: 2 % of a period
    const Mask<T> is_new = is_acting & !is_at_middle & !work.is_start_raised[c];
    if (none(is_new)) continue;
    work.raised[2 * c + 1] = select(work.is_start_raised[c], work.raised[2 * c + 1], zero);
    work.is_start_raised[c] = work.is_start_raised[c] | is_new;
    list_powers(select(is_new, d0, zero), exponent, &work.raised[2 * c + 1], work);
  }
  raise<T>(*batch.calls, work.power_count, work.base, work.exponent, work.power);
  double* const results = reinterpret_cast<double*>(work.raised);
  for (int i = 0; i < work.power_count; ++i) results[work.power_of[i]] = work.power[i];
}

template <typename T>
struct MeanForce {
  T force, slope;
};

/// mean_felt_force() where the felt was closed, mean_arrival_force() where it was not.
/// @param first, second  d_1^r, d_0^r, or the former of the middle alone
template <typename T>
MeanForce<T> mean_force(const ContactNumbers<T>& felt, const Mask<T>& was_closed, const T& start, const T& end,
                        const T& from, const T& first, const T& second, double time_step) noexcept {
  const T zero(0.0), r = felt.exponent;
  const T d0 = larger(start, zero), d1 = larger(end, zero), s = end - start, middle = T(0.5) * (d0 + d1);
  const auto is_at_middle = was_closed & is_short(start, end, middle);

  const T f1 = felt.stiffness * first;
  const T bend = r * (r - T(1.0)) * f1 / (middle * middle);
  const T way = select(was_closed, s, end - from);
  const T mean = (f1 * d1 - felt.stiffness * second * d0) / ((r + T(1.0)) * way);
  T force = select(is_at_middle, f1 + bend * s * s / T(24.0), mean);
  T slope = select(is_at_middle, T(0.5) * r * f1 / middle + bend * s / T(12.0), (f1 - mean) / way);
  const auto is_still = was_closed & (s == zero) & !is_at_middle;
  force = select(is_still, zero, force);
  slope = select(is_still, zero, slope);
  force += felt.damping * (d1 * d1 * d1 - d0 * d0 * d0) / T(3 * time_step);
  slope += felt.damping * d1 * d1 / T(time_step);
  return {force, slope};
}

template <typename T>
void add_massless_felts(const Batch& batch, const Mask<T>& is_active, Work<T>& work) noexcept {
  const T zero(0.0);
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const auto& state = *static_cast<const StateNumbers<T>*>(batch.state);
  const double h = batch.settings->time_step;
  find_powers(batch, is_active, work);
  for (int c = 0; c < plan.contact_count; ++c) {
    const ContactPlan& contact = plan.contact[c];
    work.felt_impulse[c] = work.felt_loss[c] = zero;
    if (!work.acts[c]) continue;
    const T start = state.compression[c], before = -gap_at(contact, work.contact[c], work.start_shift);
    const T from = select(before < start, before, start);
    const MeanForce<T> mean = mean_force(action.contact[c], state.impulse[contact.row] > zero, start, work.end[c], from,
                                         work.raised[2 * c], work.raised[2 * c + 1], h);
    const auto is_pushing = work.is_acting[c] & !(mean.force <= zero);
    work.felt_impulse[c] = select(is_pushing, T(h) * mean.force, zero);
    work.felt_loss[c] = select(is_pushing, T(h * h * batch.settings->theta) * mean.slope, zero);
    const T* lever = work.contact[c].normal_lever;
    for (int k = 0; k < contact.path_count; ++k) {
      work.smooth_residual[contact.path[k]] += -work.felt_impulse[c] * lever[k];
      for (int j = 0; j <= k; ++j)
        work.iteration_matrix[contact.path[k]][contact.path[j]] += work.felt_loss[c] * lever[k] * lever[j];
    }
  }
}

}  // namespace erard::lanes
