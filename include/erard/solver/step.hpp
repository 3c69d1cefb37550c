// START HERE: one step of the mechanism.
#pragma once

#include "erard/solver/gauss_seidel.hpp"
#include "erard/solver/slide_on.hpp"

namespace erard {

enum class StepStatus {
  converged,
  refused,  // the motion is not as guessed, Scheme::surprise_limit: take shorter steps; the state is left as it was
  not_converged,  // an iteration limit was reached; the state is the best found and goes on
  not_finite,     // a number of the input or the result is not finite, or there is no finger to be driven; the state
                  // is left as it was
};

struct StepReport {
  StepStatus status = StepStatus::converged;
  int linearisations = 0;
  int sweeps = 0;            // of all linearisations
  double newton_change = 0;  // of the last linearisation, relative, energy norm [-]
  double surprise = 0;       // change of the acceleration since the step before, rms of the masses [m/s^2]
  double sweep_error = 0;    // of the last sweeps: change or residual, relative [-]
  double finger_force = 0;   // mean over the step, positive when the finger presses [N]
};

/// First guess: accelerations and forces are those of the step before; prescribed and clamped coordinates as they will
/// be.
inline void predict(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                    Workspace& work) noexcept {
  const Model& model = mechanism.model;
  const double h = scheme.time_step;
  work.is_fixed.fill(false);
  for (int i = 0; i < model.body_count; ++i) work.is_fixed[i] = model.bodies[i].is_held;
  for (int c = 0; c < model.contact_count; ++c)
    if (mechanism.felt_coordinate[c] >= 0) work.is_fixed[mechanism.felt_coordinate[c]] = !model.contacts[c].is_active;
  if (drive.kind == DriveKind::key) work.is_fixed[model.finger.body] = true;

  for (int i = 0; i < mechanism.coordinate_count; ++i)
    work.end_velocity[i] = work.is_fixed[i] ? 0.0 : state.v[i] + h * state.acceleration[i];
  if (drive.kind == DriveKind::key) work.end_velocity[model.finger.body] = -drive.to.rate / model.finger.arm;
  work.guess = h / state.time_step * state.impulse;
  work.is_in_play.fill(false);
}

/// Impulses of the rows in play, from the last ones known: of the step before, then of the linearisation before; and the
/// change of the end velocity with them, dv = dv_free + A^-1 H r.
inline SweepReport sweep_rows(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                              Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  move_freely(mechanism, scheme, state, work);
  choose_rows(mechanism, scheme, state, work);
  assemble_problem(mechanism, scheme, state, work);
  work.impulse.resize(work.row_count);
  for (int j = 0; j < work.row_count; ++j) work.impulse[j] = work.guess[work.row[j]];
  const SweepReport report = sweep_gauss_seidel(work.problem, scheme, work.impulse);

  work.guess.setZero();
  Coordinates gain{};
  for (int j = 0; j < work.row_count; ++j) {
    work.guess[work.row[j]] = work.impulse[j];
    for (int i = 0; i <= work.last[j]; ++i) gain[i] += work.half[j][i] * work.impulse[j];
  }
  solve_downwards(mechanism.elimination, work.factor, gain.data());
  for (int i = 0; i < n; ++i) work.change[i] += gain[i];
  return report;
}

/// Puts rows in play whose contact or stop the new velocity would violate. @return whether there was one
inline bool find_violations(const Mechanism& mechanism, Workspace& work) noexcept {
  bool found = false;
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const RowKind kind = mechanism.rows.row[k].kind;
    if (work.is_in_play[k] || (kind != RowKind::normal && kind != RowKind::stop)) continue;
    work.is_in_play[k] = gap_at(mechanism, work, mechanism.rows.row[k], work.end_shift) < 0;
    found = found || work.is_in_play[k];
  }
  return found;
}

/// End velocity of this linearisation, and the impulses of the laws that are functions of it.
inline void update_velocity(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                            Workspace& work) noexcept {
  for (int i = 0; i < mechanism.coordinate_count; ++i) work.end_velocity[i] += work.change[i];
  find_shift(mechanism, scheme, state, work, work.end_velocity, work.end_shift);
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    const int number = mechanism.normal_row[c];
    if (number < 0 || mechanism.rows.row[number].kind != RowKind::felt) continue;
    const CompliantImpulse& law = work.felt[c];
    const RowDirection direction = direction_of(mechanism, work, mechanism.rows.row[number]);
    work.guess[number] = law.impulse > 0 ? std::max(0.0, law.impulse - law.loss * direction.along(work.change)) : 0.0;
  }
  const Finger& finger = mechanism.model.finger;
  if (work.finger.loss > 0) work.finger.impulse += finger.arm * work.finger.loss * work.change[finger.body];
}

