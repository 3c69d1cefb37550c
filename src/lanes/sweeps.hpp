// Projected Gauss-Seidel: solver/{one_step_problem,gauss_seidel}.hpp in lanes, operation by operation.
#pragma once

#include "work.hpp"

namespace erard::lanes {

/// What the sweeps of a step have been so far.
template <typename T>
struct Sweeps {
  T count = T(0.0), error = T(0.0);  // error: of the last ones
  Mask<T> is_converged = Mask<T>(false);
  unsigned tangents[kMaxLanes] = {};  // in play in the last ones
};

/// Rows in play of some lanes, the same in all of them.
struct RowsInPlay {
  int count = 0;
  int row[kMaxFrictionRows];  // among the rows with friction, ascending
};

/// Largest of something, rows in m/s and those in rad/s apart.
template <typename T>
struct ByUnit {
  T linear = T(0.0), angular = T(0.0);

  void raise(bool is_angular, const T& value) noexcept {
    T& largest = is_angular ? angular : linear;
    largest = larger(largest, value);
  }
};

template <typename T>
T worst_ratio(const ByUnit<T>& error, const ByUnit<T>& scale) noexcept {
  const T zero(0.0);
  const auto ratio = [&](const T& e, const T& s) noexcept { return select(e > zero, e / s, zero); };
  return larger(ratio(error.linear, scale.linear), ratio(error.angular, scale.angular));
}

/// Product of a row of W with the impulses. The scalar engine's, an Eigen dot product of runtime size in registers of two,
/// adds up in this order: four sums side by side, put together two by two, then what is left over.
template <typename T>
T row_times(const T* W, const T* r, const RowsInPlay& rows) noexcept {
  const auto term = [&](int i) noexcept { return W[rows.row[i]] * r[rows.row[i]]; };
  const int m = rows.count, fours = m - m % 4, pairs = m - m % 2;
  if (m < 2) return m == 1 ? term(0) : T(0.0);
  T even = term(0), odd = term(1);
  if (pairs > 2) {
    T even2 = term(2), odd2 = term(3);
    for (int i = 4; i < fours; i += 4) {
      even += term(i);
      odd += term(i + 1);
      even2 += term(i + 2);
      odd2 += term(i + 3);
    }
    even += even2;
    odd += odd2;
    if (pairs > fours) {
      even += term(fours);
      odd += term(fours + 1);
    }
  }
  const T sum = even + odd;
  return pairs < m ? sum + term(pairs) : sum;
}

/// Bits of clamping by comparisons, also where the impulse is not a number: then it is the second operand that is taken.
template <typename T>
T project(const T& bound, const T& impulse) noexcept {
  return xsimd::min(bound, xsimd::max(-bound, impulse));
}

/// Rows along which nothing can move take no part.
template <typename T>
void idle_fixed_rows(const Plan& plan, const RowsInPlay& rows, const Mask<T>& which, Work<T>& work) noexcept {
  const T zero(0.0);
  ByUnit<T> largest;
  for (int i = 0; i < rows.count; ++i)
    largest.raise(plan.friction_row[rows.row[i]].is_angular, work.W[rows.row[i]][rows.row[i]]);
  for (int i = 0; i < rows.count; ++i) {
    const int k = rows.row[i];
    const T& most = plan.friction_row[k].is_angular ? largest.angular : largest.linear;
    const Mask<T> is_idle = which & (work.W[k][k] <= T(1e-14) * most);
    if (none(is_idle)) continue;
    for (int j = 0; j < rows.count; ++j) {
      work.W[k][rows.row[j]] = select(is_idle, zero, work.W[k][rows.row[j]]);
      work.W[rows.row[j]][k] = select(is_idle, zero, work.W[rows.row[j]][k]);
    }
    work.W[k][k] = select(is_idle, T(1.0), work.W[k][k]);
    work.q[k] = select(is_idle, zero, work.q[k]);
  }
}

template <typename T>
T residual(const Plan& plan, const RowsInPlay& rows, const Work<T>& work) noexcept {
  const T* r = work.row_impulse;
  ByUnit<T> error, scale;
  for (int i = 0; i < rows.count; ++i) {
    const int k = rows.row[i];
    const bool is_angular = plan.friction_row[k].is_angular;
    const T w = work.W[k][k], u = row_times(work.W[k], r, rows) + work.q[k];
    error.raise(is_angular, w * abs(r[k] - project(work.bound[k], r[k] - u / w)));
    scale.raise(is_angular, abs(u - w * r[k]));
  }
  return worst_ratio(error, scale);
}

/// Sweeps lanes in which the same rows are in play, each until it has converged.
template <typename T>
void sweep_alike(const Batch& batch, const RowsInPlay& rows, const Mask<T>& which, Sweeps<T>& sweeps,
                 Work<T>& work) noexcept {
  constexpr int kResidualEvery = 10;
  const Plan& plan = *batch.plan;
  const T tolerance(batch.settings->sweep_tolerance);
  T* r = work.row_impulse;
  Mask<T> is_going = which;
  sweeps.error = select(which, T(0.0), sweeps.error);
  idle_fixed_rows(plan, rows, which, work);
  for (int count = 1; count <= batch.settings->sweep_limit && any(is_going); ++count) {
    ByUnit<T> change, scale;
    for (int i = 0; i < rows.count; ++i) {
      const int k = rows.row[i];
      const bool is_angular = plan.friction_row[k].is_angular;
      const T w = work.W[k][k], u = row_times(work.W[k], r, rows) + work.q[k];
      const T impulse = project(work.bound[k], r[k] - u / w);
      change.raise(is_angular, w * abs(impulse - r[k]));
      scale.raise(is_angular, abs(u - w * r[k]));
      r[k] = select(is_going, impulse, r[k]);
    }
    T error = worst_ratio(change, scale);
    if (count % kResidualEvery == 0) {
      const Mask<T> is_unsure = error > tolerance;
      if (any(is_going & is_unsure)) error = select(is_unsure, residual(plan, rows, work), error);
    }
    sweeps.error = select(is_going, error, sweeps.error);
    sweeps.count = select(is_going, sweeps.count + T(1.0), sweeps.count);
    is_going = is_going & !(error <= tolerance);
  }
  sweeps.is_converged = (sweeps.is_converged & !which) | (which & !is_going);
}

/// Solves the one-step problems of some lanes, those with the same rows in play together. Rows out of play: 0.
template <typename T>
void sweep(const Batch& batch, const Mask<T>& is_wanted, Sweeps<T>& sweeps, Work<T>& work) noexcept {
  const int size = batch.plan->friction_row_count;
  for (int r = 0; r < size; ++r)
    work.row_impulse[r] = select(is_wanted & work.is_in_play[r], work.row_impulse[r], T(0.0));
  Mask<T> is_left = is_wanted;
  while (any(is_left)) {
    // those that have in play what the first of them has
    bool lanes[kMaxLanes], in_play[kMaxLanes];
    is_left.store_unaligned(lanes);
    int first = 0;
    while (!lanes[first]) ++first;
    RowsInPlay rows;
    unsigned tangents = 0;
    Mask<T> is_alike = is_left;
    for (int r = 0; r < size; ++r) {
      work.is_in_play[r].store_unaligned(in_play);
      if (in_play[first]) rows.row[rows.count++] = r;
      if (in_play[first] && batch.plan->friction_row[r].contact >= 0) tangents |= 1u << r;
      is_alike = is_alike & (in_play[first] ? work.is_in_play[r] : !work.is_in_play[r]);
    }
    sweep_alike(batch, rows, is_alike, sweeps, work);
    is_alike.store_unaligned(lanes);
    for (int l = 0; l < Work<T>::kLanes; ++l)
      if (lanes[l]) sweeps.tangents[l] = tangents;
    is_left = is_left & !is_alike;
  }
}

}  // namespace erard::lanes
