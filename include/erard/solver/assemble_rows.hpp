// The rows in play: directions, Delassus operator and free velocity of the one-step problem.
#pragma once

#include <utility>

#include "erard/solver/linearise.hpp"

namespace erard {

/// Generalised direction of one row: impulse 1 on the row is impulse direction on the coordinates.
template <typename Column>
void set_direction(const Mechanism& mechanism, const Workspace& work, const Row& row, Column&& direction) noexcept {
  const Model& model = mechanism.model;
  direction.setZero();
  if (row.kind == RowKind::hinge) {
    direction[row.index] = 1;
  } else if (row.kind == RowKind::finger) {
    direction[row.index] = -model.finger.arm;
  } else if (row.kind == RowKind::stop) {
    direction[mechanism.felt_coordinate[row.index]] = 1;
  } else {
    const ContactFrame& frame = work.contacts[row.index];
    const bool is_normal = row.kind == RowKind::normal;
    BodyVector lever;
    set_levers(model, work.frames, model.contacts[row.index], frame.point,
               is_normal ? frame.normal : perp(frame.normal), lever);
    direction.head(model.body_count) = lever;
    const int felt = mechanism.felt_coordinate[row.index];
    if (is_normal && felt >= 0) direction[felt] = frame.felt_lever;
  }
}

/// A contact without felt.
inline bool is_rigid(const Mechanism& mechanism, const Row& row) noexcept {
  return row.kind == RowKind::normal && mechanism.felt_coordinate[row.index] < 0;
}

/// Whether the law of a row speaks of the position at the end of the step rather than of the velocity there: felts, whose
/// coordinate follows the gap at once, do; without felt the position follows only in part (theta), the gap would
/// alternate, and the law is put on the velocity, with a projection for the position (close_rigid_gaps).
inline bool is_positional(const Mechanism& mechanism, const Row& row) noexcept {
  return row.kind == RowKind::stop || (row.kind == RowKind::normal && !is_rigid(mechanism, row));
}

using Direction = DirectionMatrix::ConstColXpr;

/// Gap (normal) or compression (stop) at the end of the step with the end velocity v  [m].
/// The gap is taken at the middle, where the lever arms are, and carried on with them: an error of second order in h
/// that does not add up from step to step.
inline double end_gap(const Mechanism& mechanism, const Scheme& scheme, const State& state, const Workspace& work,
                      const Row& row, const Direction& direction, const CoordinateVector& v) noexcept {
  double gap = row.kind == RowKind::normal ? work.contacts[row.index].gap
                                           : work.middle_position[mechanism.felt_coordinate[row.index]];
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    if (direction[i] == 0) continue;
    const double end = state.x[i] + scheme.time_step * mean_rate(mechanism, scheme, state, i, v[i]);
    gap += direction[i] * (end - work.middle_position[i]);
  }
  return gap;
}

/// Cone of a row, in impulses over this step.
inline Cone cone_of(const Mechanism& mechanism, const Scheme& scheme, const Row& row, int normal) noexcept {
  switch (row.kind) {
    case RowKind::tangential: return {ConeKind::friction, normal, row.bound, false};
    case RowKind::hinge:
      return {ConeKind::interval, -1, row.bound * scheme.time_step,
              mechanism.model.bodies[row.index].joint == JointKind::hinge};
    default: return {ConeKind::half_line, -1, 0, false};
  }
}

/// Kelvin-Voigt element of the drive `piston` over one step, as a compliant half-line:
///   r / h >= a (Y - y) + b (Y' - y') at t + theta h, r >= 0, one of them an equation            thesis 5.4.1
/// that is  u = y'_{n+1} - rest + r compliance >= 0.
struct FingerRow {
  double rest = 0;        // end velocity of the key at which the force vanishes [m/s]
  double compliance = 0;  // [m/(s N s)]
};

