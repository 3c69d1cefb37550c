// START HERE: one step of the mechanism.
#pragma once

#include "erard/solver/assemble_rows.hpp"
#include "erard/solver/gauss_seidel.hpp"

namespace erard {

enum class StepStatus {
  converged,
  not_converged,  // an iteration limit was reached; the state is the best found and goes on
  not_finite,     // a number of the input or the result is not finite, or there is no finger to be driven; the state
                  // is left as it was
};

struct StepReport {
  StepStatus status = StepStatus::converged;
  int linearisations = 0;
  int sweeps = 0;            // of all linearisations
  double newton_change = 0;  // of the last linearisation, relative, energy norm [-]
  double sweep_error = 0;    // of the last sweeps: change or residual, relative [-]
  double finger_force = 0;   // mean over the step, positive when the finger presses [N]
};

/// First guess: the velocities of the start; prescribed and clamped coordinates as they will be.
inline void predict(const Mechanism& mechanism, const Drive& drive, const State& state, Workspace& work) noexcept {
  const Model& model = mechanism.model;
  work.is_fixed.fill(false);
  for (int i = 0; i < model.body_count; ++i) work.is_fixed[i] = model.bodies[i].is_held;
  for (int c = 0; c < model.contact_count; ++c)
    if (mechanism.felt_coordinate[c] >= 0) work.is_fixed[mechanism.felt_coordinate[c]] = !model.contacts[c].is_active;
  if (drive.kind == DriveKind::key) work.is_fixed[model.finger.body] = true;

  work.end_velocity = state.v;
  for (int i = 0; i < mechanism.coordinate_count; ++i)
    if (work.is_fixed[i]) work.end_velocity[i] = 0;
  if (drive.kind == DriveKind::key) work.end_velocity[model.finger.body] = -drive.to.rate / model.finger.arm;
  work.guess = state.impulse;
  work.scratch.resize(mechanism.coordinate_count);
  work.all_directions.resize(mechanism.coordinate_count, mechanism.rows.count);
  work.is_in_play.fill(false);
}

/// Impulses of the rows in play, from the last ones known: of the step before, then of the linearisation before.
inline SweepReport solve_rows(const Scheme& scheme, Workspace& work) noexcept {
  work.impulse.resize(work.row_count);
  for (int i = 0; i < work.row_count; ++i) work.impulse[i] = work.guess[work.row[i]];
  const SweepReport report = sweep_gauss_seidel(work.problem, scheme, work.impulse);
  work.guess.setZero();
  for (int i = 0; i < work.row_count; ++i) work.guess[work.row[i]] = work.impulse[i];
  return report;
}

/// Puts rows in play whose contact or stop the new velocity would violate. @return whether there was one
inline bool find_violations(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                            Workspace& work) noexcept {
  bool found = false;
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (work.is_in_play[k] || (row.kind != RowKind::normal && row.kind != RowKind::stop)) continue;
    const Direction direction = std::as_const(work.all_directions).col(k);
    work.is_in_play[k] = end_gap(mechanism, scheme, state, work, row, direction, work.end_velocity) < 0;
    found = found || work.is_in_play[k];
  }
  return found;
}

/// End velocity of this linearisation; @return its change, each coordinate weighted by its pivot D of A = L^T D L (the
/// inertia that moves when the coordinates below it are free), relative to the velocity at hand and to what one step of
/// free fall gives, so that rest has a scale.
inline double update_velocity(const Mechanism& mechanism, const Scheme& scheme, Workspace& work) noexcept {
  work.scratch = work.free_velocity;
  work.scratch.noalias() += work.velocity_per_impulse * work.impulse;
  const double fall = scheme.time_step * mechanism.model.gravity.norm();
  double change = 0;
  double energy = mechanism.total_mass * fall * fall;
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    const double d = work.iteration_matrix(i, i);
    const double step = work.scratch[i] - work.end_velocity[i];
    change += d * step * step;
    energy += d * work.scratch[i] * work.scratch[i];
  }
  work.end_velocity = work.scratch;
  return change > 0 ? std::sqrt(change / energy) : 0.0;
}

/// Projects the penetration of contacts without felt away: smallest displacement in the metric of A.
inline void close_rigid_gaps(const Mechanism& mechanism, const Scheme& scheme, const State& state, Workspace& work,
                             CoordinateVector& end) noexcept {
  constexpr int kProjectionSweeps = 20;  // bounded: what is left is taken up by the next step
  auto& shift = work.scratch;
  shift.setZero();
  bool is_closed = false;
  for (int sweep = 0; sweep < kProjectionSweeps && !is_closed; ++sweep) {
    is_closed = true;
    for (int i = 0; i < work.row_count; ++i) {
      const Row& row = mechanism.rows.row[work.row[i]];
      if (!is_rigid(mechanism, row)) continue;
      const Direction direction = std::as_const(work.all_directions).col(work.row[i]);
      const double gap =
          end_gap(mechanism, scheme, state, work, row, direction, work.end_velocity) + direction.dot(shift);
      if (gap >= 0) continue;
      shift -= work.velocity_per_impulse.col(i) * (gap / work.problem.W(i, i));
      is_closed = false;
    }
  }
  end += shift;
}

