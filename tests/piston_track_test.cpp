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

TEST(PistonTrack, StandsInTheMiddleOfTheNoise) {
  std::normal_distribution<double> error(0, 5e-5);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Track track(PistonTrackSettings{});
    std::mt19937 random(seed);
    track.resume(0.004);
    for (int i = 0; i < 2000; ++i) track.take(0.004 + error(random));
    ASSERT_TRUE(track.track.is_still());
    // six times 50 um / sqrt(100), and what is left of an offset, a 64th of the zone
    EXPECT_NEAR(track.track.piston().value, 0.004, 3.5e-5) << seed;
  }
}

struct Departure {
  double largest_step = 0, fastest = 0, last_miss = 0;  // [m], [m/s], [m]
};
/// A key that stood at 4 mm and goes on at a constant speed.
Departure depart(double speed) {
  PistonTrackSettings settings;
  Track track(settings);
  track.resume(0.004);
  for (int i = 0; i < 1000; ++i) track.take(0.004);
  EXPECT_TRUE(track.track.is_still());
  track.is_force_off = false;
  track.largest_step = 0;
  Departure seen;
  for (int i = 1; i < 600; ++i) seen.fastest = std::max(seen.fastest, track.take(0.004 + speed * kT * i).rate);
  seen.largest_step = track.largest_step;
  seen.last_miss = std::abs(track.track.piston().value - (0.004 + speed * kT * 599));
  EXPECT_TRUE(track.track.is_aligned());
  return seen;
}

TEST(PistonTrack, AKeyTooSlowToCountAsMovingIsFollowedInStepsOfASixthOfTheZone) {
  const Departure seen = depart(1e-3);
  const double zone = PistonTrackSettings().still_zone;
  EXPECT_LT(seen.largest_step, zone / 6);  // an eighth of it, and what s lags behind
  EXPECT_LT(seen.last_miss, zone / 6);
}

TEST(PistonTrack, LeavesAStandstillQuicklyWithAStepBelowItsZone) {
  for (const double speed : {0.01, 0.1, 0.5}) {
    const Departure seen = depart(speed);
    EXPECT_LT(seen.largest_step, PistonTrackSettings().still_zone + 2 * speed * kT) << speed;
    // the parabola overshoots by half when a ramp begins; to that comes the offset, 50 um in realign_time
    EXPECT_LT(seen.fastest, 1.5 * speed + 0.0025) << speed;
    EXPECT_LT(seen.last_miss, 1e-8) << speed;
  }
}

TEST(PistonTrack, AKeyThatIsPressedVerySlowlyDoesNotCountAsOneThatStands) {
  PistonTrackSettings settings;
  Track track(settings);
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 5e-5);
  track.resume(0);
  int stood = 0;
  for (int i = 0; i < 4000; ++i) {
    track.take(5e-3 * kT * i + error(random));  // 5 mm/s, 10 mm in two seconds
    stood += track.track.is_still();
  }
  EXPECT_EQ(stood, 0);
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
