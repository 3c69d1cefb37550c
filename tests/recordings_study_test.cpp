// Reading strikes off a hammer's curve, on curves whose strikes are known, and what is certain of the recorded ones.
#include "study/recordings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/strokes.hpp"

namespace erard::study {
namespace {

constexpr double kPeriod = 5e-4;  // [s]
constexpr double kBlow = 0.046;   // [m]

struct Curve {
  std::vector<double> time, way;
};

Curve sample(double duration, const std::function<double(double)>& way) {
  Curve curve;
  for (int i = 0; i * kPeriod < duration; ++i) {
    curve.time.push_back(i * kPeriod);
    curve.way.push_back(way(i * kPeriod));
  }
  return curve;
}

/// Rests until 0.1 s, speeds up evenly to the string, which it meets at 0.13 s, and falls back to `check` in 0.03 s.
double made_up_blow(double t, double check) {
  if (t < 0.1) return 0;
  if (t < 0.13) return std::pow((t - 0.1) / 0.03, 2);
  return std::max(check, 1 - (t - 0.13) / 0.03 * (1 - check));
}

TEST(Arrivals, AreReadOffAMadeUpBlow) {
  const Curve curve = sample(0.3, [](double t) { return made_up_blow(t, 0.64); });
  const auto arrivals = find_arrivals(curve.time, curve.way, kBlow);
  ASSERT_EQ(arrivals.size(), 1U);
  // a straight line between samples of a parabola is off by at most T^2 (2 / 0.03^2) / 8 of the way, over its slope there
  const double line = kPeriod * kPeriod / (4 * 0.03 * 0.03);
  EXPECT_NEAR(arrivals[0].time, 0.1 + 0.03 * std::sqrt(0.98), line / (2 / 0.03));
  const double span = 0.03 * (std::sqrt(0.9) - std::sqrt(0.6));
  EXPECT_NEAR(arrivals[0].mean_speed, 0.3 * kBlow / span, 2 * line / 0.3 * 0.3 * kBlow / span);
  // the cubic through nine samples is exact on a parabola; the last before the arrival has its middle 5 samples before it
  const double middle = std::ceil((arrivals[0].time - 1e-9) / kPeriod) * kPeriod - 5 * kPeriod - 0.1;
  EXPECT_NEAR(arrivals[0].peak_speed, 2 * middle / (0.03 * 0.03) * kBlow, 1e-9);
  EXPECT_EQ(arrivals[0].from, 0);
}

TEST(Arrivals, AreFoundOnceForEachBlowOutOfTheCheck) {
  const auto two_blows = [](double t) { return t < 0.3 ? made_up_blow(t, 0.3) : made_up_blow(t - 0.3 + 0.02, 0.64); };
  EXPECT_EQ(find_arrivals(sample(0.6, two_blows).time, sample(0.6, two_blows).way, kBlow).size(), 2U);
  // one that bobs up to the string again from the check at 64 % is the same blow
  const auto bobbing = [](double t) {
    return t < 0.2 ? made_up_blow(t, 0.64) : 0.64 + 0.36 * std::sin((t - 0.2) * 50);
  };
  EXPECT_EQ(find_arrivals(sample(0.25, bobbing).time, sample(0.25, bobbing).way, kBlow).size(), 1U);
  // and a press that leaves the hammer short of the string is none
  const auto press = [](double t) { return 0.97 * made_up_blow(t, 0.64); };
  EXPECT_TRUE(find_arrivals(sample(0.3, press).time, sample(0.3, press).way, kBlow).empty());
}

TEST(Arrivals, TellWhereTheHammerStartedAndTakeTheLastRise) {
  // up to 0.8, back to 0.3, then on to the string at 20 ways a second
  const auto twice = [](double t) {
    if (t < 0.1) return 8 * t;
    if (t < 0.15) return 0.8 - (t - 0.1) * 10;
    return std::min(1.0, 0.3 + (t - 0.15) * 20);
  };
  const Curve curve = sample(0.25, twice);
  const auto arrivals = find_arrivals(curve.time, curve.way, kBlow);
  ASSERT_EQ(arrivals.size(), 1U);
  EXPECT_NEAR(arrivals[0].from, 0.3, 1e-9);
  EXPECT_NEAR(arrivals[0].mean_speed, 20 * kBlow, 1e-9);
}

TEST(Arrivals, KeepTheirSpeedInTheNoiseOfTheSensor) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0,
                                         0.003);  // of the way: 10 um of 3.77 mm, ten times what the sensor has there
  const Curve clean = sample(0.3, [](double t) { return made_up_blow(t, 0.64); });
  Curve noisy = clean;
  for (double& way : noisy.way) way += noise(random);
  const Arrival truth = find_arrivals(clean.time, clean.way, kBlow).at(0);
  const Arrival read = find_arrivals(noisy.time, noisy.way, kBlow).at(0);
  EXPECT_NEAR(read.mean_speed / truth.mean_speed, 1, 4 * 0.003 * std::sqrt(2.0) / 0.3);  // both ends, four sigma
  EXPECT_NEAR(read.time, truth.time, kPeriod);
}

