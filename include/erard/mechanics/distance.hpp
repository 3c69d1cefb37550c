// Gap between two primitives, anywhere along them.
#pragma once

#include <algorithm>
#include <utility>

#include "erard/mechanics/frames.hpp"

namespace erard {

/// A primitive in the ground frame.
struct PlacedShape {
  ShapeKind kind = ShapeKind::circle;
  Vector2 centre = Vector2::Zero();
  Vector2 along = Vector2::UnitX();  // of a segment
  double half_length = 0;
  double radius = 0;
};

/// `shift` moves the primitive in the frame of its body: by -d along the axis of its felt when that axis is fixed.
inline PlacedShape place_shape(const Shape& shape, const Frame& frame, const Vector2& shift) noexcept {
  PlacedShape placed{shape.kind, frame.placed(shape.centre + shift), Vector2::UnitX(), shape.half_length, shape.radius};
  if (shape.kind == ShapeKind::segment) placed.along = frame.turned(shape.direction.unit_vector());
  return placed;
}

/// Smallest distance between two primitives.
struct Separation {
  double gap = 0;                     // < 0 when they overlap [m]
  Vector2 normal = Vector2::UnitY();  // from A to B
  Vector2 point_a = Vector2::Zero();  // on the surface of A
  Vector2 point_b = Vector2::Zero();  // on the surface of B
};

/// Point of the core (the centre of a circle, the straight line of a segment) nearest to a point.
inline Vector2 nearest_on_core(const PlacedShape& shape, const Vector2& point) noexcept {
  if (shape.kind == ShapeKind::circle) return shape.centre;
  const double s = std::clamp(shape.along.dot(point - shape.centre), -shape.half_length, shape.half_length);
  return shape.centre + s * shape.along;
}

///   gap = |c_B - c_A| - rho_A - rho_B        c: nearest points of the two cores
/// At least one of the two is a circle. Where the cores meet (an overlap as deep as the radii) the normal is not
/// defined and e_y is returned: no felt is that thick.
inline Separation separate(const PlacedShape& a, const PlacedShape& b) noexcept {
  const Vector2 core_b = nearest_on_core(b, a.centre);
  const Vector2 core_a = nearest_on_core(a, core_b);
  const Vector2 line = core_b - core_a;
  const double distance = line.norm();
  Separation result;
  if (distance > 0) result.normal = line / distance;
  result.gap = distance - a.radius - b.radius;
  result.point_a = core_a + a.radius * result.normal;
  result.point_b = core_b - b.radius * result.normal;
  return result;
}

}  // namespace erard
