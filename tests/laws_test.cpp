// Friction that holds, contacts that close, energy that never grows: the non-smooth laws on small mechanisms.
#include <gtest/gtest.h>

#include "erard/device/action_file.hpp"
#include "support/models.hpp"

namespace erard {
namespace {

Scheme scheme_of(double h, double theta) {
  Scheme scheme;
  scheme.time_step = h;
  scheme.theta = theta;
  return scheme;
}

TEST(Friction, HammerHeldByItsHingeDoesNotCreepInAMinute) {
  // thesis values of the hammer: m g l sin(angle) = 0.0133 N m sin(0.05) < c_d = 1.01e-3 N m
  Model model = test::pendulum(0.0125233504, 0.1083, 0.05);
  model.bodies[0].dry = 1.01143156e-3;
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 5e-4);
  double fastest = 0;
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 60, state,
                 [&](const StepReport&, const State& s) { fastest = std::max(fastest, std::abs(s.v[0])); });
  EXPECT_LT(fastest, 1e-12);
  EXPECT_NEAR(state.x[0], 0.05, 1e-12);
}

TEST(Friction, HammerBeyondItsBandFalls) {
  Model model = test::pendulum(0.0125233504, 0.1083, 0.08);  // 0.0133 sin(0.08) > c_d
  model.bodies[0].dry = 1.01143156e-3;
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 5e-4);
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 0.1, state);
  EXPECT_LT(state.x[0], 0.0799);
}

TEST(Friction, SwingingPendulumStopsAndStaysStopped) {
  // Upsilon = 2 of thesis 5.1.2: theta'' + Y^2 sign theta' + 4 pi^2 sin theta = 0; exact sticking angle 0.068466085
  const double w2 = 4 * M_PI * M_PI;
  Model model = test::pendulum(1, 1, 1.0);
  model.gravity = {0, -w2};
  model.bodies[0].dry = 4;
  const Mechanism mechanism = build_mechanism(model);
  Scheme scheme = scheme_of(1e-3, 0.5);
  State state = rest_state(mechanism, 1e-3);
  test::run_free(mechanism, scheme, 3, state);
  // the last swing ends within one step of its turning point: error of the order h v, v < Y^2 h
  EXPECT_NEAR(state.x[0], 0.068466085, 2e-5);
  const double stuck = state.x[0];
  double fastest = 0;
  test::run_free(mechanism, scheme, 60, state,
                 [&](const StepReport&, const State& s) { fastest = std::max(fastest, std::abs(s.v[0])); });
  EXPECT_LE(fastest, 1e-15);
  EXPECT_EQ(state.x[0], stuck);
}

TEST(Friction, BlockJustBelowItsFrictionAngleStays) {
  for (const double theta : {0.5, 1.0}) {
    const Model model = test::block_on_slope(0.2, std::atan(0.3) - 1e-4, 0.3);
    const Mechanism mechanism = build_mechanism(model);
    State state = rest_state(mechanism, 5e-4);
    double fastest = 0;
    test::run_free(mechanism, scheme_of(5e-4, theta), 60, state, [&](const StepReport&, const State& s) {
      if (s.time > 0.01) fastest = std::max(fastest, s.v.cwiseAbs().maxCoeff());
    });
    EXPECT_LT(fastest, 1e-12) << "theta " << theta;
    EXPECT_NEAR(state.x[0], 0, 1e-9) << "theta " << theta;  // rounding of the start position, nothing else
  }
}

TEST(Friction, BlockAboveItsFrictionAngleSlidesAsCoulombSays) {
  const double slope = 0.5, mu = 0.3;
  const Model model = test::block_on_slope(0.2, slope, mu);
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 5e-4);
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 0.5, state);
  const double travelled = 0.5 * 9.81 * (std::sin(slope) - mu * std::cos(slope)) * 0.25;
  // one step at the start may go either way: h v_end
  EXPECT_NEAR(state.x[0] / std::cos(slope), travelled, 5e-4 * 1.1);
}

TEST(RigidContact, RestingBlockNeitherSinksNorHops) {
  for (const double theta : {0.5, 0.7, 1.0}) {
    const Mechanism mechanism = build_mechanism(test::block_on_slope(0.2, 0, 0));
    State state = rest_state(mechanism, 5e-4);
    double deepest = 0, highest = 0;
    test::run_free(mechanism, scheme_of(5e-4, theta), 60, state, [&](const StepReport&, const State& s) {
      deepest = std::min(deepest, s.x[1] - 0.01);
      highest = std::max(highest, s.x[1] - 0.01);
    });
    EXPECT_GT(deepest, -1e-12) << "theta " << theta;
    EXPECT_LT(highest, 1e-9) << "theta " << theta;
  }
}