inline FingerRow finger_row(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive,
                            const State& state) noexcept {
  const Finger& finger = mechanism.model.finger;
  const double h = scheme.time_step;
  const double theta = scheme.theta;
  const double a = finger.stiffness;
  const double b = finger.damping;
  const double y = -finger.arm * (state.x[finger.body] - mechanism.model.bodies[finger.body].initial);
  const double y_rate = -finger.arm * state.v[finger.body];
  const double Y = (1 - theta) * drive.from.value + theta * drive.to.value;
  const double Y_rate = (1 - theta) * drive.from.rate + theta * drive.to.rate;
  const double force = a * (Y - y - theta * h * (1 - theta) * y_rate) + b * (Y_rate - (1 - theta) * y_rate);
  const double loss = a * theta * theta * h + b * theta;  // of force per m/s of end velocity
  return {force / loss, 1 / (h * loss)};
}

/// Free velocity q of one row.
///   felt and stop: end gap over theta h
///   rigid contact: velocity at the end, plus e times that at the start where the contact closes with a speed that the
///                  loads of one step do not explain                                            thesis 6.2.2
///   others:        velocity at the end
inline double free_row_velocity(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive,
                                const State& state, const Workspace& work, const Row& row,
                                const Direction& direction) noexcept {
  if (is_positional(mechanism, row))
    return end_gap(mechanism, scheme, state, work, row, direction, work.free_velocity) /
           (scheme.theta * scheme.time_step);
  const double after = direction.dot(work.free_velocity);
  if (row.kind == RowKind::finger) return after - finger_row(mechanism, scheme, drive, state).rest;
  if (row.kind != RowKind::normal) return after;
  const double before = direction.dot(state.v);
  const bool is_impact = before < -2 * std::abs(after - before);
  return after + (is_impact ? mechanism.model.contacts[row.index].restitution * before : 0.0);
}

/// Whether a row could act in this step: contacts and stops that the free motion would violate, or that acted before.
inline bool may_act(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                    const Workspace& work, const Row& row, int number, const Direction& direction) noexcept {
  switch (row.kind) {
    case RowKind::hinge: return !work.is_fixed[row.index];
    case RowKind::finger: return drive.kind == DriveKind::piston;
    case RowKind::tangential: return work.is_in_play[row.normal];
    default:
      return (!is_rigid(mechanism, row) && state.impulse[number] > 0) ||
             end_gap(mechanism, scheme, state, work, row, direction, work.free_velocity) < 0;
  }
}

/// Chooses the rows in play and sets their directions H. A row once in play stays for the rest of the step.
inline void choose_rows(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                        Workspace& work) noexcept {
  work.row_count = 0;
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    set_direction(mechanism, work, row, work.all_directions.col(k));
    if (!work.is_in_play[k])
      work.is_in_play[k] =
          may_act(mechanism, scheme, drive, state, work, row, k, std::as_const(work.all_directions).col(k));
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

/// W = G^T A^-1 H, q and the cones of the rows in play. G = H, but felts enter a position with weight 1 where bodies
/// have theta, and the rows are scaled by 1 / theta: G_felt = H_felt / theta.
inline void assemble_problem(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                             Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  const int m = work.row_count;
  OneStepProblem& problem = work.problem;
  problem.size = m;
  problem.W.resize(m, m);
  problem.q.resize(m);
  work.velocity_per_impulse.resize(n, m);
  for (int j = 0; j < m; ++j) {
    work.velocity_per_impulse.col(j) = work.all_directions.col(work.row[j]);
    for (int i = 0; i < n; ++i)
      if (work.is_fixed[i]) work.velocity_per_impulse(i, j) = 0;
    solve_branches(mechanism, work.iteration_matrix, work.velocity_per_impulse.col(j));
  }
  work.scratch.resize(n);
  for (int i = 0; i < m; ++i) {
    const Row& row = mechanism.rows.row[work.row[i]];
    const Direction direction = std::as_const(work.all_directions).col(work.row[i]);
    work.scratch = direction;
    if (is_positional(mechanism, row)) work.scratch.tail(n - mechanism.body_count()) /= scheme.theta;
    problem.W.row(i).noalias() = work.scratch.transpose() * work.velocity_per_impulse;
    problem.q[i] = free_row_velocity(mechanism, scheme, drive, state, work, row, direction);
    if (row.kind == RowKind::finger) problem.W(i, i) += finger_row(mechanism, scheme, drive, state).compliance;
    problem.cone[i] = cone_of(mechanism, scheme, row, row.normal < 0 ? -1 : work.place[row.normal]);
  }
  idle_fixed_rows(problem);
}

}  // namespace erard