TEST(RiseTime, IsReadOffStraightLinesAndIsNoneWhereThereIsNone) {
  const std::vector<double> time{0, 1, 2, 3, 4, 5}, values{0, 1, 0, 0.5, 2, 2};
  EXPECT_DOUBLE_EQ(rise_time(time, values, 0.75, 0, 5), 0.75);
  EXPECT_NEAR(rise_time(time, values, 0.75, 1.5, 5), 3 + 0.25 / 1.5, 1e-15);
  EXPECT_TRUE(std::isnan(rise_time(time, values, 3, 0, 5)));
  EXPECT_TRUE(std::isnan(rise_time(time, values, 0.75, 1.5, 3)));
}

TEST(HammerWay, IsTheBlowDistanceOfTheAction) {
  const HammerWay way = measure_hammer_way(test::grand_action());
  EXPECT_EQ(way.fraction(way.rest), 0);
  EXPECT_EQ(way.fraction(way.string), 1);
  // head to string 46.0 mm in a straight line, docs/action.md; the arc is longer, by less than (0.35 rad)^2 / 6
  EXPECT_GT(way.blow, 0.0460);
  EXPECT_LT(way.blow, 0.0460 * 1.02);
}

TEST(RecordedStrikes, AreReadAsTheyWereWhenTheRecordingsWereSelected) {
  // key bottom after hammer [ms] and highest hammer speed [m/s] for a blow of 46 mm, known with the recordings; times to
  // samples of 0.5 ms, and the threshold of the arrival not known: 1 % of the way is half a millisecond
  struct Known {
    const char* name;
    double delay, speed;
  };
  constexpr double kRest =
      (0.5 + 4 * 0.045) / 11.906;  // what the import takes for rest, and four times the noise there
  const HammerWay way = measure_hammer_way(test::grand_action());
  for (const Known& known : {Known{"s2_medium_strike_hold", 6.5e-3, 1.08},
                             {"s3_fast_strike_free_release", 2.0e-3, 2.80},
                             {"s4_fast_strike_A", 2.0e-3, 2.54}}) {
    SCOPED_TRACE(known.name);
    const RecordingRun played = play_recording(test::grand_action(), known.name);
    ASSERT_EQ(played.strikes.size(), 1U);
    const StrikePair& strike = played.strikes[0];
    EXPECT_NEAR(strike.recorded_delay(), known.delay, 1e-3);
    EXPECT_NEAR(strike.recorded.peak_speed * 0.046 / way.blow, known.speed, 0.03 * known.speed);  // another filter
    // the key is given: the model's is the recorded one, but for smoothing, and what it does beyond the clip
    EXPECT_NEAR(strike.predicted_bottom, strike.recorded_bottom, kPeriod);
    for (std::size_t i = 0; i < played.time.size(); ++i) {
      ASSERT_NEAR(std::min(played.predicted_key[i], 1.0), played.recorded_key[i], kRest) << played.time[i];
    }
    // certain is the scale of the recorded hammer to +-20 %, and to no more: the blow of that piano is not known
    EXPECT_NEAR(strike.predicted.mean_speed / strike.recorded.mean_speed, 1, 0.25);
    EXPECT_NEAR(strike.predicted.peak_speed / strike.recorded.peak_speed, 1, 0.25);
    EXPECT_NEAR(strike.predicted.time, strike.recorded.time, 6e-3);
  }
}

TEST(RecordedStrikes, AreEightInTheRepeatedRecording) {
  const RecordingRun played = play_recording(test::grand_action(), "s7_repeated_strikes_x9");
  ASSERT_EQ(played.strikes.size(), 8U);
  for (const StrikePair& strike : played.strikes) {
    EXPECT_GE(strike.recorded_delay(),
              2.0e-3);  // known with the recordings: 2.5 to 5.5 ms; half a millisecond each way
    EXPECT_LE(strike.recorded_delay(), 7.0e-3);  // for samples and for the threshold
  }
  // strikes at about 4.6 Hz
  const double span = played.strikes.back().recorded.time - played.strikes.front().recorded.time;
  EXPECT_NEAR(7 / span, 4.6, 0.1);
}

TEST(RecordedStrikes, PredictWhatTheEventDetectorSees) {
  const ActionFile action = test::grand_action();
  const RecordingRun played = play_recording(action, "s4_fast_strike_A");
  const test::Stroke stroke = test::play(action, test::keystroke("recorded_fast"), test::default_tick(DriveKind::key));
  const Event* impact = stroke.find(EventKind::hammer_meets_string);
  ASSERT_NE(impact, nullptr);
  const Arrival& predicted = played.strikes.at(0).predicted;
  const double way_left = 0.02 * measure_hammer_way(action).blow;
  EXPECT_NEAR(impact->time - predicted.time, way_left / impact->hammer_speed, kPeriod);  // 98 % of the way to all of it
  EXPECT_NEAR(predicted.peak_speed, impact->hammer_speed, 0.05 * impact->hammer_speed);  // it flies, and rubs
}

TEST(RecordedStrikes, NeedARecordedHammer) {
  EXPECT_THROW(play_recording(test::grand_action(), "no_such_recording"), InputError);
}

}  // namespace
}  // namespace erard::study
