// The pendulum with dry friction of thesis 5.1 and 5.2: exact solution, regularised and projected schemes, engine.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "study/pendulum.hpp"

namespace erard::study {
namespace {

constexpr EngineScheme kEngineEuler{1};
constexpr EngineScheme kEngineMiddle{0.5};

double mean_error(const PendulumScheme& scheme, const PendulumCase& c) {
  return mean_error(scheme, c, ExactPendulum(c.upsilon, c.start));
}

// ---- the exact solution

TEST(Pendulum, SticksAtTheExactAngle) {
  // independent implementation: angles to the nine, times to the four digits it gives
  const ExactPendulum two(2, {1, 0}), five(5, {1, 0});
  EXPECT_NEAR(two.stick_angle(), 0.068466085, 5e-10);
  EXPECT_NEAR(two.stick_time(), 2.5551, 5e-5);
  EXPECT_NEAR(five.stick_angle(), 0.396722023, 5e-10);
  EXPECT_NEAR(five.stick_time(), 0.5754, 5e-5);
}

TEST(Pendulum, EnergyAndIntegrationAgreeOnEveryHalfSwing) {
  for (const auto& [upsilon, start] : std::vector<std::pair<double, PendulumState>>{
           {1.26, {1, 0}}, {2, {1, 0}}, {5, {1, 0}}, {5, {1, -10}}, {5, {-1, 3}}, {6.5, {0.2, 4}}}) {
    const ExactPendulum exact(upsilon, start);
    ASSERT_FALSE(exact.swings().empty());
    for (const HalfSwing& swing : exact.swings()) {
      // Runge-Kutta on 2000 parts: (2 pi / T)^4 (0.6 T / 2000)^4 of a rate of 6; a turning angle feels its square
      EXPECT_NEAR(swing.rate.back(), 0, 8e-11) << upsilon;
      EXPECT_NEAR(swing.angle.back(), swing.to, 1e-13) << upsilon;  // rounding of 2000 sums
    }
  }
}

TEST(Pendulum, SmallSwingsLoseTwiceTheFrictionAngleEachHalfPeriod) {
  // linear pendulum: amplitude a -> a - 2 Y^2 / (4 pi^2) in half a period. Here 10.5 - 5 x 2 = 0.5 mrad is in the band.
  const double friction_angle = 1e-3, amplitude = 10.5e-3;
  const ExactPendulum exact(2 * M_PI * std::sqrt(friction_angle), {amplitude, 0});
  EXPECT_EQ(exact.swings().size(), 5u);
  // sin is not its argument: angles of a cubed / 6, times of a squared / 16, over 2.5 T
  EXPECT_NEAR(exact.stick_angle(), -0.5e-3, 1e-6);
  EXPECT_NEAR(exact.stick_time(), 2.5, 2.5 * amplitude * amplitude / 16);
}

TEST(Pendulum, ThrownAtTenItTurnsAtMinusOneRadian) {
  // Figure 5.7: 10^2 / 2 = 25 x 2, friction takes all of it between two points of equal height
  const ExactPendulum exact(5, {1, -10});
  ASSERT_EQ(exact.swings().size(), 2u);
  EXPECT_NEAR(exact.swings()[0].to, -1, 1e-14);
  EXPECT_NEAR(exact.stick_angle(), -ExactPendulum(5, {1, 0}).stick_angle(), 1e-13);
}

TEST(Pendulum, StaysWhereFrictionOutweighsGravity) {
  const double band = std::asin(25 / kPendulumGravity);
  EXPECT_TRUE(ExactPendulum(5, {band - 1e-9, 0}).swings().empty());
  EXPECT_EQ(ExactPendulum(5, {band + 1e-9, 0}).swings().size(), 1u);
  EXPECT_EQ(ExactPendulum(5, {0.5, 0}).angle_at(3), 0.5);
}

TEST(Pendulum, RefusesToGoOverTheTop) {
  EXPECT_THROW(ExactPendulum(1, {0, 13}), std::invalid_argument);
  EXPECT_THROW(ExactPendulum(1, {3.2, 0}), std::invalid_argument);
  EXPECT_THROW(ExactPendulum(0, {1, 0}), std::invalid_argument);
}

// ---- the error table

/// Mean errors of an independent implementation, three digits, in the order of kPendulumSteps.
struct ErrorRow {
  const char* name;
  double upsilon;
  EulerScheme scheme;
  std::vector<double> error;
};
const std::vector<ErrorRow> kErrorTable{
    {"projected", 2, kProjected, {5.86e-2, 4.31e-2, 2.15e-2, 1.01e-2, 4.46e-3, 2.27e-3, 1.37e-3, 5.55e-4, 3.34e-4}},
    {"regularised",
     2,
     kLinearlyImplicit,
     {1.65e-1, 1.44e-1, 1.35e-1, 1.09e-1, 9.90e-2, 5.33e-2, 2.35e-2, 2.19e-2, 1.43e-2}},
    {"projected", 5, kProjected, {1.39e-2, 7.92e-3, 5.25e-3, 1.64e-3, 7.75e-4, 3.78e-4, 2.47e-4, 1.24e-4, 6.11e-5}},
    {"regularised",
     5,
     kLinearlyImplicit,
     {3.42e-1, 3.22e-1, 3.29e-1, 2.63e-1, 1.89e-1, 1.04e-1, 6.93e-2, 9.99e-3, 1.05e-3}}};

TEST(Pendulum, MeanErrorsAreThoseOfAnIndependentImplementationToThreeDigits) {
  for (const ErrorRow& row : kErrorTable)
    for (std::size_t i = 0; i < kPendulumSteps.size(); ++i) {
      const double error = mean_error(row.scheme, {.upsilon = row.upsilon, .steps = kPendulumSteps[i]});
      EXPECT_EQ(fmt::format("{:.2e}", error), fmt::format("{:.2e}", row.error[i]))
          << row.name << ", Y " << row.upsilon << ", steps " << kPendulumSteps[i];
    }
}

TEST(Pendulum, EngineAsImplicitEulerIsWorseThanTheProjectedScheme) {
  for (const double upsilon : {2.0, 5.0})
    for (const int steps : kPendulumSteps) {
      const PendulumCase c{.upsilon = upsilon, .steps = steps};
      EXPECT_GT(mean_error(kEngineEuler, c), 2 * mean_error(kProjected, c)) << upsilon << ' ' << steps;
    }
}

TEST(Pendulum, EngineAtThetaOneHalfIsBetterThanTheProjectedScheme) {
  for (const double upsilon : {2.0, 5.0})
    for (const int steps : kPendulumSteps) {
      const PendulumCase c{.upsilon = upsilon, .steps = steps};
      // one exception: at Y = 2 and ten steps they are level, 6.11e-2 against 5.86e-2. The engine looks at the angle of
      // the end anew only when that was guessed wrong by a tenth of the step; looking always it has 5.73e-2.
      const double factor = upsilon == 2 && steps == 10 ? 1.05 : 1.0;
      EXPECT_LT(mean_error(kEngineMiddle, c), factor * mean_error(kProjected, c)) << upsilon << ' ' << steps;
    }
}

// ---- steps at one per cent

TEST(Pendulum, TheRegularisedSchemeNeedsThirtyTimesTheStepsAtOnePercent) {
  for (const double upsilon : {2.0, 5.0}) {
    const int projected = steps_needed(kProjected, {.upsilon = upsilon}, 0.01, 500).lasting;
    const int regularised = steps_needed(kLinearlyImplicit, {.upsilon = upsilon}, 0.01, 2000).lasting;
    const int engine = steps_needed(kEngineMiddle, {.upsilon = upsilon}, 0.01, 100).lasting;
    ASSERT_GT(engine, 0);
    EXPECT_LE(engine, projected);
    EXPECT_GT(regularised, 30 * projected) << upsilon;
  }
  // thesis 5.2.5: 40 and 15
  EXPECT_NEAR(steps_needed(kProjected, {.upsilon = 2}, 0.01, 500).lasting, 40, 1);
  EXPECT_LE(steps_needed(kProjected, {.upsilon = 5}, 0.01, 500).lasting, 15);
}

TEST(Pendulum, StepsAreCountedFromWhereTheErrorStaysSmall) {
  // by luck 198 steps a period are within 1 %, and 250 are not
  const StepsNeeded needed = steps_needed(kLinearlyImplicit, {.upsilon = 5}, 0.01, 2000);
  EXPECT_LT(needed.first, 250);
  EXPECT_GT(needed.lasting, 500);
  EXPECT_EQ(steps_needed(kLinearlyImplicit, {.upsilon = 5}, 0.01, 60).first, 0);
}

TEST(Pendulum, TheRampMetAtTheEndOfTheStepNeedsNoMoreThanAFewSteps) {
  // it is the linearisation of friction, and implicit gravity, that cost the steps, not the regularised law
  constexpr EulerScheme kRamp{FrictionLaw::regularised, Gravity::at_start};
  constexpr EulerScheme kImplicitGravity{FrictionLaw::set_valued, Gravity::linearised};
  for (const double upsilon : {2.0, 5.0}) {
    const int projected = steps_needed(kProjected, {.upsilon = upsilon}, 0.01, 500).lasting;
    EXPECT_LT(steps_needed(kRamp, {.upsilon = upsilon}, 0.01, 500).lasting, 1.5 * projected);
    EXPECT_GT(steps_needed(kImplicitGravity, {.upsilon = upsilon}, 0.01, 2000).lasting, 10 * projected);
  }
}

// ---- rest

TEST(Pendulum, HangsStillForAMinute) {
  for (const PendulumScheme& scheme :
       {PendulumScheme{kProjected}, PendulumScheme{kEngineEuler}, PendulumScheme{kEngineMiddle}})
    for (const double upsilon : {2.0, 5.0})
      for (const int steps : {20, 1000}) {
        const PendulumRest rest = rest_of(scheme, {.upsilon = upsilon, .steps = steps});
        EXPECT_LE(rest.fastest, 1e-15) << upsilon << ' ' << steps;
        EXPECT_LE(std::abs(rest.drift), 60e-15) << upsilon << ' ' << steps;
        EXPECT_GT(rest.angle, 0.01) << upsilon << ' ' << steps;  // not at the bottom, where anything would rest
      }
}

TEST(Pendulum, TheRampCreepsAsItsSlopeSays) {
  // balance on the ramp: Y^2 Psi theta' = -4 pi^2 sin theta; inertia changes that by (4 pi^2 / (Y^2 Psi))^2 and less
  constexpr EulerScheme kRamp{FrictionLaw::regularised, Gravity::at_start};
  for (const double upsilon : {2.0, 5.0}) {
    const PendulumCase c{.upsilon = upsilon, .steps = 1000};
    const PendulumRest rest = rest_of(kRamp, c);
    const double creep = kPendulumGravity * std::sin(rest.angle) / (upsilon * upsilon * c.psi);
    EXPECT_NEAR(rest.fastest, creep, 1e-5 * creep);
    EXPECT_LT(rest.drift, -50 * creep);
  }
}

TEST(Pendulum, StickingAngleConvergesToTheExactOne) {
  for (const double upsilon : {2.0, 5.0}) {
    const ExactPendulum exact(upsilon, {1, 0});
    const double swings = static_cast<double>(exact.swings().size());
    for (const int steps : {100, 1000, 10000}) {
      const PendulumCase c{.upsilon = upsilon, .steps = steps};
      // a half swing ends within a step of its turning point: (4 pi^2 + Y^2) h^2 of angle at most
      const double bound = swings * (kPendulumGravity + upsilon * upsilon) / (1.0 * steps * steps);
      EXPECT_NEAR(final_angle(kProjected, c), exact.stick_angle(), bound) << upsilon << ' ' << steps;
      EXPECT_NEAR(final_angle(kEngineMiddle, c), exact.stick_angle(), bound) << upsilon << ' ' << steps;
    }
    // implicit Euler is of first order: ten times the steps, a tenth of the error
    const double coarse = final_angle(kEngineEuler, {.upsilon = upsilon, .steps = 1000}) - exact.stick_angle();
    const double fine = final_angle(kEngineEuler, {.upsilon = upsilon, .steps = 10000}) - exact.stick_angle();
    EXPECT_NEAR(fine / coarse, 0.1, 0.01) << upsilon;
  }
}

// ---- what the thesis shows of regularisation

TEST(Pendulum, ALowSlopeConvergesToTheWrongRest) {
  // Figure 5.4: to 0 instead of 0.3967 rad, with 1000 steps a period (caption) as with 10000 (text). What is left of the
  // radian after five periods of viscous damping Y^2 Psi:
  const double left = std::exp(-0.5 * 25 * 0.1 * kPendulumPeriods);
  for (const int steps : {1000, 10000}) {
    EXPECT_NEAR(final_angle(kLinearlyImplicit, {5, 0.1, steps}), 0, left);
    EXPECT_NEAR(final_angle(ExplicitEuler{}, {5, 0.1, steps}), 0, left);
  }
}

int count_reversals(const PendulumScheme& scheme, const PendulumCase& c) {
  int reversals = 0;
  double last = 0;
  run_pendulum(scheme, c, 5L * c.steps, [&](long, const PendulumState& state) {
    reversals += state.rate * last < 0;
    last = state.rate;
  });
  return reversals;
}

TEST(Pendulum, OnlyTheLinearisedRampChatters) {
  // Figure 5.6; exactly it never turns
  const PendulumCase c{.upsilon = 5, .steps = 50};
  EXPECT_GT(count_reversals(kLinearlyImplicit, c), 100);
  EXPECT_GT(count_reversals(ExplicitEuler{}, c), 100);
  EXPECT_EQ(count_reversals(EulerScheme{FrictionLaw::regularised, Gravity::at_start}, c), 0);
  EXPECT_EQ(count_reversals(EulerScheme{FrictionLaw::regularised, Gravity::linearised}, c), 0);
  EXPECT_EQ(count_reversals(kProjected, c), 0);
}

TEST(Pendulum, ExplicitEulerGrowsWhereItsMatrixIsStable) {
  // Figure 5.3. Growth in sliding, against friction: small-angle estimate of the threshold, hence 25 % about it
  const PendulumCase printed{1, 10, 100};
  EXPECT_LT(explicit_spectral_radius(printed), 1);
  const double threshold = explicit_growth_threshold(printed);
  for (const double psi : {10.0, 1e4})
    for (const double factor : {0.75, 1.25}) {
      const PendulumCase c{1, psi, 100, {factor * threshold, 0}};
      double largest = 0;  // of the last period of twenty
      run_pendulum(ExplicitEuler{}, c, 2000, [&](long k, const PendulumState& state) {
        if (k > 1900) largest = std::max(largest, std::abs(state.angle));
      });
      if (factor > 1)
        EXPECT_GT(largest, c.start.angle) << psi;
      else
        EXPECT_LT(largest, 0.1 * c.start.angle) << psi;
    }
}

TEST(Pendulum, SpectralRadiusIsThatOfTheMatrix) {
  // (5.21): real eigenvalues 1 - (a -+ sqrt(a^2 - 16 pi^2)) h / 2, and complex ones of modulus sqrt(det C)
  const double a = 25 * 100, h = 1e-3;
  EXPECT_NEAR(explicit_spectral_radius({5, 100, 1000}),
              std::abs(1 - h / 2 * (a + std::sqrt(a * a - 4 * kPendulumGravity))), 1e-14);
  EXPECT_NEAR(explicit_spectral_radius({1, 10, 100}), std::sqrt(1 - 0.1 + kPendulumGravity * 1e-4), 1e-14);
}

}  // namespace
}  // namespace erard::study
