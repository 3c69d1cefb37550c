// What the real-time path promises: no heap, nothing read that was not written, bounded work, faults that leave the state.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "support/heap_calls.hpp"
#include "support/strokes.hpp"

namespace erard {
namespace {

/// A keystroke over and over again.
struct Repeated {
  const Keystroke* keystroke;
  double period;
  DriveSample at(double time) const noexcept {
    const Sample sample = keystroke->at(std::fmod(time, period));
    return {sample.value, sample.rate};
  }
};

const auto kIgnore = [](const State&, const StepReport&, double) noexcept {};

TEST(RealTime, HeapCounterCounts) {
  const long before = heap_calls;
  CoordinateVector::Zero(3).eval();
  EXPECT_EQ(heap_calls, before);
  Eigen::VectorXd::Zero(100).eval();  // Eigen's own heap calls are seen too
  EXPECT_GT(heap_calls, before);
}

TEST(RealTime, TenSecondsOfPlayMakeNoHeapCall) {
  const ActionFile action = test::grand_action();
  const Mechanism mechanism = build_mechanism(action.model);
  const Keystroke keystroke = test::keystroke("forte");
  const TickSettings settings = test::default_tick();
  const auto work = std::make_unique<Workspace>();
  State state = rest_state(mechanism, settings.scheme.time_step);
  EventDetector detector(mechanism, action.roles);
  const auto observe = [&](const State& s, const StepReport&, double force) noexcept { detector.observe(s, force); };
  const long before = heap_calls;
  for (int i = 0; i < 20000; ++i) tick(mechanism, settings, Repeated{&keystroke, 0.5}, state, *work, observe);
  EXPECT_EQ(heap_calls, before);
  EXPECT_GT(detector.count(), 60);  // it did play: 20 strokes
}

TEST(RealTime, PoisonedScratchChangesNoBit) {
  const ActionFile action = test::grand_action();
  const Mechanism mechanism = build_mechanism(action.model);
  const Keystroke keystroke = test::keystroke("forte");
  const TickSettings settings = test::default_tick();
  const auto play = [&](bool is_poisoned) {
    const auto work = std::make_unique<Workspace>();
    State state = rest_state(mechanism, settings.scheme.time_step);
    const KeystrokeInput input{&keystroke};
    for (int i = 0; i < 400; ++i) {
      // all bits set: NaN in every double, absurd sizes in every matrix
      if (is_poisoned) std::memset(static_cast<void*>(work.get()), 0xff, sizeof(Workspace));
      tick(mechanism, settings, input, state, *work, kIgnore);
    }
    return state;
  };
  const State clean = play(false), poisoned = play(true);
  EXPECT_EQ(clean.x, poisoned.x);
  EXPECT_EQ(clean.v, poisoned.v);
  EXPECT_EQ(clean.impulse, poisoned.impulse);
}

TEST(RealTime, InputThatIsNotFiniteLeavesTheStateAsItWas) {
  const Mechanism mechanism = build_mechanism(test::grand_action().model);
  TickSettings settings;
  settings.set_rate(2000, 4);
  const auto work = std::make_unique<Workspace>();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    State state = rest_state(mechanism, settings.scheme.time_step);
    const State before = state;
    Drive drive{DriveKind::piston, {0, 0}, {bad, 0}};
    EXPECT_EQ(step(mechanism, settings.scheme, drive, state, *work).status, StepStatus::not_finite);
    EXPECT_EQ(state.x, before.x);
    EXPECT_EQ(state.v, before.v);
    EXPECT_EQ(state.impulse, before.impulse);
    EXPECT_EQ(state.time, before.time);
    // and the next good input goes on from there
    drive.to = {0, 0};
    EXPECT_EQ(step(mechanism, settings.scheme, drive, state, *work).status, StepStatus::converged);
  }
}

TEST(RealTime, AbsurdInputStaysBoundedAndIsReported) {
  const Mechanism mechanism = build_mechanism(test::grand_action().model);
  TickSettings settings;
  settings.set_rate(2000, 4);
  const auto work = std::make_unique<Workspace>();
  State state = rest_state(mechanism, settings.scheme.time_step);
  Drive drive{DriveKind::piston, {0, 0}, {0.05, 100}};  // 5 cm in an eighth of a millisecond
  const StepReport report = step(mechanism, settings.scheme, drive, state, *work);
  EXPECT_LE(report.linearisations, settings.scheme.newton_limit);
  EXPECT_LE(report.sweeps, settings.scheme.newton_limit * settings.scheme.sweep_limit);
}

TEST(RealTime, AStepCutShortByItsLimitKeepsPositionAndVelocityOfOneIterate) {
  const Mechanism mechanism = build_mechanism(test::grand_action().model);
  const auto work = std::make_unique<Workspace>();
  Scheme scheme;
  scheme.newton_limit = 1;
  scheme.placement_tolerance = 0;  // the frames are never near enough
  State state = rest_state(mechanism, scheme.time_step);
  state.v.setConstant(0.3);
  const State before = state;
  const Drive drive{DriveKind::piston, {0, 0}, {1e-3, 1}};
  EXPECT_EQ(step(mechanism, scheme, drive, state, *work).status, StepStatus::not_converged);
  for (int i = 0; i < mechanism.coordinate_count; ++i) {
    const double way = scheme.time_step * ((1 - scheme.theta) * before.v[i] + scheme.theta * state.v[i]);
    EXPECT_NEAR(state.x[i], before.x[i] + way, 1e-15);  // rounding of a radian
  }
}

TEST(RealTime, OneActionFitsIn64KiB) { EXPECT_LE(sizeof(Mechanism) + sizeof(State) + sizeof(Workspace), 64 * 1024); }

TEST(RealTime, ScaledActionsPlayTheSame) {
  // lengths x s, times x sqrt(s), masses x s^3: the same motion in other units must not meet a hidden absolute constant
  const auto scaled = [](double s) {
    const double force = s * s * s;  // mass x acceleration, gravity held
    Model model = test::grand_action().model;
    for (int i = 0; i < model.body_count; ++i) {
      Body& body = model.bodies[static_cast<std::size_t>(i)];
      body.origin *= s;
      body.centre *= s;
      body.mass *= s * s * s;
      body.inertia *= std::pow(s, 5);
      body.viscous *= force * s * std::sqrt(s);
      body.dry *= force * s;
      body.spring.stiffness *= force * s;
    }
    for (int c = 0; c < model.contact_count; ++c) {
      Contact& contact = model.contacts[static_cast<std::size_t>(c)];
      for (Shape* shape : {&contact.shape_a, &contact.shape_b}) {
        shape->centre *= s;
        shape->half_length *= s;
        shape->radius *= s;
      }
      contact.felt.mass *= s * s * s;
      contact.felt.place *= s;
      contact.felt.stiffness *= force / std::pow(s, contact.felt.exponent);
      contact.felt.damping *= force / (s * s * s / std::sqrt(s));
    }
    model.finger.arm *= s;
    model.finger.stiffness *= force / s;
    model.finger.damping *= force / s * std::sqrt(s);
    return model;
  };
  const Keystroke keystroke = test::keystroke("forte");
  const auto force_at = [&](double s) {
    const Mechanism mechanism = build_mechanism(scaled(s));
    TickSettings settings;
    settings.set_rate(2000, 4);
    Scheme scheme = settings.scheme;
    scheme.time_step *= std::sqrt(s);
    State state = rest_state(mechanism, scheme.time_step);
    const auto work = std::make_unique<Workspace>();
    const auto sample = [&](double time) {
      const Sample at = keystroke.at(time / std::sqrt(s));
      return DriveSample{at.value * s, at.rate * std::sqrt(s)};
    };
    double force = 0;
    for (int i = 0; i < 600; ++i) {  // past the string impact
      const Drive drive{DriveKind::piston, sample(state.time), sample(state.time + scheme.time_step)};
      step(mechanism, scheme, drive, state, *work);
      force = piston_force(mechanism.model, state, drive.to) / (s * s * s);
    }
    return force;
  };
  const double nominal = force_at(1);
  EXPECT_NEAR(force_at(0.1), nominal, 1e-3 * nominal);  // iteration tolerances are reached at other roundings
  EXPECT_NEAR(force_at(10), nominal, 1e-3 * nominal);
}

}  // namespace
}  // namespace erard
