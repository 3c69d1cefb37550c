// Where the bodies are: planar kinematics of the tree.
#pragma once

#include <array>
#include <cmath>

#include "erard/mechanics/mechanism.hpp"

namespace erard {

/// r rotated by +90 degrees: the velocity of a point at r when turning at 1 rad/s.
inline Vector2 perp(const Vector2& r) noexcept { return {-r.y(), r.x()}; }

/// z component of a x b.
inline double cross(const Vector2& a, const Vector2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

inline Vector2 unit_vector(double angle) noexcept { return {std::cos(angle), std::sin(angle)}; }

/// Frame of one body in the ground frame.
struct Frame {
  Vector2 origin = Vector2::Zero();   // joint B_O [m]
  double angle = 0;                   // absolute, counterclockwise [rad]
  Vector2 x_axis = Vector2::UnitX();  // unit vector at `angle`
  Vector2 slide = Vector2::Zero();    // axis of a prismatic joint; unused on a hinge

  Vector2 turned(const Vector2& local) const noexcept { return local.x() * x_axis + local.y() * perp(x_axis); }
  Vector2 placed(const Vector2& local) const noexcept { return origin + turned(local); }
};

/// Frames of all bodies.
struct Frames {
  Frame ground;
  std::array<Frame, kMaxBodies> body;

  const Frame& of(int index) const noexcept { return index == kGround ? ground : body[index]; }
};

/// @param x  coordinates (n), indexed by []
template <typename Positions>
void place_bodies(const Model& model, const Positions& x, Frames& frames) noexcept {
  frames.ground = Frame{};
  for (int i = 0; i < model.body_count; ++i) {
    const Body& body = model.bodies[i];
    const Frame& parent = frames.of(body.parent);
    Frame& frame = frames.body[i];
    frame.origin = parent.placed(body.origin);
    frame.angle = parent.angle;
    if (body.joint == JointKind::hinge) {
      frame.angle += x[i];
      frame.slide = Vector2::Zero();
    } else {
      frame.slide = parent.turned(body.direction.unit_vector());
      frame.origin += x[i] * frame.slide;
    }
    frame.x_axis = unit_vector(frame.angle);
  }
}

/// Velocity of a point fixed in the body of coordinate j, per unit rate of that coordinate      [m/rad] or [-]
inline Vector2 point_rate(const Model& model, const Frames& frames, int j, const Vector2& point) noexcept {
  const Frame& frame = frames.body[j];
  return model.bodies[j].joint == JointKind::hinge ? perp(point - frame.origin) : frame.slide;
}

}  // namespace erard
