// One linearisation of the smooth terms about the current iterate of the end velocity.
#pragma once

#include "erard/mechanics/felt_law.hpp"
#include "erard/solver/branch_factor.hpp"
#include "erard/solver/drive.hpp"
#include "erard/solver/place_middle.hpp"

namespace erard {

/// Adds joint springs, viscous losses and the laws of felts with mass to residual and iteration matrix.
inline void add_own_laws(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                         Workspace& work) noexcept {
  const double h = scheme.time_step;
  const double theta = scheme.theta;
  auto& R = work.smooth_residual;
  auto& A = work.iteration_matrix;
  for (int i = 0; i < mechanism.body_count(); ++i) {
    const Body& body = mechanism.model.bodies[i];
    const double stretch = work.middle_position[i] - body.spring.rest;
    R[i] += h * (body.viscous * work.middle_velocity[i] + body.spring.stiffness * stretch);
    A(i, i) += h * theta * body.viscous + h * h * theta * theta * body.spring.stiffness;
  }
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    const int i = mechanism.felt_coordinate[c];
    if (i < 0) continue;
    const MeanForce felt =
        mean_felt_force(mechanism.model.contacts[c].felt, state.x[i], state.x[i] + h * work.end_velocity[i], h);
    R[i] += h * felt.force;
    A(i, i) += h * h * felt.slope;
  }
}

/// Felts without mass: each contact gives over the step the mean of the felt's law along its path,
///   r = h max(0, F(d_n -> d_e)),   d_e = -gap at the end of the step
/// and where the contact was open the mean is over the whole way of the body, the air included.
/// It cannot pull: where F would, the felt is left behind.
inline void add_massless_felts(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                               Workspace& work) noexcept {
  const double h = scheme.time_step;
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    CompliantImpulse& law = work.felt[c];
    law = {};
    const int number = mechanism.normal_row[c];
    if (number < 0 || mechanism.rows.row[number].kind != RowKind::felt) continue;
    const Row& row = mechanism.rows.row[number];
    const double start = state.compression[c];
    const double end = -gap_at(mechanism, work, row, work.end_shift);
    if (start <= 0 && end <= 0) continue;
    const Felt& felt = mechanism.model.contacts[c].felt;
    const MeanForce mean =
        state.impulse[number] > 0
            ? mean_felt_force(felt, start, end, h)
            : mean_arrival_force(felt, std::min(start, -gap_at(mechanism, work, row, work.start_shift)), start, end, h);
    if (mean.force <= 0) continue;
    law = {h * mean.force, h * h * scheme.theta * mean.slope};
    const RowDirection direction = direction_of(mechanism, work, row);
    direction.apply(-law.impulse, work.smooth_residual);
    direction.couple(law.loss, work.iteration_matrix);
  }
}

/// The finger: a given force, or the Kelvin-Voigt element of the drive `piston`, taken at t + theta h,
///   r = h max(0, a (Y - y) + b (Y' - y'))                                        thesis 5.4.1, Table 3.1
inline void add_finger(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, Workspace& work) noexcept {
  const Finger& finger = mechanism.model.finger;
  const double h = scheme.time_step;
  const double theta = scheme.theta;
  const double value = (1 - theta) * drive.from.value + theta * drive.to.value;
  work.finger = {};
  if (drive.kind == DriveKind::force) work.finger.impulse = h * value;
  if (drive.kind == DriveKind::piston) {
    const double a = finger.stiffness;
    const double b = finger.damping;
    const double rate = (1 - theta) * drive.from.rate + theta * drive.to.rate;
    const double y = -finger.arm * (work.middle_position[finger.body] - mechanism.model.bodies[finger.body].initial);
    const double force = a * (value - y) + b * (rate + finger.arm * work.middle_velocity[finger.body]);
    if (force > 0) work.finger = {h * force, h * theta * (a * theta * h + b)};
  }
  if (work.finger.impulse == 0) return;
  work.smooth_residual[finger.body] += finger.arm * work.finger.impulse;
  work.iteration_matrix(finger.body, finger.body) += finger.arm * finger.arm * work.finger.loss;
}

/// R <- M (v - v_n) + h bias,   A <- M
inline void add_inertia(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                        Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  Coordinates gained;
  for (int i = 0; i < n; ++i) gained[i] = work.end_velocity[i] - state.v[i];
  for (int i = 0; i < n; ++i) {
    double sum = scheme.time_step * work.bias[i];
    for (int j = 0; j < n; ++j) sum += work.mass_matrix(i, j) * gained[j];
    work.smooth_residual[i] = sum;
  }
  work.iteration_matrix = work.mass_matrix;
}

/// Smooth terms and iteration matrix about the current iterate v of the end velocity,
///   R = M (v - v_n) + h [N v - weight + c_v v + kappa (x - x_0) + felts - finger]_{n+theta}
///   A = dR/dv ~ M + h theta C + h^2 theta^2 K
inline void linearise(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                      Workspace& work) noexcept {
  find_middle(mechanism, scheme, state, work);
  find_shift(mechanism, scheme, state, work, work.end_velocity, work.end_shift);
  add_inertia(mechanism, scheme, state, work);
  add_own_laws(mechanism, scheme, state, work);
  add_massless_felts(mechanism, scheme, state, work);
  add_finger(mechanism, scheme, drive, work);
}

/// Factors A with some coordinates taken out: their change is what stands in the load.
inline void factorise_without(const Mechanism& mechanism, const std::array<bool, kMaxCoordinates>& is_out,
                              Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  work.factor = work.iteration_matrix;
  for (int p = 0; p < n; ++p) {
    if (!is_out[p]) continue;
    for (int j = 0; j < p; ++j) work.factor(p, j) = 0;
    for (int i = p + 1; i < n; ++i) work.factor(i, p) = 0;
    work.factor(p, p) = 1;
  }
  factorise_branches(mechanism.elimination, work.factor);
}

/// Change of the end velocity without the rows in play, and where it leads,
///   A dv = -R,   v_free = v + dv
inline void move_freely(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                        Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  factorise_without(mechanism, work.is_fixed, work);
  for (int i = 0; i < n; ++i) work.change[i] = work.is_fixed[i] ? 0.0 : -work.smooth_residual[i];
  solve_upwards(mechanism.elimination, work.factor, n - 1, work.change.data());
  solve_downwards(mechanism.elimination, work.factor, work.change.data());
  for (int i = 0; i < n; ++i) work.free_velocity[i] = work.end_velocity[i] + work.change[i];
  find_shift(mechanism, scheme, state, work, work.free_velocity, work.free_shift);
}

}  // namespace erard
