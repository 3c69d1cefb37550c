#include "plan.hpp"

#include <algorithm>

namespace erard::lanes {
namespace {

BodyPlan plan_body(const Mechanism& mechanism, int i) noexcept {
  const Body& body = mechanism.model.bodies[i];
  BodyPlan plan{};
  plan.parent = body.parent;
  plan.is_prismatic = body.joint == JointKind::prismatic;
  plan.is_fixed = body.is_held;
  plan.above_count = mechanism.elimination.count[i];
  std::copy_n(mechanism.elimination.list[i].begin(), plan.above_count, plan.above);
  return plan;
}

ContactPlan plan_contact(const Mechanism& mechanism, int c) noexcept {
  const Contact& contact = mechanism.model.contacts[c];
  ContactPlan plan{};
  plan.number = c;
  plan.body_a = contact.body_a;
  plan.body_b = contact.body_b;
  plan.is_segment_a = contact.shape_a.kind == ShapeKind::segment;
  plan.is_segment_b = contact.shape_b.kind == ShapeKind::segment;
  plan.is_point_on_b = contact.felt.is_carried_by_a;
  plan.row = mechanism.normal_row[c];
  plan.has_friction = contact.friction > 0;
  plan.path_count = mechanism.path[c].count;
  std::copy_n(mechanism.path[c].coordinate.begin(), plan.path_count, plan.path);
  std::copy_n(mechanism.path[c].sign.begin(), plan.path_count, plan.sign);
  return plan;
}

Vector<double> numbers_of(const Vector2& vector) noexcept { return {vector.x(), vector.y()}; }

ShapeNumbers<double> numbers_of(const Shape& shape) noexcept {
  return {numbers_of(shape.centre), numbers_of(shape.direction.unit_vector()), shape.half_length, shape.radius};
}

BodyNumbers<double> numbers_of(const Body& body) noexcept {
  return {numbers_of(body.origin),
          numbers_of(body.direction.unit_vector()),
          numbers_of(body.centre),
          body.mass,
          body.inertia,
          body.viscous,
          body.spring.stiffness,
          body.spring.rest,
          body.initial,
          body.dry};
}

ContactNumbers<double> numbers_of(const Contact& contact) noexcept {
  const Felt& felt = contact.felt;
  return {numbers_of(contact.shape_a),
          numbers_of(contact.shape_b),
          contact.friction,
          felt.stiffness,
          felt.exponent,
          felt.damping};
}

}  // namespace

std::optional<Plan> plan_of(const Mechanism& mechanism) noexcept {
  if (mechanism.has_rigid_contacts || mechanism.coordinate_count > mechanism.body_count()) return {};
  Plan plan{};
  plan.body_count = mechanism.body_count();
  plan.row_count = mechanism.rows.count;
  plan.finger_body = mechanism.model.finger.body;
  for (int i = 0; i < plan.body_count; ++i) plan.body[i] = plan_body(mechanism, i);
  int place[kMaxContacts] = {};
  for (int c = 0; c < mechanism.contact_count(); ++c) {
    if (mechanism.normal_row[c] < 0) continue;
    place[c] = plan.contact_count;
    plan.contact[plan.contact_count++] = plan_contact(mechanism, c);
    if (mechanism.path[c].count == 0) return {};
  }
  for (int k = 0; k < plan.row_count; ++k) {
    const Row& row = mechanism.rows.row[k];
    if (row.kind == RowKind::felt) continue;
    const bool is_hinge = row.kind == RowKind::hinge;
    plan.friction_row[plan.friction_row_count++] = {k, is_hinge ? -1 : place[row.index], is_hinge ? row.index : -1,
                                                    is_hinge && !plan.body[row.index].is_prismatic};
  }
  return plan;
}

ActionNumbers<double> numbers_of(const Mechanism& mechanism, const Plan& plan) noexcept {
  const Model& model = mechanism.model;
  ActionNumbers<double> numbers{};
  numbers.gravity = numbers_of(model.gravity);
  numbers.total_mass = mechanism.total_mass;
  numbers.finger_arm = model.finger.arm;
  numbers.finger_stiffness = model.finger.stiffness;
  numbers.finger_damping = model.finger.damping;
  for (int i = 0; i < plan.body_count; ++i) numbers.body[i] = numbers_of(model.bodies[i]);
  for (int c = 0; c < plan.contact_count; ++c) numbers.contact[c] = numbers_of(model.contacts[plan.contact[c].number]);
  return numbers;
}

}  // namespace erard::lanes
