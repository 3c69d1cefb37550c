// The start of every comparison.
#pragma once

#include <algorithm>

#include "erard/mechanics/contact_frames.hpp"
#include "erard/mechanics/felt_law.hpp"
#include "erard/mechanics/state.hpp"

namespace erard {

/// The model at its initial coordinates, at rest, its felts in static balance with the geometry: each as compressed as
/// the overlap of its two primitives, one with mass that touches nothing as much as its own weight of 10 mg presses it in
/// (some micrometres). (Under dry friction rest is not unique; this is the rest of the file.)
/// With a felt on a fixed axis the overlap is first projected on that axis.
/// @param time_step h: the contacts start with the impulses that their felts give over one step
inline State rest_state(const Mechanism& mechanism, double time_step) noexcept {
  const Model& model = mechanism.model;
  State state;
  state.x.setZero(mechanism.coordinate_count);
  state.v.setZero(mechanism.coordinate_count);
  state.acceleration.setZero(mechanism.coordinate_count);
  state.time_step = time_step;
  state.compression.setZero(mechanism.contact_count());
  state.impulse.setZero(mechanism.rows.count);
  for (int i = 0; i < model.body_count; ++i) state.x[i] = model.bodies[i].initial;
  Frames frames;
  place_bodies(model, state.x, frames);
  for (int c = 0; c < model.contact_count; ++c) {
    if (!model.contacts[c].has_felt || !model.contacts[c].is_active) continue;
    const Felt& law = model.contacts[c].felt;
    const ContactFrame contact = locate_contact(model.contacts[c], frames, 0.0);
    const double overlap = std::max(0.0, -contact.gap / contact.felt_lever);
    const double weight = std::max(0.0, law.mass * contact.felt_slide.dot(model.gravity));
    const int felt = mechanism.felt_coordinate[c];
    (felt < 0 ? state.compression[c] : state.x[felt]) =
        std::max(overlap, std::pow(weight / law.stiffness, 1 / law.exponent));
    if (overlap > 0) state.impulse[mechanism.normal_row[c]] = time_step * elastic_force(law, overlap);
  }
  return state;
}

}  // namespace erard