TEST(RigidContact, FallingBallStopsWithoutPenetration) {
  const Mechanism mechanism = build_mechanism(test::falling_ball(0.2, 0.1, 0));
  State state = rest_state(mechanism, 5e-4);
  double deepest = 0;
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 0.5, state,
                 [&](const StepReport&, const State& s) { deepest = std::min(deepest, s.x[1] - 0.01); });
  EXPECT_GT(deepest, -1e-12);
  EXPECT_NEAR(state.x[1], 0.01, 1e-9);
  EXPECT_EQ(state.v[1], 0);
}

TEST(RigidContact, RestitutionReturnsItsShareOfTheSpeed) {
  const double height = 0.1, e = 0.6, h = 1e-4;
  const Mechanism mechanism = build_mechanism(test::falling_ball(0.2, height, e));
  State state = rest_state(mechanism, h);
  double highest_after = 0;
  bool has_hit = false;
  test::run_free(mechanism, scheme_of(h, 0.5), 0.28, state, [&](const StepReport&, const State& s) {
    has_hit = has_hit || s.v[1] > 0;
    if (has_hit) highest_after = std::max(highest_after, s.x[1] - 0.01);
  });
  EXPECT_TRUE(has_hit);
  EXPECT_NEAR(highest_after, e * e * height, 2 * h * std::sqrt(2 * 9.81 * height));  // the impact is known to one step
}

TEST(RigidContact, BouncesDieOut) {
  const Mechanism mechanism = build_mechanism(test::falling_ball(0.2, 0.05, 0.7));
  State state = rest_state(mechanism, 5e-4);
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 3, state);
  EXPECT_LT(std::abs(state.v[1]), 2 * 9.81 * 5e-4);  // what one step of gravity gives
  EXPECT_LT(state.x[1] - 0.01, 1e-5);
}

/// A lever that can fall on a rigid stop at the height of its hinge: its tangent there cannot move.
Model lever_on_stop(double friction) {
  Model model = test::pendulum(0.1, 0.2, 1.8);
  Contact& contact = model.contacts[0];
  contact.body_a = 0;
  contact.shape_a = {ShapeKind::circle, {0.01, -0.2}, 0, 0, 0.01};  // touches the height of the hinge when level
  contact.shape_b = {ShapeKind::segment, {0.2, 0}, 0, 0.1, 0};
  contact.friction = friction;
  model.contact_count = 1;
  return model;
}

TEST(RigidContact, LeverFallsOnAStopAtTheHeightOfItsHinge) {
  const Mechanism mechanism = build_mechanism(lever_on_stop(0.3));
  State state = rest_state(mechanism, 5e-4);
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 2, state,
                 [](const StepReport& report, const State&) { ASSERT_NE(report.status, StepStatus::not_finite); });
  EXPECT_NEAR(state.x[0], std::acos(0.0), 1e-5);  // level
}

TEST(RigidContact, SlidingOverAHillKeepsItsForceFromStepToStep) {
  // a block slides at 0.5 m/s over the top of a circle of 0.5 m: N = m (g cos(phi) - v^2 / R), no step without it
  const double mass = 0.2, radius = 0.5;
  Model model = test::block_on_slope(mass, 0, 0);
  model.contacts[0].shape_b = {ShapeKind::circle, {0, -radius}, 0, 0, radius};
  model.bodies[1].initial = 0.01;
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 1.25e-4);
  state.v[0] = 0.5;
  double least = 1e9, most = 0;
  test::run_free(mechanism, test::default_scheme(), 0.1, state, [&](const StepReport&, const State& s) {
    if (s.time < 5e-3) return;  // the first contact
    const double force = s.impulse[mechanism.normal_row[0]] / 1.25e-4;
    least = std::min(least, force);
    most = std::max(most, force);
  });
  const double end = std::atan2(state.x[0], state.x[1] + radius);
  const double speed = 0.25 + 2 * 9.81 * (radius + 0.01) * (1 - std::cos(end));  // squared, energy
  EXPECT_NEAR(most, mass * (9.81 - 0.25 / (radius + 0.01)), 0.02 * mass * 9.81);
  EXPECT_NEAR(least, mass * (9.81 * std::cos(end) - speed / (radius + 0.01)), 0.02 * mass * 9.81);
}

