// Contact kinematics: gaps, normals and lever arms of all contacts, exact in the configuration at hand.
#pragma once

#include "erard/mechanics/distance.hpp"

namespace erard {

/// One contact in the ground frame.
struct ContactFrame {
  double gap = 0;                        // compression of the felt included: 0 when the felt touches [m]
  Vector2 normal = Vector2::UnitY();     // from A to B
  Vector2 point = Vector2::Zero();       // where the tangential force acts: on the side without felt
  Vector2 felt_point = Vector2::Zero();  // where the mass of the felt is, uncompressed
  Vector2 felt_slide = Vector2::Zero();  // velocity of the felt per unit rate of compression: into the carrier
  double felt_lever = 1;                 // d gap / d compression [-]
};

using ContactFrames = std::array<ContactFrame, kMaxContacts>;

/// Places one contact at the coordinates x (n).
///   felt along the normal:  gap of the undisplaced primitives plus d; lever 1
///   felt on a fixed axis e: the carrier's primitive is displaced by -d e before the gap is taken; lever e.n
inline ContactFrame locate_contact(const Contact& contact, const Frames& frames, double compression) noexcept {
  const Frame& frame_a = frames.of(contact.body_a);
  const Frame& frame_b = frames.of(contact.body_b);
  const bool is_fixed = contact.has_felt && contact.felt.axis == FeltAxis::fixed;
  const Vector2 outwards = is_fixed ? contact.felt.direction.unit_vector() : Vector2(0, 0);
  const Vector2 shift = -compression * outwards;
  const Vector2 none = Vector2::Zero();

  const bool on_a = contact.felt.is_carried_by_a;
  const Separation s = separate(place_shape(contact.shape_a, frame_a, on_a ? shift : none),
                                place_shape(contact.shape_b, frame_b, on_a ? none : shift));
  ContactFrame result;
  result.gap = s.gap;
  result.normal = s.normal;
  result.point = contact.has_felt && on_a ? s.point_b : s.point_a;
  if (!contact.has_felt) return result;

  // towards the other body, as seen from the carrier
  const Vector2 away = on_a ? s.normal : Vector2(-s.normal);
  const Vector2 axis = is_fixed ? (on_a ? frame_a : frame_b).turned(outwards) : away;
  result.felt_slide = -axis;
  if (is_fixed) result.felt_lever = axis.dot(away);
  result.felt_point = (on_a ? frame_a : frame_b).placed(contact.felt.place);
  if (!is_fixed) result.gap += compression;
  return result;
}

/// Lever arms of one direction at one point of a contact, in the order of its path:
///   lever_j = direction . d(p_B - p_A)/dx_j
/// @param felt  lever of the contact's felt coordinate, where the path has one
inline void set_levers(const Mechanism& mechanism, const Frames& frames, int contact, const Vector2& point,
                       const Vector2& direction, double felt, PathValues& lever) noexcept {
  const ContactPath& path = mechanism.path[contact];
  for (int k = 0; k < path.count; ++k) {
    const int j = path.coordinate[k];
    lever[k] =
        mechanism.is_felt(j) ? felt : path.sign[k] * direction.dot(point_rate(mechanism.model, frames, j, point));
  }
}

/// @param x  coordinates (n), indexed by []
template <typename Positions>
void locate_contacts(const Mechanism& mechanism, const Positions& x, const Frames& frames,
                     ContactFrames& contacts) noexcept {
  for (int i = 0; i < mechanism.contact_count(); ++i) {
    const int felt = mechanism.felt_coordinate[i];
    contacts[i] = locate_contact(mechanism.model.contacts[i], frames, felt < 0 ? 0.0 : x[felt]);
  }
}

}  // namespace erard
