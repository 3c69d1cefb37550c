#include "study/rigid_contact.hpp"

namespace erard::study {

void remove_felt(Model& model, int contact, double restitution) {
  Contact& c = model.contacts[static_cast<std::size_t>(contact)];
  const int carrier = c.felt.is_carried_by_a ? c.body_a : c.body_b;
  if (carrier != kGround) {
    Body& body = model.bodies[static_cast<std::size_t>(carrier)];
    const Vector2 moment = body.mass * body.centre + c.felt.mass * c.felt.place;
    body.mass += c.felt.mass;
    body.centre = moment / body.mass;
    body.inertia += c.felt.mass * c.felt.place.squaredNorm();
  }
  c.has_felt = false;
  c.restitution = restitution;
}

void set_back(Model& model, int contact, double depth) {
  Contact& c = model.contacts[static_cast<std::size_t>(contact)];
  (c.shape_a.kind == ShapeKind::circle ? c.shape_a : c.shape_b).radius -= depth;
}

}  // namespace erard::study