TEST(RigidContact, PushingOneOverlapOutMakesNoOther) {
  // without its felts the action starts with the overlaps that they had in common; none of them may grow
  ActionOptions options;
  options.felts = FeltModel::rigid;
  const Mechanism mechanism = build_mechanism(load_action(ERARD_CONFIG_DIR "/grand_action.yaml", options).model);
  State state = rest_state(mechanism, 1.25e-4);
  const auto deepest = [&] {
    Frames frames;
    place_bodies(mechanism.model, state.x, frames);
    double depth = 0;
    for (int c = 0; c < mechanism.contact_count(); ++c)
      if (mechanism.model.contacts[c].is_active)
        depth = std::max(depth, -locate_contact(mechanism.model.contacts[c], frames, 0).gap);
    return depth;
  };
  Workspace work;
  double before = deepest();
  EXPECT_GT(before, 1e-4);
  for (int i = 0; i < 8; ++i) {
    step(mechanism, test::default_scheme(), {}, state, work);
    EXPECT_LT(deepest(), 0.6 * before) << "step " << i;
    before = deepest();
  }
}

TEST(RigidContact, OverlapThatNothingCanUndoLeavesTheStateFinite) {
  Model model = lever_on_stop(0.3);
  model.bodies[0].is_held = true;
  model.bodies[0].initial = 1.5;  // through the stop
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 5e-4);
  test::run_free(mechanism, scheme_of(5e-4, 0.5), 0.1, state);
  EXPECT_EQ(state.x[0], 1.5);
}

TEST(Drives, WithoutFingerADriveIsRefused) {
  const Mechanism mechanism = build_mechanism(lever_on_stop(0));
  for (const DriveKind kind : {DriveKind::force, DriveKind::piston, DriveKind::key}) {
    State state = rest_state(mechanism, 5e-4);
    Workspace work;
    EXPECT_EQ(step(mechanism, scheme_of(5e-4, 0.5), Drive{kind, {1, 0}, {1, 0}}, state, work).status,
              StepStatus::not_finite);
    EXPECT_EQ(state.time, 0);
  }
}

TEST(FeltContact, BallOnFeltFindsItsStaticCompression) {
  const double mass = 0.2;
  const Mechanism mechanism = build_mechanism(test::ball_on_felt(mass, 0));
  State state = rest_state(mechanism, 1.25e-4);
  test::run_free(mechanism, test::default_scheme(), 5, state);
  const double expected = std::pow((mass)*9.81 / 1.6e10, 1 / 2.7);  // k d^r = m g
  EXPECT_NEAR(state.x[2], expected, 1e-4 * expected);
}

/// Ball on a felt without mass: its compression is no coordinate.
Model ball_on_massless_felt(double mass, double height) {
  Model model = test::ball_on_felt(mass, height);
  model.contacts[0].felt.mass = 0;
  return model;
}

TEST(MasslessFelt, CarriesABallAtItsStaticCompression) {
  const double mass = 0.2;
  const Mechanism mechanism = build_mechanism(ball_on_massless_felt(mass, 0));
  State state = rest_state(mechanism, 1.25e-4);
  test::run_free(mechanism, test::default_scheme(), 5, state);
  const double expected = std::pow(mass * 9.81 / 1.6e10, 1 / 2.7);  // k d^r = m g
  EXPECT_NEAR(state.compression[0], expected, 1e-6 * expected);
  EXPECT_NEAR(state.impulse[mechanism.normal_row[0]], mass * 9.81 * 1.25e-4, 1e-9);
}

TEST(MasslessFelt, WithoutLossesGivesTheEnergyBackWhateverTheStep) {
  // elastic energy is an exact difference of the path law: what a bounce loses is the step in which it opens
  for (const double h : {2.5e-4, 1e-5}) {
    Model model = ball_on_massless_felt(0.06, 0.05);
    model.contacts[0].felt.damping = 0;
    const Mechanism mechanism = build_mechanism(model);
    Scheme scheme = scheme_of(h, 0.5);
    scheme.newton_tolerance = 1e-9;
    State state = rest_state(mechanism, h);
    const double start = measure_energy(mechanism, state).total();
    double most = 0, least = 1;
    test::run_free(mechanism, scheme, 0.5, state, [&](const StepReport&, const State& s) {
      const double gained = measure_energy(mechanism, s).total() - start;
      most = std::max(most, gained);
      least = std::min(least, gained);
    });
    EXPECT_LT(most, 1e-9);  // Newton's tolerance, of 0.03 J
    EXPECT_GT(least, -1e-9);
  }
}

