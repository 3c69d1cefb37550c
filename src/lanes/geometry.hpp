// Where the bodies and contacts of the keys are: mechanics/{frames,distance,contact_frames}.hpp in lanes, operation by
// operation.
#pragma once

#include "functions.hpp"

namespace erard::lanes {

/// Local vector of a body in ground axes; the ground's own stays.
template <typename T>
Vector<T> turned(const Work<T>& work, int body, const Vector<T>& local) noexcept {
  if (body < 0) return local;
  const Vector<T> x_axis{work.cosine[body], work.sine[body]};
  return local.x * x_axis + local.y * perp(x_axis);
}

template <typename T>
Vector<T> placed(const Work<T>& work, int body, const Vector<T>& local) noexcept {
  return body < 0 ? local : work.origin[body] + turned(work, body, local);
}

/// @param is_moved  lanes whose positions are others than before
template <typename T>
void place_bodies(const Batch& batch, const Mask<T>& is_moved, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  const T* x = work.placed_position;
  for (int i = 0; i < plan.body_count; ++i) {
    const BodyPlan& body = plan.body[i];
    const T carried = body.parent < 0 ? T(0.0) : work.angle[body.parent];
    work.angle[i] = body.is_prismatic ? carried : carried + x[i];
  }
  turn(*batch.calls, plan.body_count, is_moved, work.angle, work.cosine, work.sine);
  for (int i = 0; i < plan.body_count; ++i) {
    const BodyPlan& body = plan.body[i];
    work.origin[i] = placed(work, body.parent, action.body[i].origin);
    if (!body.is_prismatic) continue;
    work.slide[i] = turned(work, body.parent, action.body[i].direction);
    work.origin[i] = work.origin[i] + x[i] * work.slide[i];
  }
}

template <typename T>
struct PlacedShape {
  bool is_segment;
  Vector<T> centre, along;
  T half_length, radius;
};

template <typename T>
PlacedShape<T> place_shape(bool is_segment, const ShapeNumbers<T>& shape, int body, const Work<T>& work) noexcept {
  PlacedShape<T> result;  // member by member: braces make the compiler clear all of it first
  result.is_segment = is_segment;
  result.centre = placed(work, body, shape.centre);
  result.half_length = shape.half_length;
  result.radius = shape.radius;
  if (is_segment) result.along = turned(work, body, shape.direction);
  return result;
}

template <typename T>
Vector<T> nearest_on_core(const PlacedShape<T>& shape, const Vector<T>& point) noexcept {
  if (!shape.is_segment) return shape.centre;
  const T along = dot(shape.along, point - shape.centre), end = shape.half_length;
  const T s = select(along < -end, -end, select(end < along, end, along));
  return shape.centre + s * shape.along;
}

/// Gap, normal, and the point where friction acts.
template <typename T>
void locate(const ContactPlan& plan, const ContactNumbers<T>& numbers, const Work<T>& work,
            PlacedContact<T>& contact) noexcept {
  const PlacedShape<T> a = place_shape(plan.is_segment_a, numbers.shape_a, plan.body_a, work);
  const PlacedShape<T> b = place_shape(plan.is_segment_b, numbers.shape_b, plan.body_b, work);
  const Vector<T> core_b = nearest_on_core(b, a.centre);
  const Vector<T> core_a = nearest_on_core(a, core_b);
  const Vector<T> line = core_b - core_a;
  const T distance = sqrt(dot(line, line));
  const auto is_apart = distance > T(0.0);
  contact.normal = {select(is_apart, line.x / distance, T(0.0)), select(is_apart, line.y / distance, T(1.0))};
  contact.gap = distance - a.radius - b.radius;
  contact.point = plan.is_point_on_b ? core_b - b.radius * contact.normal : core_a + a.radius * contact.normal;
}

template <typename T>
void set_levers(const Plan& plan, const ContactPlan& contact, const Vector<T>& point, const Vector<T>& direction,
                const Work<T>& work, T* lever) noexcept {
  for (int k = 0; k < contact.path_count; ++k) {
    const int j = contact.path[k];
    const Vector<T> rate = plan.body[j].is_prismatic ? work.slide[j] : perp(point - work.origin[j]);
    lever[k] = T(contact.sign[k]) * dot(direction, rate);
  }
}

template <typename T>
void locate_contacts(const Batch& batch, Work<T>& work) noexcept {
  const Plan& plan = *batch.plan;
  const auto& action = *static_cast<const ActionNumbers<T>*>(batch.action);
  for (int c = 0; c < plan.contact_count; ++c) {
    const ContactPlan& contact = plan.contact[c];
    PlacedContact<T>& place = work.contact[c];
    locate(contact, action.contact[c], work, place);
    set_levers(plan, contact, place.point, place.normal, work, place.normal_lever);
    if (contact.has_friction) set_levers(plan, contact, place.point, perp(place.normal), work, place.tangent_lever);
  }
}

}  // namespace erard::lanes
