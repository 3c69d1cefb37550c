// One linearisation of the smooth terms about the current iterate of the end velocity.
#pragma once

#include "erard/mechanics/felt_law.hpp"
#include "erard/solver/branch_factor.hpp"
#include "erard/solver/drive.hpp"
#include "erard/solver/scheme.hpp"
#include "erard/solver/workspace.hpp"

namespace erard {

/// Weight with which the end velocity enters the displacement of a step: theta for bodies; 1 for felts, whose light
/// masses ring with theta = 1/2 (their force is the mean over the step, so that nothing is lost in order).
inline double end_weight(const Mechanism& mechanism, const Scheme& scheme, int coordinate) noexcept {
  return mechanism.is_felt(coordinate) ? 1.0 : scheme.theta;
}

/// Mean rate over the step that ends with rate `end`.                              thesis (5.37), (5.39)
inline double mean_rate(const Mechanism& mechanism, const Scheme& scheme, const State& state, int i,
                        double end) noexcept {
  const double weight = end_weight(mechanism, scheme, i);
  return (1 - weight) * state.v[i] + weight * end;
}

/// Places everything at t + theta h of the current iterate; felts at the middle of their path.
inline void place_middle(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                         Workspace& work) noexcept {
  const int n = mechanism.coordinate_count;
  work.middle_velocity.resize(n);
  work.middle_position.resize(n);
  for (int i = 0; i < n; ++i) {
    const double rate = mean_rate(mechanism, scheme, state, i, work.end_velocity[i]);
    const double part = mechanism.is_felt(i) ? 0.5 : scheme.theta;
    work.middle_velocity[i] = rate;
    work.middle_position[i] = state.x[i] + part * scheme.time_step * rate;
  }
  place_bodies(mechanism.model, work.middle_position, work.frames);
  locate_contacts(mechanism, work.middle_position, work.frames, work.contacts);
  assemble_mass_matrix(mechanism, work.frames, work.contacts, work.mass_matrix);
  assemble_bias(mechanism, work.frames, work.contacts, work.middle_velocity, mechanism.model.gravity, work.bias);
}

/// Adds joint springs, viscous losses and felt laws to residual and iteration matrix.
inline void add_compliances(const Mechanism& mechanism, const Scheme& scheme, const State& state,
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

/// Takes the clamped and the prescribed coordinates out: their rows become end velocity = end velocity.
inline void fix_coordinates(const Mechanism& mechanism, Workspace& work) noexcept {
  for (int p = 0; p < mechanism.coordinate_count; ++p) {
    if (!work.is_fixed[p]) continue;
    for (int j = mechanism.parent[p]; j != kGround; j = mechanism.parent[j]) work.iteration_matrix(p, j) = 0;
    for (int i = p + 1; i < mechanism.coordinate_count; ++i) work.iteration_matrix(i, p) = 0;
    work.iteration_matrix(p, p) = 1;
    work.scratch[p] = 0;
  }
}

/// Smooth terms, iteration matrix (factored) and free velocity
///   R = M (v - v_n) + h [N v - weight + c_v v + kappa (x - x_0) + felts - drive]_{n+theta}
///   A = dR/dv ~ M + h theta C + h^2 theta^2 K
///   v_free = v - A^-1 R                                  v: current iterate of the end velocity
inline void linearise(const Mechanism& mechanism, const Scheme& scheme, const Drive& drive, const State& state,
                      Workspace& work) noexcept {
  const double h = scheme.time_step;
  const Finger& finger = mechanism.model.finger;
  place_middle(mechanism, scheme, state, work);

  work.smooth_residual = work.mass_matrix * (work.end_velocity - state.v) + h * work.bias;
  work.iteration_matrix = work.mass_matrix;
  add_compliances(mechanism, scheme, state, work);
  if (drive.kind == DriveKind::force)
    work.smooth_residual[finger.body] +=
        h * finger.arm * ((1 - scheme.theta) * drive.from.value + scheme.theta * drive.to.value);

  work.scratch = work.smooth_residual;
  fix_coordinates(mechanism, work);
  factorise_branches(mechanism, work.iteration_matrix);
  solve_branches(mechanism, work.iteration_matrix, work.scratch);
  work.free_velocity = work.end_velocity - work.scratch;
}

}  // namespace erard
