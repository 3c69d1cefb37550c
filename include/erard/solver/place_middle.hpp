// Where the mechanism is in the middle of the step, and all that follows from that alone.
#pragma once

#include "erard/solver/row_direction.hpp"
#include "erard/solver/scheme.hpp"

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

/// Middle of the step of the current iterate; felts with mass at the middle of their path.
inline void find_middle(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                        Workspace& work) noexcept {
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    const double rate = mean_rate(mechanism, scheme, state, i, work.end_velocity[i]);
    const double part = mechanism.is_felt(i) ? 0.5 : scheme.theta;
    work.middle_velocity[i] = rate;
    work.middle_position[i] = state.x[i] + part * scheme.time_step * rate;
  }
}

/// Directions H of all contacts.
inline void set_directions(const Mechanism& mechanism, Workspace& work) noexcept {
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    const ContactFrame& contact = work.contacts[c];
    set_levers(mechanism, work.frames, c, contact.point, contact.normal, contact.felt_lever, work.normal_lever[c]);
    if (mechanism.model.contacts[c].friction > 0)
      set_levers(mechanism, work.frames, c, contact.point, perp(contact.normal), 0, work.tangent_lever[c]);
  }
}

/// Places everything at the middle of the current iterate: frames, gaps, M, bias and the directions of all rows.
inline void place_middle(const Mechanism& mechanism, const Scheme& scheme, const State& state,
                         Workspace& work) noexcept {
  find_middle(mechanism, scheme, state, work);
  work.placed_velocity = work.end_velocity;
  work.placed_position = work.middle_position;
  place_bodies(mechanism.model, work.placed_position, work.frames);
  locate_contacts(mechanism, work.placed_position, work.frames, work.contacts);
  assemble_mass_matrix(mechanism, work.frames, work.contacts, work.mass_matrix);
  assemble_bias(mechanism, work.frames, work.contacts, work.middle_velocity, mechanism.model.gravity, work.bias);
  set_directions(mechanism, work);
  for (int i = 0; i < mechanism.coordinate_count; ++i) work.start_shift[i] = state.x[i] - work.placed_position[i];
}

/// What the coordinates gain from where the frames were placed to the end of the step with the end velocity v.
inline void find_shift(const Mechanism& mechanism, const Scheme& scheme, const State& state, const Workspace& work,
                       const Coordinates& v, Coordinates& shift) noexcept {
  for (int i = 0; i < mechanism.coordinate_count; ++i)
    shift[i] = state.x[i] + scheme.time_step * mean_rate(mechanism, scheme, state, i, v[i]) - work.placed_position[i];
}

/// Gap (felt, normal) or compression (stop) at the end of the step, or at its start [m].
/// The gap is taken at the middle, where the lever arms are, and carried on with them: an error of second order in h
/// that does not add up from step to step.
/// @param shift  (n) of find_shift(), or start_shift
inline double gap_at(const Mechanism& mechanism, const Workspace& work, const Row& row,
                     const Coordinates& shift) noexcept {
  const double placed = row.kind == RowKind::stop ? work.placed_position[mechanism.felt_coordinate[row.index]]
                                                  : work.contacts[row.index].gap;
  return placed + direction_of(mechanism, work, row).along(shift);
}

}  // namespace erard
