// Projected Gauss-Seidel: solver/{one_step_problem,gauss_seidel}.hpp in lanes, operation by operation.
#pragma once

#include <utility>

#include "work.hpp"

namespace erard::lanes {

/// Rows in play of some lanes, the same in all of them.
struct RowsInPlay {
  int count = 0;
  int row[kMaxFrictionRows];  // among the rows with friction, ascending
  bool is_angular[kMaxFrictionRows];
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

/// Product of a row of W with the m impulses. The scalar engine's, an Eigen dot product of runtime size in registers of two,
/// adds up in this order: four sums side by side, put together two by two, then what is left over.
template <typename T>
[[gnu::always_inline]] inline T row_times(const T* W, const T* r, int m) noexcept {
  const auto term = [&](int i) noexcept { return W[i] * r[i]; };
  const int fours = m - m % 4, pairs = m - m % 2;
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

/// The rows in play side by side. Those along which nothing can move take no part.
template <typename T>
void gather_rows(const RowsInPlay& rows, Work<T>& work) noexcept {
  const T zero(0.0);
  AlikeProblem<T>& alike = work.alike;
  const int m = rows.count;
  ByUnit<T> largest;
  for (int i = 0; i < m; ++i) {
    const T* const W = work.W[rows.row[i]];
    for (int j = 0; j < m; ++j) alike.W[i * m + j] = W[rows.row[j]];
    alike.q[i] = work.q[rows.row[i]];
    alike.bound[i] = work.bound[rows.row[i]];
    largest.raise(rows.is_angular[i], W[rows.row[i]]);
  }
  for (int i = 0; i < m; ++i) {
    T& w = alike.W[i * m + i];
    const Mask<T> is_idle = w <= T(1e-14) * (rows.is_angular[i] ? largest.angular : largest.linear);
    if (none(is_idle)) continue;
    for (int j = 0; j < m; ++j) {
      alike.W[i * m + j] = select(is_idle, zero, alike.W[i * m + j]);
      alike.W[j * m + i] = select(is_idle, zero, alike.W[j * m + i]);
    }
    w = select(is_idle, T(1.0), w);
    alike.q[i] = select(is_idle, zero, alike.q[i]);
  }
}

/// @tparam kCount  number of rows, or 0 where the compiler does not know it
template <int kCount, typename T>
T residual(const RowsInPlay& rows, const AlikeProblem<T>& alike, const T* r) noexcept {
  ByUnit<T> error, scale;
  const int m = kCount > 0 ? kCount : rows.count;
  for (int i = 0; i < m; ++i) {
    const T w = alike.W[i * m + i], u = row_times(&alike.W[i * m], r, m) + alike.q[i];
    error.raise(rows.is_angular[i], w * abs(r[i] - project(alike.bound[i], r[i] - u / w)));
    scale.raise(rows.is_angular[i], abs(u - w * r[i]));
  }
  return worst_ratio(error, scale);
}

/// Most rows for which sweeps are unrolled.
inline constexpr int kMostUnrolled = 10;

/// Visits 0 .. count - 1.
template <int kCount, typename Visit>
[[gnu::always_inline]] inline void each_row(int count, Visit&& visit) noexcept {
  if constexpr (kCount > 0) [&]<int... i>(std::integer_sequence<int, i...>) noexcept {
      (visit(i), ...);
    }
  (std::make_integer_sequence<int, kCount>{});
  else for (int i = 0; i < count; ++i) visit(i);
}

/// Changes, relative to what the laws have to stop.
template <typename T>
struct Progress {
  ByUnit<T> change, scale;
};

template <typename T>
[[gnu::always_inline]] inline void visit_row(const AlikeProblem<T>& alike, int m, int i, bool is_angular, T* r,
                                             Progress<T>& progress) noexcept {
  const T w = alike.W[i * m + i], u = row_times(&alike.W[i * m], r, m) + alike.q[i];
  const T impulse = project(alike.bound[i], r[i] - u / w);
  progress.change.raise(is_angular, w * abs(impulse - r[i]));
  progress.scale.raise(is_angular, abs(u - w * r[i]));
  r[i] = impulse;
}

/// One sweep over r. @return largest change of any row, relative
template <int kCount, typename T>
[[gnu::always_inline]] inline T sweep_once(const RowsInPlay& rows, const AlikeProblem<T>& alike, T* r) noexcept {
  const int m = kCount > 0 ? kCount : rows.count;
  Progress<T> progress;
  each_row<kCount>(m, [&](int i) noexcept { visit_row(alike, m, i, rows.is_angular[i], r, progress); });
  return worst_ratio(progress.change, progress.scale);
}

/// Sweeps some lanes, each until it has converged: its impulses are put aside then, while the others go on.
template <int kCount, typename T>
void sweep_until_converged(const Batch& batch, const RowsInPlay& rows, const Mask<T>& which, Sweeps<T>& sweeps,
                           Work<T>& work) noexcept {
  constexpr int kResidualEvery = 10;
  const T tolerance(batch.settings->sweep_tolerance);
  T r[kCount > 0 ? kCount : kMaxFrictionRows];
  each_row<kCount>(rows.count, [&](int i) noexcept { r[i] = work.row_impulse[rows.row[i]]; });
  Mask<T> is_going = which;
  const auto put_aside = [&](const Mask<T>& ends) noexcept {
    each_row<kCount>(rows.count, [&](int i) noexcept {
      T& impulse = work.row_impulse[rows.row[i]];
      impulse = select(ends, r[i], impulse);
    });
  };
  for (int count = 1; count <= batch.settings->sweep_limit; ++count) {
    T error = sweep_once<kCount>(rows, work.alike, r);
    if (count % kResidualEvery == 0) {
      const Mask<T> is_unsure = error > tolerance;
      if (any(is_going & is_unsure)) error = select(is_unsure, residual<kCount>(rows, work.alike, r), error);
    }
    sweeps.error = select(is_going, error, sweeps.error);
    sweeps.count = select(is_going, sweeps.count + T(1.0), sweeps.count);
    const Mask<T> ends = is_going & (error <= tolerance);
    if (none(ends)) continue;
    put_aside(ends);
    is_going = is_going & !ends;
    if (none(is_going)) break;
  }
  put_aside(is_going);
  sweeps.is_converged = (sweeps.is_converged & !which) | (which & !is_going);
}

/// Sweeps lanes in which the same rows are in play. Unrolled, their impulses stay in registers: 2 % of a
/// period (AVX2 4 %), 9 % of the longest.
template <typename T>
void sweep_alike(const Batch& batch, const RowsInPlay& rows, const Mask<T>& which, Sweeps<T>& sweeps,
                 Work<T>& work) noexcept {
  gather_rows(rows, work);
  sweeps.error = select(which, T(0.0), sweeps.error);
  const bool is_done = [&]<int... i>(std::integer_sequence<int, i...>) noexcept {
    return ((rows.count == i + 1 && (sweep_until_converged<i + 1>(batch, rows, which, sweeps, work), true)) || ...);
  }
  (std::make_integer_sequence<int, kMostUnrolled>{});
  if (!is_done) sweep_until_converged<0>(batch, rows, which, sweeps, work);
}

}  // namespace erard::lanes