/// How far the end velocity moved in a linearisation, and since the frames were placed.
struct Movement {
  double last = 0;          // [-]
  double acceleration = 0;  // the last, rms of the masses, by the step [m/s^2]
  double since_placed = 0;  // [-]
};

/// Measured as kinetic energy, roughly (the diagonal of M), as a part of that of the end velocity and of what one step of
/// free fall gives, so that rest has a scale; the square root of that.
inline Movement measure_movement(const Mechanism& mechanism, const Scheme& scheme, const Workspace& work) noexcept {
  const double h = scheme.time_step;
  double last = 0, since_placed = 0;
  double whole = mechanism.total_mass * h * h * mechanism.model.gravity.squaredNorm();
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    const double mass = work.mass_matrix(i, i);
    const double since = work.end_velocity[i] - work.placed_velocity[i];
    last += mass * work.change[i] * work.change[i];
    since_placed += mass * since * since;
    whole += mass * work.end_velocity[i] * work.end_velocity[i];
  }
  if (!(whole > 0)) return {};
  return {std::sqrt(last / whole), std::sqrt(last / mechanism.total_mass) / h, std::sqrt(since_placed / whole)};
}

/// Projects the penetration of contacts without felt away, and the gap by which one that acts slides off a curved
/// surface: smallest displacement in the metric of A.
inline void close_rigid_gaps(const Mechanism& mechanism, const Scheme& scheme, Workspace& work) noexcept {
  constexpr int kProjectionSweeps = 20;  // bounded: what is left is taken up by the next step
  const double fall = fall_of(mechanism, scheme);
  bool is_closed = false;
  for (int sweep = 0; sweep < kProjectionSweeps && !is_closed; ++sweep) {
    is_closed = true;
    for (int k = 0; k < mechanism.rows.count; ++k) {
      const Row& row = mechanism.rows.row[k];
      if (!is_rigid(mechanism, row)) continue;
      const double gap = gap_at(mechanism, work, row, work.end_shift);
      const bool has_slid_off = work.guess[k] > 0 && gap > 1e-3 * fall && gap < fall;
      if (gap >= 0 && !has_slid_off) continue;
      const RowDirection direction = direction_of(mechanism, work, row);
      Coordinates way;
      set_half(mechanism, direction, work, way.data());
      solve_downwards(mechanism.elimination, work.factor, way.data());
      const double mobility = direction.along(way);
      if (!(mobility > 0)) continue;  // nothing can move there
      for (int i = 0; i < mechanism.coordinate_count; ++i) work.end_shift[i] -= way[i] * gap / mobility;
      is_closed = false;
    }
  }
}

/// What the equation of motion of the prescribed key lacks over the step [N m s].
inline double key_reaction(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                           Workspace& work) noexcept {
  const double h = scheme.time_step;
  const int key = mechanism.model.finger.body;
  const Body& body = mechanism.model.bodies[key];
  find_middle(mechanism, scheme, state, work);
  double lacking = h * (work.bias[key] + body.viscous * work.middle_velocity[key] +
                        body.spring.stiffness * (work.middle_position[key] - body.spring.rest));
  for (int i = 0; i < mechanism.coordinate_count; ++i)
    lacking += work.mass_matrix(key, i) * (work.end_velocity[i] - state.v[i]);
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const RowDirection direction = direction_of(mechanism, work, mechanism.rows.row[k]);
    for (int j = 0; j < direction.count; ++j)
      if (direction.coordinate[j] == key) lacking -= direction.lever[j] * work.guess[k];
  }
  return lacking;
}

/// Mean force of the finger over the step, positive when it presses                             thesis 6, (5.30)
/// `key`: what holds the key on its way. The dry friction of its own hinge is part of that: against the rate, and of a
/// key that is held still as much as it can take over.
inline double finger_force(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                           Workspace& work) noexcept {
  const double h = scheme.time_step;
  const Finger& finger = mechanism.model.finger;
  if (drive.kind != DriveKind::key) return work.finger.impulse / h;
  const double lacking = key_reaction(mechanism, scheme, state, work);
  const double dry = mechanism.model.bodies[finger.body].dry * h;
  const double rate = work.end_velocity[finger.body];
  const double friction = rate > 0 ? dry : rate < 0 ? -dry : -std::clamp(lacking, -dry, dry);
  return -(lacking + friction) / (finger.arm * h);
}