TEST(MasslessFelt, DampedHitLosesWhatTheLawTakes) {
  const double mass = 0.0126, speed = 1.5;
  const double expected = test::rebound_speed(mass, speed);
  const Mechanism mechanism = build_mechanism(ball_on_massless_felt(mass, 0));
  State state = rest_state(mechanism, 1e-5);
  state.v[1] = -speed;
  double up = 0;
  test::run_free(mechanism, scheme_of(1e-5, 0.5), 0.01, state,
                 [&](const StepReport&, const State& s) { up = std::max(up, s.v[1]); });
  EXPECT_NEAR(up, expected, 2e-4 * expected);  // second order: 100 steps in the contact
}

TEST(MasslessFelt, IsWhatLighterAndLighterFeltsTendTo) {
  const auto height_after = [](double felt_mass) {
    Model model = test::ball_on_felt(0.06, 0.02);
    model.contacts[0].felt.mass = felt_mass;
    const Mechanism mechanism = build_mechanism(model);
    State state = rest_state(mechanism, 1e-5);
    test::run_free(mechanism, scheme_of(1e-5, 0.5), 0.1, state);
    return state.x[1];
  };
  const double limit = height_after(0);
  const double heavy = std::abs(height_after(4e-5) - limit), light = std::abs(height_after(1e-5) - limit);
  EXPECT_LT(light, heavy / 3);
  EXPECT_LT(light, 1e-5);  // 10 mg of 60 g, in a bounce of 2 cm
}

TEST(MasslessFelt, LeftAloneRecoversByItsLaw) {
  // k d^r + b d^2 d' = 0 integrated with steps of 1e-9 s
  const Mechanism mechanism = build_mechanism(ball_on_massless_felt(0.2, 1.0));
  State state = rest_state(mechanism, 1e-4);
  state.compression[0] = 3e-4;
  double d = 3e-4;
  Workspace work;
  for (int i = 0; i < 5; ++i) {
    step(mechanism, scheme_of(1e-4, 0.5), {}, state, work);
    for (int j = 0; j < 100000; ++j) d -= 1e-9 * 1.6e10 / 5e7 * std::pow(d, 0.7);
    EXPECT_NEAR(state.compression[0], d, 1e-4 * 3e-4) << i;
  }
  EXPECT_LT(d, 2e-4);  // it did recover
  test::run_free(mechanism, scheme_of(1e-4, 0.5), 0.1, state);
  EXPECT_EQ(state.compression[0], 0);
}

TEST(MasslessFelt, PressedAgainBeforeItRecoveredIsMetLower) {
  // a ball comes down at 5 m/s on a felt that was left compressed and recovers meanwhile
  const auto first_touch = [](double compression) {
    const Mechanism mechanism = build_mechanism(ball_on_massless_felt(0.2, 1e-3));
    State state = rest_state(mechanism, 1e-5);
    state.compression[0] = compression;
    state.v[1] = -5;
    Workspace work;
    while (state.impulse[mechanism.normal_row[0]] == 0) step(mechanism, scheme_of(1e-5, 0.5), {}, state, work);
    return 0.01 - state.x[1];
  };
  const double step_of_ball = 5 * 1e-5;
  double d = 5e-4, position = 1e-3;
  for (; position > -d; position -= 5e-9) d -= 1e-9 * 1.6e10 / 5e7 * std::pow(d, 0.7);
  EXPECT_GT(d, 2e-4);
  EXPECT_GT(first_touch(5e-4), d);
  EXPECT_LT(first_touch(5e-4), d + step_of_ball);
  EXPECT_LT(first_touch(0), step_of_ball);
}

TEST(FeltContact, HitWithoutLossesGivesTheSpeedBack) {
  Model model = test::ball_on_felt(0.06, 0.05);
  model.contacts[0].felt.damping = 0;
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 1e-5);
  Scheme scheme = scheme_of(1e-5, 0.5);
  double up = 0;
  test::run_free(mechanism, scheme, 0.13, state, [&](const StepReport&, const State& s) { up = std::max(up, s.v[1]); });
  // lost: the felt's own mass (1.5e-5 of 0.06 kg) at closing and opening
  EXPECT_NEAR(up, std::sqrt(2 * 9.81 * 0.05), 1e-3);
}

TEST(FeltContact, DampedHitLosesWhatTheLawTakes) {
  const double mass = 0.0126;
  const double v = test::rebound_speed(mass, 1.5);
  Model model = test::ball_on_felt(mass, 0);
  model.contacts[0].felt.mass = 1e-6;
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 1e-5);
  state.v[1] = -1.5;
  double up = 0;
  test::run_free(mechanism, scheme_of(1e-5, 0.5), 0.01, state,
                 [&](const StepReport&, const State& s) { up = std::max(up, s.v[1]); });
  EXPECT_NEAR(up, v, 2e-3 * v);
}

