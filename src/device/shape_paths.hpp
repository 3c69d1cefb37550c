// Primitives of the model as SVG paths, y up, in mm and in the frame of their body.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "erard/device/drawing.hpp"
#include "erard/mechanics/frames.hpp"

namespace erard {

inline constexpr double kMillimetre = 1e3;         // [mm/m]
inline constexpr double kLargestWholeCircle = 15;  // larger ones are drawn as an arc around their point of contact [mm]
inline constexpr double kArc = 12;                 // half of that arc [mm]
inline constexpr double kCirclePad = 10;           // felt on a circle, along it, when no hint says more [mm]

inline std::string arc_path(const Vector2& centre, double radius, double from, double to) {
  const Vector2 start = centre + radius * unit_vector(from), end = centre + radius * unit_vector(to);
  return fmt::format("M {:.4g} {:.4g} A {:.4g} {:.4g} 0 0 1 {:.4g} {:.4g}", start.x(), start.y(), radius, radius,
                     end.x(), end.y());
}

inline std::string circle_path(const Vector2& centre, double radius) {
  return fmt::format("M {:.4g} {:.4g} A {:.4g} {:.4g} 0 0 1 {:.4g} {:.4g} A {:.4g} {:.4g} 0 0 1 {:.4g} {:.4g} Z",
                     centre.x() + radius, centre.y(), radius, radius, centre.x() - radius, centre.y(), radius, radius,
                     centre.x() + radius, centre.y());
}

inline std::string polygon_path(const std::vector<Vector2>& points) {
  std::string path;
  for (const Vector2& p : points) path += fmt::format("{} {:.5g} {:.5g} ", path.empty() ? 'M' : 'L', p.x(), p.y());
  return path + "Z";
}

/// The bare primitive, of a body that nobody has drawn.
inline std::string primitive_path(const Shape& shape, const Vector2& towards) {
  const Vector2 centre = kMillimetre * shape.centre;
  const double radius = kMillimetre * shape.radius;
  if (shape.kind == ShapeKind::circle) {
    if (radius <= kLargestWholeCircle) return circle_path(centre, radius);
    const double middle = std::atan2(towards.y(), towards.x());
    return arc_path(centre, radius, middle - kArc / radius, middle + kArc / radius);
  }
  const Vector2 along = kMillimetre * shape.half_length * unit_vector(shape.direction);
  const Vector2 across = radius * perp(unit_vector(shape.direction));
  if (radius == 0) return polygon_path({centre - along, centre + along});
  return polygon_path(
      {centre - along - across, centre + along - across, centre + along + across, centre - along + across});
}

/// The felt: a layer under the surface of the primitive that carries it.
inline std::string pad_path(const Shape& shape, const Vector2& towards, const FeltDrawing& felt) {
  const Vector2 centre = kMillimetre * shape.centre;
  const double radius = kMillimetre * shape.radius;
  std::vector<Vector2> outside, inside;
  if (shape.kind == ShapeKind::segment) {
    const Vector2 direction = unit_vector(shape.direction);
    const Vector2 normal = perp(direction).dot(towards) < 0 ? Vector2(-perp(direction)) : perp(direction);
    const double whole = kMillimetre * shape.half_length + radius;
    const double half = felt.length > 0 ? std::min(0.5 * felt.length, whole) : whole;
    const Vector2 top = centre + radius * normal;
    return polygon_path({top - half * direction, top + half * direction,
                         top + half * direction - felt.thickness * normal,
                         top - half * direction - felt.thickness * normal});
  }
  const double middle = felt.direction.value_or(std::atan2(towards.y(), towards.x()));
  const double half = std::min(0.5 * (felt.length > 0 ? felt.length : kCirclePad) / radius, 1.3);  // [rad]
  constexpr int kPoints = 16;
  for (int i = 0; i <= kPoints; ++i) {
    const Vector2 ray = unit_vector(middle + half * (2.0 * i / kPoints - 1));
    outside.push_back(centre + radius * ray);
    inside.push_back(centre + std::max(0.0, radius - felt.thickness) * ray);
  }
  outside.insert(outside.end(), inside.rbegin(), inside.rend());
  return polygon_path(outside);
}

/// A bone from the joint to a point, thinner at the end.
inline std::string bone_path(const Vector2& end, double width) {
  if (end.norm() < width) return circle_path(Vector2::Zero(), width);
  const Vector2 across = perp(end.normalized());
  return polygon_path({width * across, end + 0.5 * width * across, end - 0.5 * width * across, -width * across});
}

/// Two turns of a spiral around the joint.
inline std::string spiral_path(double r) {
  std::string path = fmt::format("M {:.4g} 0", r);
  for (int half = 0; half < 4; ++half) {
    const double radius = r * (1.25 + 0.5 * half), end = (half % 2 == 0 ? -1 : 1) * r * (1.5 + 0.5 * half);
    path += fmt::format(" A {0:.4g} {0:.4g} 0 0 1 {1:.4g} 0", radius, end);
  }
  return path;
}

}  // namespace erard