/// Compressions of the felts without mass at the end of the step: of a closed contact its own, else what is left.
inline void keep_felt_history(const Mechanism& mechanism, const Scheme& scheme, State& state,
                              const Workspace& work) noexcept {
  for (int k = 0; k < mechanism.rows.count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (row.kind != RowKind::felt) continue;
    double& compression = state.compression[row.index];
    const bool is_closed = work.guess[k] > 0;
    if (!is_closed && compression <= 0) continue;
    const double overlap = -gap_at(mechanism, work, row, work.end_shift);
    const Felt& felt = mechanism.model.contacts[row.index].felt;
    const double left = is_closed ? 0.0 : relaxed_compression(felt, compression, scheme.time_step);
    compression = std::max({overlap, left, 0.0});
  }
}

/// Whether the iterate is made of numbers.
inline bool is_finite(const Mechanism& mechanism, const Workspace& work) noexcept {
  bool is_good = work.guess.allFinite();
  for (int i = 0; i < mechanism.coordinate_count; ++i)
    is_good = is_good && std::isfinite(work.end_velocity[i]) && std::isfinite(work.end_shift[i]);
  return is_good;
}

/// Takes the iterate over as the state at the end of the step, unless a number is not finite.
inline void accept(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, State& state, Workspace& work,
                   StepReport& report) noexcept {
  const Finger& finger = mechanism.model.finger;
  if (!is_finite(mechanism, work)) {
    report.status = StepStatus::not_finite;
    return;
  }
  report.finger_force = finger_force(mechanism, scheme, drive, state, work);
  keep_felt_history(mechanism, scheme, state, work);
  if (mechanism.has_rigid_contacts) close_rigid_gaps(mechanism, scheme, work);
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    state.x[i] = work.placed_position[i] + work.end_shift[i];
    state.acceleration[i] = (work.end_velocity[i] - state.v[i]) / scheme.time_step;
    state.v[i] = work.end_velocity[i];
  }
  if (drive.kind == DriveKind::key)
    state.x[finger.body] = mechanism.model.bodies[finger.body].initial - drive.to.value / finger.arm;
  state.impulse = work.guess;
  state.time_step = scheme.time_step;
  state.time += scheme.time_step;
}

/// Advances the mechanism by one step h: time-stepping over all events of the step.
///   M(x) dv = (Q(q,v,t) - N(q,v) v) dt + H(q) dr,   laws of the rows                          thesis (5.30)-(5.39)
/// Newton on the smooth terms outside (the guess is the acceleration of the step before, and is nearly always near enough
/// for one linearisation; the mechanism is placed again only where it was not), the one-step non-smooth problem inside:
/// friction as it was where that obeys its laws, else sweeps. Bounded: newton_limit x sweep_limit sweeps.
/// @param state in: start, out: end of the step; left alone when the report says not_finite or refused
/// No heap, no exceptions; nothing in `work` is read before it is written.
inline StepReport step(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, State& state,
                       Workspace& work) noexcept {
  StepReport report;
  const bool is_driven = drive.kind != DriveKind::none;
  if (!is_finite(drive) || (is_driven && mechanism.model.finger.body == kGround)) {
    report.status = StepStatus::not_finite;
    return report;
  }
  predict(mechanism, scheme, drive, state, work);
  bool is_placed = false;
  bool is_done = false;
  SweepReport swept;
  while (!is_done && report.linearisations < scheme.newton_limit) {
    ++report.linearisations;
    if (!is_placed) place_middle(mechanism, scheme, state, work);
    linearise(mechanism, scheme, drive, state, work);
    if (slide_on(mechanism, scheme, work))
      swept = {0, true, 0};
    else
      swept = sweep_rows(mechanism, scheme, state, work);
    update_velocity(mechanism, scheme, state, work);
    const Movement moved = measure_movement(mechanism, scheme, work);
    const bool is_complete = !find_violations(mechanism, work);
    is_placed = moved.since_placed <= scheme.placement_tolerance;
    is_done = is_complete && is_placed && moved.last <= scheme.newton_tolerance;
    report.sweeps += swept.sweeps;
    report.sweep_error = swept.error;
    report.newton_change = moved.last;
    if (report.linearisations > 1) continue;
    report.surprise = moved.acceleration;
    if (report.surprise > scheme.surprise_limit) {
      report.status = StepStatus::refused;
      return report;
    }
  }
  if (!is_done || !swept.is_converged) report.status = StepStatus::not_converged;
  accept(mechanism, scheme, drive, state, work, report);
  return report;
}

}  // namespace erard
