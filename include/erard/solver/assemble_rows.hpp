// The rows in play: Delassus operator and free velocity of the one-step problem.
#pragma once

#include "erard/solver/linearise.hpp"

namespace erard {

/// A contact without felt.
inline bool is_rigid(const Mechanism& mechanism, const Row& row) noexcept {
  return row.kind == RowKind::normal && mechanism.felt_coordinate[row.index] < 0;
}

/// Whether the law of a row speaks of the position at the end of the step rather than of the velocity there: felts with
/// mass, whose coordinate follows the gap at once, do; without felt the position follows only in part (theta), the gap
/// would alternate, and the law is put on the velocity, with a projection for the position (close_rigid_gaps).
inline bool is_positional(const Mechanism& mechanism, const Row& row) noexcept {
  return row.kind == RowKind::stop || (row.kind == RowKind::normal && !is_rigid(mechanism, row));
}

/// Cone of a row, in impulses over this step.
inline Cone cone_of(const Mechanism& mechanism, const Scheme& scheme, const Workspace& work, const Row& row) noexcept {
  switch (row.kind) {
    case RowKind::tangential:
      if (mechanism.rows.row[row.normal].kind == RowKind::felt)
        return {ConeKind::interval, -1, row.bound * work.felt[row.index].impulse, false};
      return {ConeKind::friction, work.place[row.normal], row.bound, false};
    case RowKind::hinge:
      return {ConeKind::interval, -1, row.bound * scheme.time_step,
              mechanism.model.bodies[row.index].joint == JointKind::hinge};
    default: return {ConeKind::half_line, -1, 0, false};
  }
}

/// Free velocity q of one row.
///   felt and stop: end gap over theta h
///   rigid contact: velocity at the end, plus e times that at the start where the contact closes with a speed that the
///                  loads of one step do not explain                                            thesis 6.2.2
///   others:        velocity at the end
inline double free_row_velocity(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                                const Workspace& work, const Row& row) noexcept {
  if (is_positional(mechanism, row))
    return gap_at(mechanism, work, row, work.free_shift) / (scheme.theta * scheme.time_step);
  const RowDirection direction = direction_of(mechanism, work, row);
  const double after = direction.along(work.free_velocity);
  if (row.kind != RowKind::normal) return after;
  const double before = direction.along(state.v);
  const bool is_impact = before < -2 * std::abs(after - before);
  return after + (is_impact ? mechanism.model.contacts[row.index].restitution * before : 0.0);
}

/// Way of a free fall in one step: less than that is no gap [m].
inline double fall_of(const Mechanism& mechanism, const Scheme& scheme) noexcept {
  return 0.5 * scheme.time_step * scheme.time_step * mechanism.model.gravity.norm();
}

/// Whether a row could act in this step: contacts and stops that the free motion would violate, or that acted before and
/// have not opened.
inline bool may_act(const Mechanism& mechanism, const Scheme& scheme, const State& state, const Workspace& work,
                    int number) noexcept {
  const Row& row = mechanism.rows.row[number];
  switch (row.kind) {
    case RowKind::felt: return false;  // part of the smooth terms
    case RowKind::hinge: return !work.is_fixed[row.index];
    case RowKind::tangential:
      return mechanism.rows.row[row.normal].kind == RowKind::felt ? work.felt[row.index].impulse > 0
                                                                  : work.is_in_play[row.normal];
    default: {
      const bool is_near =
          !is_rigid(mechanism, row) || gap_at(mechanism, work, row, work.start_shift) < fall_of(mechanism, scheme);
      return (state.impulse[number] > 0 && is_near) || gap_at(mechanism, work, row, work.free_shift) < 0;
    }
  }
}

/// Chooses the rows in play. A row once in play stays for the rest of the step.
inline void choose_rows(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                        Workspace& work) noexcept {
  work.row_count = 0;
  for (int k = 0; k < mechanism.rows.count; ++k) {
    if (!work.is_in_play[k]) work.is_in_play[k] = may_act(mechanism, scheme, state, work, k);
    if (!work.is_in_play[k]) continue;
    work.place[k] = work.row_count;
    work.row[work.row_count++] = k;
  }
}

/// A row along which nothing can move (a tangent through the hinge, a stop of a prescribed key) takes no part: its
/// impulse is zero and no other row sees it.
inline void idle_fixed_rows(OneStepProblem& problem) noexcept {
  constexpr double kLeastMobility = 1e-14;  // of the largest of the unit: rounding of a lever arm, squared, is 1e-30
  ByUnit largest;
  for (int i = 0; i < problem.size; ++i) largest.raise(problem.cone[i], problem.W(i, i));
  for (int i = 0; i < problem.size; ++i) {
    if (problem.W(i, i) > kLeastMobility * largest.of(problem.cone[i])) continue;
    problem.W.row(i).setZero();
    problem.W.col(i).setZero();
    problem.W(i, i) = 1;
    problem.q[i] = 0;
  }
}

/// L^-T H of one row, the loads on fixed coordinates left out. @return the last coordinate that it may reach
inline int set_half(const Mechanism& mechanism, const RowDirection& direction, const Workspace& work,
                    double* half) noexcept {
  for (int i = 0; i < mechanism.coordinate_count; ++i) half[i] = 0;
  for (int k = 0; k < direction.count; ++k)
    if (!work.is_fixed[direction.coordinate[k]]) half[direction.coordinate[k]] = direction.lever[k];
  const int last = direction.coordinate[direction.count - 1];
  solve_upwards(mechanism.elimination, work.factor, last, half);
  return last;
}

/// Row of W = G^T A^-1 H = (L^-T G)^T D^-1 (L^-T H). G = H, but felts with mass, leaves of the tree, enter a position with
/// weight 1 where bodies have theta, and the rows are scaled by 1 / theta: G_felt = H_felt / theta.
inline void set_delassus_row(const Mechanism& mechanism, const Scheme& scheme, int i, Workspace& work) noexcept {
  const Row& row = mechanism.rows.row[work.row[i]];
  Coordinates left;  // D^-1 L^-T G
  for (int k = 0; k <= work.last[i]; ++k) left[k] = work.half[i][k];
  if (is_positional(mechanism, row)) {
    const RowDirection direction = direction_of(mechanism, work, row);
    left[work.last[i]] += direction.lever[direction.count - 1] * (1 / scheme.theta - 1);
    // the same again for what it passes on to the coordinates above
    const double more = left[work.last[i]] - work.half[i][work.last[i]];
    for (int a = 0; a < mechanism.elimination.count[work.last[i]]; ++a) {
      const int above = mechanism.elimination.list[work.last[i]][a];
      left[above] -= work.factor(work.last[i], above) * more;
    }
  }
  for (int k = 0; k <= work.last[i]; ++k) left[k] *= work.factor(k, k);
  for (int j = 0; j < work.row_count; ++j) {
    double sum = 0;
    for (int k = 0; k <= std::min(work.last[i], work.last[j]); ++k) sum += left[k] * work.half[j][k];
    work.problem.W(i, j) = sum;
  }
}

/// W, q and the cones of the rows in play.
inline void assemble_problem(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                             Workspace& work) noexcept {
  const int m = work.row_count;
  OneStepProblem& problem = work.problem;
  problem.size = m;
  problem.W.resize(m, m);
  problem.q.resize(m);
  for (int j = 0; j < m; ++j)
    work.last[j] =
        set_half(mechanism, direction_of(mechanism, work, mechanism.rows.row[work.row[j]]), work, work.half[j].data());
  for (int i = 0; i < m; ++i) {
    const Row& row = mechanism.rows.row[work.row[i]];
    set_delassus_row(mechanism, scheme, i, work);
    problem.q[i] = free_row_velocity(mechanism, scheme, state, work, row);
    problem.cone[i] = cone_of(mechanism, scheme, work, row);
  }
  idle_fixed_rows(problem);
}

}  // namespace erard
