// The piston follows the key, stands in for lost samples, never jumps, and stands still where the key does.
#include "erard/haptics/piston_track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace erard {
namespace {

constexpr double kT = 5e-4;          // [s]
constexpr double kRounding = 1e-12;  // [m] and [m/s] of numbers below 1

PistonTrackSettings exact() {
  PistonTrackSettings settings;
  settings.estimator = {RateEstimatorKind::sliding_polynomial, 2, 1, 0, 0};
  return settings;
}

/// A track and its settings. The force is off where a test does not say otherwise.
struct Track {
  explicit Track(const PistonTrackSettings& s) : settings(s), track(s, kT) {}

  DriveSample take(double position, int lost = 0) { return step(&position, lost, false); }
  DriveSample resume(double position) { return step(&position, 0, true); }
  DriveSample miss() { return step(nullptr, 0, false); }

  DriveSample step(const double* position, int lost, bool resumed) {
    const double before = track.piston().value;
    position != nullptr ? track.take(settings, kT, *position, lost, resumed) : track.miss(settings, kT);
    const DriveSample now = track.advance(settings, kT, is_force_off);
    largest_step = std::max(largest_step, std::abs(now.value - before));
    return now;
  }

  PistonTrackSettings settings;
  PistonTrack track;
  bool is_force_off = true;
  double largest_step = 0;  // [m]
};

TEST(PistonTrack, IsThePositionAndItsRate) {
  Track track(exact());
  track.resume(0);
  for (int i = 1; i < 50; ++i) {
    const DriveSample piston = track.take(1e-4 * i);
    EXPECT_NEAR(piston.value, 1e-4 * i, kRounding);
    EXPECT_NEAR(piston.rate, 0.2, 1e-9);  // differences of 1e-4 m to 1e-18, over 5e-4 s
  }
}

TEST(PistonTrack, GuessesALostSampleFromTheRate) {
  Track track(exact());
  track.resume(0);
  for (int i = 1; i < 10; ++i) track.take(1e-4 * i);
  for (int i = 10; i < 12; ++i) {
    const DriveSample guess = track.miss();
    EXPECT_NEAR(guess.value, 1e-4 * i, kRounding);
    EXPECT_NEAR(guess.rate, 0.2, 1e-9);
  }
  const DriveSample next = track.take(1e-4 * 12, 2);
  EXPECT_NEAR(next.value, 1e-4 * 12, kRounding);
  EXPECT_NEAR(next.rate, 0.2, 1e-9);
}

TEST(PistonTrack, StandsWithRateZeroWhenTooManyAreLost) {
  Track track(exact());
  track.resume(0);
  for (int i = 1; i < 10; ++i) track.take(1e-4 * i);
  track.miss(), track.miss();
  const double stood = track.track.piston().value;
  for (int i = 0; i < 10; ++i) {
    const DriveSample piston = track.miss();
    EXPECT_EQ(piston.value, stood);
    EXPECT_EQ(piston.rate, 0);
  }
}

TEST(PistonTrack, TwoSamplesInOnePeriodDoNotDoubleTheRate) {
  Track track(exact());
  track.resume(0);
  for (int i = 1; i < 10; ++i) track.take(1e-4 * i);
  EXPECT_NEAR(track.take(1e-4 * 11, 1).rate, 0.2, 1e-9);
}

TEST(PistonTrack, AJumpMovesThePistonNoFasterThanAllowed) {
  Track track(exact());
  track.resume(0);
  for (int i = 0; i < 10; ++i) track.take(0);
  track.largest_step = 0;
  track.resume(0.009);
  EXPECT_FALSE(track.track.is_aligned());
  int periods = 0;
  while (!track.track.is_aligned()) track.take(0.009), ++periods;
  EXPECT_LE(track.largest_step, track.settings.realign_speed * kT + kRounding);
  // 9 mm at 20 mm/s take 0.45 s, the last 0.4 mm of it exponentially: 20 ms ln 4 instead of 15 ms
  EXPECT_NEAR(periods * kT, 0.45, 0.03);
  for (int i = 0; i < 1000; ++i) track.take(0.009);
  EXPECT_NEAR(track.track.piston().value, 0.009, track.settings.still_zone);  // then it may stand still
}

TEST(PistonTrack, DoesNotGoElsewhereWhileAForceIsFelt) {
  Track track(exact());
  track.resume(0);
  track.is_force_off = false;
  track.resume(0.009);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(track.take(0.009).value, 0);
  track.is_force_off = true;
  EXPECT_GT(track.take(0.009).value, 0);
}

TEST(PistonTrack, FollowsTheKeyWhileItRealigns) {
  Track track(exact());
  track.resume(0);
  track.is_force_off = false;
  track.resume(0.005);
  double last = track.take(0.005).value;
  for (int i = 1; i < 20; ++i) {
    const double now = track.take(0.005 + 1e-4 * i).value;
    EXPECT_NEAR(now - last, 1e-4, kRounding);
    last = now;
  }
}

/// Periods, of 20000, in which the piston of a key that stands still did not stand to the bit.
int restless(double noise) {
  PistonTrackSettings settings;  // zone 300 um
  Track track(settings);
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, noise);
  track.resume(0.004);
  for (int i = 0; i < 1000; ++i) track.take(0.004 + error(random));
  int moved = 0;
  double last = track.track.piston().value;
  for (int i = 0; i < 20000; ++i) {
    const DriveSample piston = track.take(0.004 + error(random));
    moved += piston.value != last || piston.rate != 0;
    last = piston.value;
  }
  return moved;
}

TEST(PistonTrack, StandsToTheBitWhenTheKeyStandsButForNoise) {
  EXPECT_EQ(restless(5e-5), 0);      // the zone is six times this
  EXPECT_GT(restless(2e-4), 10000);  // and one and a half times this
}

TEST(PistonTrack, LeavesAStandstillWithoutAJumpAndWithoutAKick) {
  PistonTrackSettings settings;
  Track track(settings);
  track.resume(0.004);
  for (int i = 0; i < 1000; ++i) track.take(0.004);
  ASSERT_TRUE(track.track.is_still());
  track.is_force_off = false;
  track.largest_step = 0;
  double fastest = 0;
  for (int i = 1; i < 400; ++i) fastest = std::max(fastest, track.take(0.004 + 5e-6 * i).rate);  // 10 mm/s
  EXPECT_LT(track.largest_step, 2 * 5e-6);  // of its own 5 um and what is left of the zone
  // to its 10 mm/s the rate adds that of the offset, at most 50 um in realign_time, and what the parabola makes of its
  // first samples after it has begun anew
  EXPECT_LT(fastest, 0.010 + 0.0025 + 1e-4);
  EXPECT_NEAR(track.track.piston().value, 0.004 + 5e-6 * 399, 1e-8);
}

TEST(PistonTrack, ALostMessageDoesNotWakeAKeyThatStands) {
  PistonTrackSettings settings;
  Track track(settings);
  track.resume(0.004);
  for (int i = 0; i < 1000; ++i) track.take(0.004);
  const double stood = track.track.piston().value;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(track.miss().value, stood);
  EXPECT_EQ(track.take(0.004001).value, stood);
  EXPECT_TRUE(track.track.is_still());
}

}  // namespace
}  // namespace erard