TEST(FeltContact, KeepsItsHistory) {
  // pressed and left alone, a felt recovers no faster than its law lets it: d' = -(k / b) d^(r - 2)
  Model model = test::ball_on_felt(0.2, 1.0);
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 1.25e-5);
  state.x[2] = 3e-4;  // compressed, nothing touches it
  double d = 3e-4;
  const double h = 1.25e-5;
  Workspace work;
  for (int i = 0; i < 20; ++i) {
    step(mechanism, scheme_of(h, 0.5), {}, state, work);
    for (int j = 0; j < 100; ++j) d -= 0.01 * h * 1.6e10 / 5e7 * std::pow(d, 0.7);
  }
  EXPECT_GT(state.x[2], 0.2 * 3e-4);
  EXPECT_NEAR(state.x[2], d, 0.05 * 3e-4);  // the law without mass; 15 mg and the step of 12.5 us delay it
}

TEST(FeltContact, FreeFeltComesToItsStopAndStays) {
  const Mechanism mechanism = build_mechanism(test::ball_on_felt(0.2, 1.0));
  State state = rest_state(mechanism, 1.25e-4);
  state.x[2] = 3e-4;
  double lowest = 1;
  test::run_free(mechanism, test::default_scheme(), 0.3, state,
                 [&](const StepReport&, const State& s) { lowest = std::min(lowest, s.x[2]); });
  EXPECT_GE(lowest, -1e-15);
  EXPECT_LT(state.x[2], 1e-5);
}

TEST(Energy, OfARotorWithAnOpenFeltIsKept) {
  // the felt looks at a circle beside the rotor and sees its nearest point run along: its mass must not run with it
  Model model = test::pendulum(0.1, 0.05, 0);
  model.gravity = {0, 0};
  Contact& contact = model.contacts[0];
  contact.body_a = 0;
  contact.shape_a = {ShapeKind::circle, {0, 0}, 0, 0, 0.2};
  contact.shape_b = {ShapeKind::circle, {0.5, 0}, 0, 0, 0.05};
  contact.has_felt = true;
  contact.felt = test::common_felt();
  contact.felt.place = {0.2, 0};
  model.contact_count = 1;
  const Mechanism mechanism = build_mechanism(model);
  State state = rest_state(mechanism, 1.25e-4);
  state.v[0] = 20;
  const double start = measure_energy(mechanism, state).total();
  double most = 0;
  test::run_free(mechanism, test::default_scheme(), 1, state, [&](const StepReport&, const State& s) {
    most = std::max(most, measure_energy(mechanism, s).total() - start);
  });
  EXPECT_LT(most, 1e-9);
}

TEST(Energy, NeverGrowsInABouncingBallOnFelt) {
  const Mechanism mechanism = build_mechanism(test::ball_on_felt(0.06, 0.05));
  for (const double h : {5e-4, 1.25e-4}) {
    State state = rest_state(mechanism, h);
    const double start = measure_energy(mechanism, state).total();
    double most = -1;
    test::run_free(mechanism, scheme_of(h, 0.5), 2, state, [&](const StepReport&, const State& s) {
      most = std::max(most, measure_energy(mechanism, s).total() - start);
    });
    EXPECT_LE(most, 1e-12);
  }
}

TEST(Scheme, ImplicitEulerDampsTheFrontRailWhereTheMiddleDoesNot) {
  // a 62 g mass on a linear spring of 100 Hz, one period at 2 kHz: theta 1 leaves (1 + (w h)^2)^(-20/2)
  const double w = 2 * M_PI * 100, h = 5e-4;
  Model model;
  model.gravity = {0, 0};
  model.body_count = 1;
  model.bodies[0].joint = JointKind::prismatic;
  model.bodies[0].mass = 0.062;
  model.bodies[0].spring.stiffness = 0.062 * w * w;
  model.bodies[0].initial = 1e-3;
  const Mechanism mechanism = build_mechanism(model);
  const auto amplitude = [&](double theta) {
    State state = rest_state(mechanism, h);
    test::run_free(mechanism, scheme_of(h, theta), 0.01, state);
    return std::hypot(state.x[0], state.v[0] / w) / 1e-3;
  };
  EXPECT_NEAR(amplitude(1.0), std::pow(1 + w * w * h * h, -10), 1e-9);  // 39 %
  EXPECT_NEAR(amplitude(0.5), 1, 1e-9);
}

}  // namespace
}  // namespace erard