/// Mean force of the finger over the step, positive when it presses                             thesis 6, (5.30)
/// `piston`: impulse of its row; `key`: what the equation of motion of the prescribed coordinate lacks. The dry friction
/// of its own hinge is part of that: against the rate, and of a key that is held still as much as it can take over.
inline double finger_force(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive,
                           const Workspace& work) noexcept {
  const double h = scheme.time_step;
  const Finger& finger = mechanism.model.finger;
  if (drive.kind == DriveKind::force) return (1 - scheme.theta) * drive.from.value + scheme.theta * drive.to.value;
  if (drive.kind == DriveKind::key) {
    double lacking = work.smooth_residual[finger.body];
    for (int i = 0; i < work.row_count; ++i) lacking -= work.all_directions(finger.body, work.row[i]) * work.impulse[i];
    const double dry = mechanism.model.bodies[finger.body].dry * h;
    const double rate = work.end_velocity[finger.body];
    lacking += rate > 0 ? dry : rate < 0 ? -dry : -std::clamp(lacking, -dry, dry);
    return -lacking / (finger.arm * h);
  }
  for (int i = 0; i < work.row_count; ++i)
    if (mechanism.rows.row[work.row[i]].kind == RowKind::finger) return work.impulse[i] / h;
  return 0;
}

/// Takes the iterate over as the state at the end of the step, unless a number is not finite.
inline void accept(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, State& state, Workspace& work,
                   StepReport& report) noexcept {
  const Finger& finger = mechanism.model.finger;
  auto& end = work.end_position;
  end.resize(mechanism.coordinate_count);
  for (int i = 0; i < mechanism.coordinate_count; ++i)
    end[i] = state.x[i] + scheme.time_step * mean_rate(mechanism, scheme, state, i, work.end_velocity[i]);
  close_rigid_gaps(mechanism, scheme, state, work, end);
  if (drive.kind == DriveKind::key)
    end[finger.body] = mechanism.model.bodies[finger.body].initial - drive.to.value / finger.arm;
  if (!work.end_velocity.allFinite() || !work.impulse.allFinite() || !end.allFinite()) {
    report.status = StepStatus::not_finite;
    return;
  }
  report.finger_force = finger_force(mechanism, scheme, drive, work);
  state.x = end;
  state.v = work.end_velocity;
  state.impulse = work.guess;
  state.time += scheme.time_step;
}

/// Advances the mechanism by one step h: time-stepping over all events of the step.
///   M(x) dv = (Q(q,v,t) - N(q,v) v) dt + H(q) dr,   laws of the rows                          thesis (5.30)-(5.39)
/// Newton on the smooth terms outside (felts: one linearisation at d = 0 would see no stiffness), one-step non-smooth
/// problem inside. Bounded: newton_limit x sweep_limit sweeps.
/// @param state in: start, out: end of the step; left alone when the report says not_finite
/// No heap, no exceptions; nothing in `work` is read before it is written.
inline StepReport step(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, State& state,
                       Workspace& work) noexcept {
  StepReport report;
  const bool is_driven = drive.kind != DriveKind::none;
  if (!is_finite(drive) || (is_driven && mechanism.model.finger.body == kGround)) {
    report.status = StepStatus::not_finite;
    return report;
  }
  predict(mechanism, drive, state, work);
  bool is_done = false;
  bool is_swept = false;
  while (!is_done && report.linearisations < scheme.newton_limit) {
    ++report.linearisations;
    linearise(mechanism, scheme, drive, state, work);
    choose_rows(mechanism, scheme, drive, state, work);
    assemble_problem(mechanism, scheme, drive, state, work);
    const SweepReport swept = solve_rows(scheme, work);
    report.sweeps += swept.sweeps;
    is_swept = swept.is_converged;
    report.sweep_error = swept.error;
    report.newton_change = update_velocity(mechanism, scheme, work);
    const bool is_complete = !find_violations(mechanism, scheme, state, work);
    is_done = is_complete && report.newton_change <= scheme.newton_tolerance;
  }
  if (!is_done || !is_swept) report.status = StepStatus::not_converged;
  accept(mechanism, scheme, drive, state, work, report);
  return report;
}

}  // namespace erard
