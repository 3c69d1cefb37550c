// Mechanical energy of the whole: what losses may only lower.
#pragma once

#include "erard/mechanics/dynamics.hpp"
#include "erard/mechanics/felt_law.hpp"
#include "erard/mechanics/state.hpp"

namespace erard {

struct Energy {
  double kinetic = 0;  // v.M v / 2 [J]
  double weight = 0;   // -sum m g.x, origin of the ground frame as level zero [J]
  double springs = 0;  // sum kappa (x - x_0)^2 / 2 [J]
  double felts = 0;    // sum k d^(r+1) / (r+1) [J]

  double total() const noexcept { return kinetic + weight + springs + felts; }
};

/// Energy of a state.
inline Energy measure_energy(const Mechanism& mechanism, const State& state) noexcept {
  const Model& model = mechanism.model;
  Frames frames;
  ContactFrames contacts;
  CoordinateMatrix M;
  place_bodies(model, state.x, frames);
  locate_contacts(mechanism, state.x, frames, contacts);
  assemble_mass_matrix(mechanism, frames, contacts, M);
  Energy energy;
  energy.kinetic = 0.5 * state.v.dot(M * state.v);
  for (int i = 0; i < model.body_count; ++i) {
    const Body& body = model.bodies[i];
    const double stretch = state.x[i] - body.spring.rest;
    energy.weight -= body.mass * model.gravity.dot(frames.body[i].placed(body.centre));
    energy.springs += 0.5 * body.spring.stiffness * stretch * stretch;
  }
  for (int c = 0; c < model.contact_count; ++c) {
    if (!model.contacts[c].has_felt) continue;
    const double compression = compression_of(mechanism, state, c);
    energy.weight -=
        model.contacts[c].felt.mass * model.gravity.dot(contacts[c].felt_point + compression * contacts[c].felt_slide);
    energy.felts += felt_energy(model.contacts[c].felt, compression);
  }
  return energy;
}

}  // namespace erard
