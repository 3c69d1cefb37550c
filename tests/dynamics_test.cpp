// Inertia of the tree against Appendix B and against energy.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "support/models.hpp"

namespace erard {
namespace {

constexpr double m1 = 0.3, l1 = 0.25, m2 = 0.2, l2 = 0.4;

struct Assembled {
  CoordinateMatrix M, N;
  CoordinateVector bias;
};

Assembled assemble(const Model& model, const CoordinateVector& x, const CoordinateVector& v) {
  const Mechanism mechanism = build_mechanism(model);
  Frames frames;
  ContactFrames contacts;
  Assembled result;
  place_bodies(model, x, frames);
  locate_contacts(mechanism, x, frames, contacts);
  assemble_mass_matrix(mechanism, frames, contacts, result.M);
  result.bias.resize(mechanism.coordinate_count);
  assemble_bias(mechanism, frames, contacts, v, model.gravity, result.bias);
  result.N = gyroscopic_matrix(mechanism, frames, contacts, v);
  return result;
}

TEST(Dynamics, DoublePendulumHasTheMatricesOfAppendixB) {
  const Model model = test::double_pendulum(m1, l1, m2, l2);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-3, 3);
  for (int trial = 0; trial < 100; ++trial) {
    const double t1 = any(random), t2 = any(random), w1 = any(random), w2 = any(random);
    CoordinateVector x(2), v(2);
    x << t1, t2 - t1;
    v << w1, w2 - w1;
    const Assembled ours = assemble(model, x, v);
    // thesis (B.6), (B.9) in absolute angles; theta_abs = T x
    Eigen::Matrix2d T, M, N;
    T << 1, 0, 1, 1;
    M << l1 * l1 * (m1 + m2), l1 * l2 * m2 * std::cos(t1 - t2), l1 * l2 * m2 * std::cos(t1 - t2), l2 * l2 * m2;
    N << 0, w2, -w1, 0;
    N *= m2 * l1 * l2 * std::sin(t1 - t2);
    EXPECT_LT((ours.M - T.transpose() * M * T).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((ours.N - T.transpose() * N * T).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Dynamics, BiasIsGyroscopicMatrixTimesRatesMinusWeight) {
  const Model model = test::double_pendulum(m1, l1, m2, l2);
  CoordinateVector x(2), v(2);
  x << 0.4, -0.9;
  v << 2.0, -3.0;
  const Assembled ours = assemble(model, x, v);
  CoordinateVector weight(2);  // moments of the weight about the two joints, by hand
  const double arm2 = l2 * std::sin(x[0] + x[1]), arm1 = l1 * std::sin(x[0]);
  weight << -9.81 * (m1 * arm1 + m2 * (arm1 + arm2)), -9.81 * m2 * arm2;
  EXPECT_LT((ours.bias - (ours.N * v - weight)).cwiseAbs().maxCoeff(), 1e-12);
}

/// Hinge, slide with felt, hinge: every kind of joint below every other.
Model mixed_tree() {
  Model model = test::double_pendulum(m1, l1, m2, l2);
  model.body_count = 4;
  model.bodies[2] = test::pendulum_body(0.1, 0.1);
  model.bodies[2].joint = JointKind::prismatic;
  model.bodies[2].parent = 1;
  model.bodies[2].direction = 0.7;
  model.bodies[2].origin = {0.05, -0.1};
  model.bodies[3] = test::pendulum_body(0.05, 0.2);
  model.bodies[3].parent = 2;
  model.bodies[3].origin = {0.03, 0.02};
  return model;
}

TEST(Dynamics, MassMatrixIsTheHessianOfTheKineticEnergy) {
  // kinetic energy of the point masses by finite differences of their positions
  const Model model = mixed_tree();
  CoordinateVector x(4), v(4);
  x << 0.3, 0.5, 0.02, -0.8;
  v << 1.0, -2.0, 0.5, 3.0;
  const auto positions = [&](double t) {
    Frames frames;
    place_bodies(model, x + t * v, frames);
    std::array<Vector2, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = frames.body[i].placed(model.bodies[i].centre);
    return p;
  };
  const double e = 1e-6;
  double energy = 0;
  for (int i = 0; i < 4; ++i)
    energy += 0.5 * model.bodies[i].mass * ((positions(e)[i] - positions(-e)[i]) / (2 * e)).squaredNorm();
  const Assembled ours = assemble(model, x, v);
  EXPECT_NEAR(0.5 * v.dot(ours.M * v), energy, 1e-9 * energy);  // e^2 times third derivatives
}

TEST(Dynamics, GyroscopicTermsDoNoWork) {
  // dT/dt = v.(M' v / 2 - N v) must vanish: M' v by finite differences along v
  const Model model = mixed_tree();
  CoordinateVector x(4), v(4);
  x << 0.3, 0.5, 0.02, -0.8;
  v << 1.0, -2.0, 0.5, 3.0;
  const double e = 1e-6;
  const CoordinateMatrix rate = (assemble(model, x + e * v, v).M - assemble(model, x - e * v, v).M) / (2 * e);
  const Assembled ours = assemble(model, x, v);
  EXPECT_NEAR(v.dot(0.5 * (rate * v) - ours.N * v), 0, 1e-8);
}

TEST(Dynamics, FeltMassTakenFromItsCarrierLeavesTheInertiaOfTheWhole) {
  Model model = test::pendulum(0.3, 0.2, 0.4);
  const CoordinateVector x1 = CoordinateVector::Constant(1, 0.4), v1 = CoordinateVector::Constant(1, 1.0);
  const double whole = assemble(model, x1, v1).M(0, 0);
  const Vector2 place(0.1, -0.05);
  Contact& contact = model.contacts[0];
  contact.body_a = 0;
  contact.shape_a = {ShapeKind::circle, place, 0, 0, 1e-9};
  contact.shape_b = {ShapeKind::circle, {0, -10}, 0, 0, 0.01};
  contact.has_felt = true;
  contact.felt = test::common_felt();
  contact.felt.place = place;
  model.contact_count = 1;
  Body& body = model.bodies[0];
  const double m = contact.felt.mass;
  body.centre = (body.mass * body.centre - m * place) / (body.mass - m);
  body.mass -= m;
  body.inertia -= m * place.squaredNorm();
  CoordinateVector x2(2), v2(2);
  x2 << 0.4, 0;
  v2 << 1, 0;
  EXPECT_NEAR(assemble(model, x2, v2).M(0, 0), whole, 1e-13);
}

TEST(BranchFactor, CouplingsOfFeltsWithoutMassFillOnlyWhatTheyMust) {
  // two pendulums of two rods; one felt couples the tip of the first to the upper rod of the second
  Model model;
  model.body_count = 4;
  for (int i : {0, 1, 2, 3}) model.bodies[i] = test::pendulum_body(1, 1);
  model.bodies[1].parent = 0;
  model.bodies[3].parent = 2;
  Contact& contact = model.contacts[0];
  contact.body_a = 1;
  contact.body_b = 2;
  contact.has_felt = true;
  contact.felt = test::common_felt();
  contact.felt.mass = 0;
  const auto ancestors = [&](int i) {
    const AncestorTable table = build_mechanism(model).elimination;
    return std::vector<int>(table.list[i].begin(), table.list[i].begin() + table.count[i]);
  };
  EXPECT_EQ(ancestors(3), std::vector<int>({2}));
  EXPECT_EQ(ancestors(2), std::vector<int>({}));  // out of play: two trees
  model.contact_count = 1;
  EXPECT_EQ(ancestors(3), std::vector<int>({2, 1, 0}));  // row 3 reaches 2 alone, the rest of the list stays zero
  EXPECT_EQ(ancestors(2), std::vector<int>({1, 0}));
  EXPECT_EQ(ancestors(1), std::vector<int>({0}));
}

TEST(BranchFactor, SolvesLikeADenseCholesky) {
  const Model model = mixed_tree();
  const Mechanism mechanism = build_mechanism(model);
  CoordinateVector x(4);
  x << 0.3, 0.5, 0.02, -0.8;
  const CoordinateMatrix M = assemble(model, x, x).M;
  CoordinateMatrix factor = M;
  CoordinateVector b(4);
  b << 1, -2, 3, 0.5;
  CoordinateVector ours = b;
  factorise_branches(mechanism.elimination, factor);
  solve_upwards(mechanism.elimination, factor, 3, ours.data());
  solve_downwards(mechanism.elimination, factor, ours.data());
  EXPECT_LT((ours - M.ldlt().solve(b)).norm(), 1e-12 * ours.norm());
}

double energy_drift(double h, double duration) {
  Model model = test::double_pendulum(m1, l1, m2, l2);
  model.bodies[0].initial = 1.0;
  model.bodies[1].initial = 0.7;
  const Mechanism mechanism = build_mechanism(model);
  Scheme scheme = test::default_scheme();
  scheme.time_step = h;
  scheme.newton_tolerance = 1e-12;
  scheme.placement_tolerance = 1e-12;
  State state = rest_state(mechanism, h);
  const double start = measure_energy(mechanism, state).total();
  test::run_free(mechanism, scheme, duration, state);
  return std::abs(measure_energy(mechanism, state).total() - start);
}

TEST(Dynamics, FreeDoublePendulumKeepsItsEnergy) {
  // swings about 1 J up and down; at the default step the middle scheme loses 4e-8 J in a second
  EXPECT_LT(energy_drift(1.25e-4, 1.0), 1e-7);
}

TEST(Dynamics, EnergyDriftFallsWithTheSquareOfTheStep) {
  EXPECT_NEAR(std::log2(energy_drift(1e-3, 1.0) / energy_drift(5e-4, 1.0)), 2, 0.1);
}

TEST(Dynamics, PositionConvergesWithTheSquareOfTheStep) {
  const auto end_angle = [](double h) {
    Model model = test::double_pendulum(m1, l1, m2, l2);
    model.bodies[0].initial = 1.0;
    model.bodies[1].initial = 0.7;
    const Mechanism mechanism = build_mechanism(model);
    Scheme scheme;
    scheme.time_step = h;
    scheme.newton_tolerance = 1e-12;
    scheme.placement_tolerance = 1e-12;
    State state = rest_state(mechanism, h);
    test::run_free(mechanism, scheme, 1.0, state);
    return state.x[0];
  };
  const double fine = end_angle(1.25e-4);
  EXPECT_NEAR(std::log2((end_angle(2e-3) - fine) / (end_angle(1e-3) - fine)), 2, 0.1);
}

}  // namespace
}  // namespace erard
