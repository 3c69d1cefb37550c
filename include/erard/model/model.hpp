// All that is loaded and never changes while the mechanism moves. The engine knows bodies, contacts and felts by index.
#pragma once

#include <array>
#include <string_view>

#include "erard/model/capacity.hpp"
#include "erard/model/contact.hpp"

namespace erard {

/// The finger's place: a point of one hinged body at a lever arm from its hinge.
///   y = -arm (theta - theta at the start)          key displacement [m], down positive       thesis 6, (5.4.1)
/// Its two constants are the Kelvin-Voigt element of the drive `piston`.
struct Finger {
  int body = kGround;    // kGround: nothing drives this mechanism
  double arm = 0;        // L [m]
  double stiffness = 0;  // a [N/m]                                               thesis Table 3.1
  double damping = 0;    // b [N s/m]
};

/// A planar tree of bodies with contacts.
/// Coordinates: one per body, in order, then one per felt, in order of the contacts.
struct Model {
  Name name;
  Vector2 gravity{0, -9.81};  // [m/s^2]
  int body_count = 0;
  int contact_count = 0;
  std::array<Body, kMaxBodies> bodies;
  std::array<Contact, kMaxContacts> contacts;
  Finger finger;
};

/// Index of the body or contact of that name, or -1.
inline int find_body(const Model& model, std::string_view name) noexcept {
  for (int i = 0; i < model.body_count; ++i)
    if (model.bodies[i].name.view() == name) return i;
  return -1;
}
inline int find_contact(const Model& model, std::string_view name) noexcept {
  for (int i = 0; i < model.contact_count; ++i)
    if (model.contacts[i].name.view() == name) return i;
  return -1;
}

}  // namespace erard
