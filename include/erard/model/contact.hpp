// Where two bodies can touch, and what lies between them.
#pragma once

#include "erard/model/body.hpp"

namespace erard {

enum class ShapeKind {
  circle,   // `radius` around `centre`
  segment,  // straight, `half_length` to both sides of `centre`, thickened by the corner radius `radius`
};

/// A contact primitive in the frame of its body                                   thesis Figure 4.8
/// A segment with radius 0 has sharp ends; with a radius it is a capsule, the jack's top: the core is what
/// `half_length` measures, so the whole is 2 (half_length + radius) long. Its distance is two-sided.
struct Shape {
  ShapeKind kind = ShapeKind::circle;
  Vector2 centre = Vector2::Zero();  // [m]
  Heading direction;                 // of a segment [rad]
  double half_length = 0;            // of a segment, corners excluded [m]
  double radius = 0;                 // of the circle (> 0), or of the corners of a segment (>= 0) [m]
};

/// Which way a felt gives.
enum class FeltAxis {
  contact_normal,  // along the common normal, turning with it; reproduces a compliant contact to 0.1-0.4 %
  fixed,           // along `direction` of the carrier's frame; moves the finger force by 2-3 % in the grand action
};

/// A felt: its compression d >= 0 is a coordinate of its own, with or without mass.
///   F = k d^r + b d^2 d'                                                        thesis (4.4), 5.4.2
/// With mass it is a light body on a slide of the body that carries it. Without, it is always in balance: closed, its
/// compression is that of the contact; left alone, it opens at the rate at which its force vanishes.
struct Felt {
  double stiffness = 0;             // k [N/m^r]
  double exponent = 1;              // r >= 1 [-]
  double damping = 0;               // b [N s/m^3]
  double mass = 0;                  // of the part that moves [kg]; 0: a felt without mass, along the contact normal
  Vector2 place = Vector2::Zero();  // of that mass, in the carrier's frame: the zone where the felt is touched [m]
  bool is_carried_by_a = true;
  FeltAxis axis = FeltAxis::contact_normal;
  Heading direction;  // of a fixed axis: outwards, from the carrier to the other body, in the carrier's frame [rad]
};

/// Contact between a primitive of body A and one of body B: Signorini along the normal, Coulomb along the tangent.
/// At least one of the two shapes is a circle.
struct Contact {
  Name name;
  int body_a = kGround;
  int body_b = kGround;
  Shape shape_a;
  Shape shape_b;
  double friction = 0;     // mu >= 0 [-]                                          thesis (4.7), nu in Table 4.5
  double restitution = 0;  // e in [0, 1], of the normal velocity at an impact without felt [-]     thesis 6.2.2
  bool has_felt = false;
  Felt felt;
  bool is_active = true;  // taken out of play by --without
};

/// A contact whose felt is a body on a slide.
inline bool is_felt_body(const Contact& contact) noexcept { return contact.has_felt && contact.felt.mass > 0; }

/// A contact whose felt has no mass.
inline bool is_massless(const Contact& contact) noexcept { return contact.has_felt && !(contact.felt.mass > 0); }

}  // namespace erard
