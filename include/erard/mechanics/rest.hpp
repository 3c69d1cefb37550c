// The start of every comparison.
#pragma once

#include <algorithm>

#include "erard/mechanics/contact_frames.hpp"
#include "erard/mechanics/felt_law.hpp"
#include "erard/mechanics/state.hpp"

namespace erard {

/// The model at its initial coordinates, at rest, its felts in static balance with the geometry: each as compressed as
/// the overlap of its two primitives. (Under dry friction rest is not unique; this is the rest of the file.)
/// With a felt on a fixed axis the overlap is first projected on that axis.
/// @param time_step h: the contacts start with the impulses that their felts give over one step
inline State rest_state(const Mechanism& mechanism, double time_step) noexcept {
  const Model& model = mechanism.model;
  State state;
  state.x.setZero(mechanism.coordinate_count);
  state.v.setZero(mechanism.coordinate_count);
  state.impulse.setZero(mechanism.rows.count);
  for (int i = 0; i < model.body_count; ++i) state.x[i] = model.bodies[i].initial;
  Frames frames;
  place_bodies(model, state.x, frames);
  for (int c = 0; c < model.contact_count; ++c) {
    const int felt = mechanism.felt_coordinate[c];
    if (felt < 0 || !model.contacts[c].is_active) continue;
    const ContactFrame contact = locate_contact(model.contacts[c], frames, 0.0);
    state.x[felt] = std::max(0.0, -contact.gap / contact.felt_lever);
    state.impulse[find_row(mechanism.rows, RowKind::normal, c)] =
        time_step * elastic_force(model.contacts[c].felt, state.x[felt]);
  }
  return state;
}

}  // namespace erard
