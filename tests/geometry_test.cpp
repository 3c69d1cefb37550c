// Distances, contact frames and lever arms.
#include <gtest/gtest.h>

#include <random>

#include "erard/mechanics/contact_frames.hpp"
#include "support/models.hpp"

namespace erard {
namespace {

PlacedShape circle(double x, double y, double radius) {
  return {ShapeKind::circle, {x, y}, Vector2::UnitX(), 0, radius};
}
PlacedShape segment(double x, double y, double angle, double half, double radius = 0) {
  return {ShapeKind::segment, {x, y}, unit_vector(angle), half, radius};
}

TEST(Distance, TwoCirclesAreCentreDistanceMinusRadii) {
  const Separation s = separate(circle(0, 0, 1), circle(3, 4, 2));
  EXPECT_DOUBLE_EQ(s.gap, 2);
  EXPECT_NEAR((s.normal - Vector2(0.6, 0.8)).norm(), 0, 1e-15);
  EXPECT_NEAR((s.point_a - Vector2(0.6, 0.8)).norm(), 0, 1e-15);
  EXPECT_NEAR((s.point_b - Vector2(1.8, 2.4)).norm(), 0, 1e-15);
}

TEST(Distance, OverASegmentIsTheHeight) {
  const Separation s = separate(circle(0.3, 2, 0.5), segment(0, 0, 0, 1));
  EXPECT_DOUBLE_EQ(s.gap, 1.5);
  EXPECT_NEAR((s.normal - Vector2(0, -1)).norm(), 0, 1e-15);
  EXPECT_NEAR((s.point_b - Vector2(0.3, 0)).norm(), 0, 1e-15);
}

TEST(Distance, PastTheEndOfASegmentIsTheDistanceToItsCorner) {
  EXPECT_DOUBLE_EQ(separate(segment(0, 0, 0, 1), circle(4, 4, 2)).gap, 3);
  EXPECT_DOUBLE_EQ(separate(segment(0, 0, 0, 1, 0.25), circle(4, 4, 2)).gap, 2.75);  // rounded corner
}

TEST(Distance, IsTwoSided) {
  EXPECT_DOUBLE_EQ(separate(circle(0, 0.7, 0.5), segment(0, 0, 0, 1)).gap,
                   separate(circle(0, -0.7, 0.5), segment(0, 0, 0, 1)).gap);
}

TEST(Distance, IsContinuousAroundACorner) {
  double last = separate(segment(0, 0, 0.3, 1, 0.1), circle(2, 1, 0.5)).gap;
  for (int i = 1; i < 1000; ++i) {
    const double a = 0.002 * i;
    const double gap = separate(segment(0, 0, 0.3, 1, 0.1), circle(2 * std::cos(a), 1 + 2 * std::sin(a), 0.5)).gap;
    EXPECT_LE(std::abs(gap - last), 0.002 * 2 + 1e-12);  // no faster than the circle moves
    last = gap;
  }
}

TEST(Distance, SwapsWithItsArguments) {
  const Separation ab = separate(segment(0.1, 0.2, 0.4, 1, 0.1), circle(1.3, 0.9, 0.3));
  const Separation ba = separate(circle(1.3, 0.9, 0.3), segment(0.1, 0.2, 0.4, 1, 0.1));
  EXPECT_NEAR(ab.gap, ba.gap, 1e-15);
  EXPECT_NEAR((ab.normal + ba.normal).norm(), 0, 1e-15);
}

/// Chain of hinge, slide and hinge, touching a body on a hinge of its own.
Model tangled(bool felt, FeltAxis axis) {
  Model model;
  model.body_count = 4;
  for (int i = 0; i < 4; ++i) {
    model.bodies[i].mass = 0.1;
    model.bodies[i].centre = {0.02 * i, 0.03};
    model.bodies[i].inertia = 1e-3;
    model.bodies[i].origin = {0.1, 0.02 * i};
    model.bodies[i].initial = 0.1 + 0.05 * i;
  }
  model.bodies[1].parent = 0;
  model.bodies[1].joint = JointKind::prismatic;
  model.bodies[1].direction = 0.6;
  model.bodies[2].parent = 1;
  model.bodies[3].origin = {0.5, 0.3};
  Contact& contact = model.contacts[0];
  contact.body_a = 2;
  contact.body_b = 3;
  contact.shape_a = {ShapeKind::circle, {0.05, 0.04}, 0, 0, 0.02};
  contact.shape_b = {ShapeKind::segment, {-0.1, -0.05}, 0.4, 0.03, 0.004};
  contact.has_felt = felt;
  contact.felt = test::common_felt();
  contact.felt.axis = axis;
  contact.felt.direction = 0.8;
  model.contact_count = 1;
  return model;
}

TEST(ContactFrames, LeverArmsAreTheDerivativesOfTheGap) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-1, 1);
  const double e = 1e-6;
  for (const FeltAxis axis : {FeltAxis::contact_normal, FeltAxis::fixed}) {
    const Mechanism mechanism = build_mechanism(tangled(true, axis));
    for (int trial = 0; trial < 50; ++trial) {
      CoordinateVector x(5);
      for (int i = 0; i < 4; ++i) x[i] = angle(random);
      x[4] = 1e-4;
      const auto gap_at = [&](const CoordinateVector& at) {
        Frames frames;
        ContactFrames contacts;
        place_bodies(mechanism.model, at, frames);
        locate_contacts(mechanism, at, frames, contacts);
        return contacts[0].gap;
      };
      Workspace work;
      place_bodies(mechanism.model, x, work.frames);
      locate_contacts(mechanism, x, work.frames, work.contacts);
      set_directions(mechanism, work);
      CoordinateVector direction = CoordinateVector::Zero(5);
      direction_of(mechanism, work, mechanism.rows.row[0]).apply(1.0, direction);
      for (int i = 0; i < 5; ++i) {
        CoordinateVector plus = x, minus = x;
        plus[i] += e;
        minus[i] -= e;
        // central difference: e^2 times third derivatives of order 1e2 on a corner
        EXPECT_NEAR(direction[i], (gap_at(plus) - gap_at(minus)) / (2 * e), 1e-8) << "coordinate " << i;
      }
    }
  }
}

