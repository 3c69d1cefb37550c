// The one-step problem when nothing starts or stops: friction as it was a step ago.
#pragma once

#include "erard/solver/assemble_rows.hpp"

namespace erard {

/// What friction did last, put to the test.
struct LastFriction {
  std::array<bool, kMaxCoordinates> is_out;  // of each coordinate: fixed, or its hinge sticks
  Coordinates load;                          // of the rows that slide
};

/// Friction of the last known impulses: a row at its bound slides on, a hinge below it sticks.
/// @return false where that does not settle the problem: tangents that stick, contacts that are not smooth
inline bool recall_friction(const Mechanism& mechanism, const Scheme& scheme, Workspace& work,
                            LastFriction& last) noexcept {
  constexpr double kAtBound = 0.99;  // a tangent's bound moves with its normal impulse; a wrong guess costs time only
  last.is_out = work.is_fixed;
  last.load.fill(0);
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (row.kind == RowKind::felt) continue;
    if (row.kind == RowKind::normal || row.kind == RowKind::stop) return false;
    const double impulse = work.guess[k];
    if (row.kind == RowKind::tangential) {
      if (work.felt[row.index].impulse > 0) {
        const double bound = row.bound * work.felt[row.index].impulse;
        if (std::abs(impulse) < kAtBound * row.bound * work.guess[row.normal]) return false;
        work.guess[k] = std::copysign(bound, impulse);
        direction_of(mechanism, work, row).apply(work.guess[k], last.load);
      } else {
        work.guess[k] = 0;
      }
    } else if (!work.is_fixed[row.index]) {
      const double bound = row.bound * scheme.time_step;
      if (std::abs(impulse) >= kAtBound * bound) {
        work.guess[k] = std::copysign(bound, impulse);
        last.load[row.index] += work.guess[k];
      } else {
        last.is_out[row.index] = true;
      }
    }
  }
  return true;
}

/// (A dv + R)_i of one coordinate: the load that its change of velocity needs from the rows in play [N m s].
inline double needed_load(const Mechanism& mechanism, const Workspace& work, int i) noexcept {
  double sum = work.smooth_residual[i];
  for (int j = 0; j < mechanism.coordinate_count; ++j)
    sum += (j <= i ? work.iteration_matrix(i, j) : work.iteration_matrix(j, i)) * work.change[j];
  return sum;
}

/// Change of the end velocity with that friction: hinges that stick are stopped, the others obey
///   A_ff dv_f = -R_f + load - A_fs dv_s                     f: coordinates that move, s: stopped or fixed
inline void move_with(const Mechanism& mechanism, const LastFriction& last, Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  auto& dv = work.change;
  for (int i = 0; i < n; ++i) dv[i] = last.load[i] - work.smooth_residual[i];
  for (int s = 0; s < n; ++s) {
    if (!last.is_out[s]) continue;
    dv[s] = work.is_fixed[s] ? 0.0 : -work.end_velocity[s];
    if (dv[s] == 0) continue;
    for (int i = 0; i < n; ++i)
      if (!last.is_out[i]) dv[i] -= (s <= i ? work.iteration_matrix(i, s) : work.iteration_matrix(s, i)) * dv[s];
  }
  factorise_without(mechanism, last.is_out, work);
  solve_upwards(mechanism.elimination, work.factor, n - 1, dv.data());
  solve_downwards(mechanism.elimination, work.factor, dv.data());
}

/// Whether what slides still goes against its friction and what sticks needs no more than its bound; the impulses of the
/// hinges that stick are kept.
inline bool obeys_friction(const Mechanism& mechanism, const Scheme& scheme, const LastFriction& last,
                           Workspace& work) noexcept {
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (row.kind == RowKind::felt) continue;
    if (row.kind == RowKind::hinge && last.is_out[row.index]) {
      if (work.is_fixed[row.index]) continue;
      work.guess[k] = needed_load(mechanism, work, row.index) - last.load[row.index];
      if (std::abs(work.guess[k]) > row.bound * scheme.time_step) return false;
    } else if (work.guess[k] != 0) {
      const RowDirection direction = direction_of(mechanism, work, row);
      if (work.guess[k] * (direction.along(work.end_velocity) + direction.along(work.change)) > 0) return false;
    }
  }
  return true;
}

/// Solves the one-step problem by the friction of the last impulses: one linear system, neither W nor sweeps. Where it
/// obeys all laws it is the solution, which friction with given bounds has one of. Most steps of a keystroke are like
/// that; what they save: docs/performance.md.
/// @return whether it does; if so, work.change and work.guess are those of the solution
inline bool slide_on(const Mechanism& mechanism, const Scheme& scheme, Workspace& work) noexcept {
  LastFriction last;
  if (!scheme.is_friction_recalled || !recall_friction(mechanism, scheme, work, last)) return false;
  move_with(mechanism, last, work);
  return obeys_friction(mechanism, scheme, last, work);
}

}  // namespace erard
