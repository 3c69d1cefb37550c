#include "erard/mechanics/felt_law.hpp"

#include <gtest/gtest.h>

#include "support/models.hpp"

namespace erard {
namespace {

const Felt kFelt = test::common_felt();

TEST(Felt, ForceAtAnInstantIsEquation44) {
  const double d = 2.6e-4, rate = 0.3;
  // thesis (4.4) written out; the damping opposes compression with a plus sign
  EXPECT_DOUBLE_EQ(felt_force(kFelt, d, rate), 1.6e10 * std::pow(d, 2.7) + 5e7 * d * d * rate);
}

TEST(Felt, ForcesOfTheThesisGiveItsFrontRailCompressions) {
  // thesis 6.4.1 prints 0.26 mm at 3.5 N and 0.38 mm at 9 N: half a unit of the last digit is 0.005 mm
  const auto compression = [](double force) { return std::pow(force / kFelt.stiffness, 1 / kFelt.exponent); };
  EXPECT_NEAR(compression(3.5), 2.6e-4, 0.05e-4);
  EXPECT_NEAR(compression(9.0), 3.8e-4, 0.05e-4);
  EXPECT_DOUBLE_EQ(felt_force(kFelt, compression(9.0), 0), 9.0);
}

TEST(Felt, GivesNothingWhereItIsNotCompressed) {
  EXPECT_EQ(felt_force(kFelt, 0, 1.0), 0);
  EXPECT_EQ(felt_force(kFelt, -1e-4, -1.0), 0);
  EXPECT_EQ(mean_felt_force(kFelt, -1e-4, -2e-4, 1e-4).force, 0);
}

/// Mean of (4.4) along the straight path by Simpson's rule with 2000 intervals: error below 1e-12 of the force.
double mean_by_quadrature(const Felt& felt, double d0, double d1, double h) {
  const int n = 2000;
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const double d = d0 + (d1 - d0) * i / n;
    sum += (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * felt_force(felt, d, (d1 - d0) / h);
  }
  return sum / (3 * n);
}

TEST(Felt, MeanForceIsTheMeanOfTheLawAlongThePath) {
  const double h = 1.25e-4;
  for (const auto& [d0, d1] : {std::pair{1e-4, 3e-4}, {3e-4, 1e-4}, {2e-4, 2.0001e-4}, {2e-4, 2.0019e-4}, {1e-6, 4e-4}})
    EXPECT_NEAR(mean_felt_force(kFelt, d0, d1, h).force / mean_by_quadrature(kFelt, d0, d1, h), 1, 1e-9);
}

TEST(Felt, MeanForceOfARestingFeltIsTheLaw) {
  EXPECT_DOUBLE_EQ(mean_felt_force(kFelt, 2e-4, 2e-4, 1e-4).force, felt_force(kFelt, 2e-4, 0));
}

TEST(Felt, SlopeIsTheDerivativeOfTheMeanForce) {
  const double h = 1.25e-4, e = 1e-10;
  for (const auto& [d0, d1] : {std::pair{1e-4, 3e-4}, {3e-4, 1e-4}, {0.0, 2e-4}, {2e-4, 2.00005e-4}, {-1e-4, 1e-4}}) {
    const double slope =
        (mean_felt_force(kFelt, d0, d1 + e, h).force - mean_felt_force(kFelt, d0, d1 - e, h).force) / (2 * e);
    // central difference: rounding 1e-16 F / e = 1e-5 of the slope
    EXPECT_NEAR(mean_felt_force(kFelt, d0, d1, h).slope / slope, 1, 1e-4);
  }
}

TEST(Felt, ElasticWorkOverAClosedPathVanishes) {
  Felt felt = kFelt;
  felt.damping = 0;
  double work = 0;
  const double path[] = {0, 2e-4, 3.5e-4, 3.4e-4, 1e-4, 0};
  for (int i = 0; i < 5; ++i) work += mean_felt_force(felt, path[i], path[i + 1], 1e-4).force * (path[i + 1] - path[i]);
  EXPECT_NEAR(work, 0, 1e-12 * felt_energy(felt, 3.5e-4));  // rounding of five terms
}

TEST(Felt, DampingTakesEnergyBothWays) {
  Felt felt = kFelt;
  felt.stiffness = 0;
  EXPECT_GT(mean_felt_force(felt, 1e-4, 2e-4, 1e-4).force, 0);
  EXPECT_LT(mean_felt_force(felt, 2e-4, 1e-4, 1e-4).force, 0);
}

TEST(Felt, EnergyRatioOfEquation411IsFar206) {
  // thesis (4.11) prints 22 for 1 mm in 0.1 s; with b = 5e7 the integrals give 206 (erratum)
  const double elastic = felt_energy(kFelt, 1e-3);
  const double viscous = 5e7 * 1e-9 / 3 * 1e-2;  // integral of b x^2 x'^2 dt at x' = 1e-2 m/s
  EXPECT_NEAR(elastic / viscous, 206, 1);
}

}  // namespace
}  // namespace erard