TEST(ContactFrames, FeltAlongTheNormalIsACompliantContact) {
  // the compression column of the thesis (4.22) is minus the normal row when felts are springs
  const Mechanism with = build_mechanism(tangled(true, FeltAxis::contact_normal));
  const Mechanism without = build_mechanism(tangled(false, FeltAxis::contact_normal));
  CoordinateVector x(5);
  x << 0.2, 0.1, -0.3, 0.5, 3e-4;
  Frames frames;
  ContactFrames a, b;
  place_bodies(with.model, x, frames);
  locate_contacts(with, x, frames, a);
  locate_contacts(without, x.head(4), frames, b);
  EXPECT_DOUBLE_EQ(a[0].gap, b[0].gap + 3e-4);
  EXPECT_EQ(a[0].felt_lever, 1);
}

TEST(ContactFrames, ScalingTheMechanismScalesTheGaps) {
  Model model = tangled(false, FeltAxis::contact_normal);
  const auto gap_of = [](const Model& m) {
    Frames frames;
    CoordinateVector x(4);
    for (int i = 0; i < 4; ++i) x[i] = m.bodies[i].initial;
    place_bodies(m, x, frames);
    return locate_contact(m.contacts[0], frames, 0).gap;
  };
  const double gap = gap_of(model);
  for (Body& body : model.bodies) body.origin *= 10;
  model.bodies[1].initial *= 10;
  for (Shape* shape : {&model.contacts[0].shape_a, &model.contacts[0].shape_b}) {
    shape->centre *= 10;
    shape->half_length *= 10;
    shape->radius *= 10;
  }
  EXPECT_NEAR(gap_of(model), 10 * gap, 1e-14);
}

}  // namespace
}  // namespace erard
