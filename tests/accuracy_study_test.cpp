// How far the default settings are from a converged run; times of computing are not asserted anywhere.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "study/work_precision.hpp"

namespace erard::study {
namespace {

struct Judged {
  JudgedStroke stroke;
  JudgedRun truth, run;  // converged; by default
};

const Judged& judged(const std::string& name) {
  static std::map<std::string, Judged> all;
  if (const auto found = all.find(name); found != all.end()) return found->second;
  const ActionFile action = default_action();
  const JudgedStroke stroke = judged_stroke(name);
  return all
      .emplace(name, Judged{stroke, play_judged(action, stroke, converged_steps()),
                            play_judged(action, stroke, ticking("default", "", TickSettings{}))})
      .first->second;
}

ForceError error_of(const std::string& name, const Candidate& candidate, double end) {
  const Judged& j = judged(name);
  return force_error(play_judged(default_action(), j.stroke, candidate), j.truth, end);
}

/// Goals at 2 kHz [N], of forces that peak at 3 N (piano), 10 N (forte) and 60 N (very fast).
struct Goal {
  const char* stroke;
  double rms, largest;
};
constexpr Goal kGoals[]{
    {"piano", 0.02, 0.25}, {"forte", 0.05, 0.25}, {"very fast", 0.1, 1}, {"repetition", 0.05, 0.25}};

TEST(Accuracy, WhatIsCalledConvergedIs) {
  for (const Goal& goal : kGoals) {
    const Judged& j = judged(goal.stroke);
    const JudgedRun half = play_judged(default_action(), j.stroke, converged_steps(100));
    const ForceError error = force_error(half, j.truth, j.stroke.end);
    // of second order it is off itself by a third of its distance from one with half as many steps
    EXPECT_LT(error.rms, 0.01 * goal.rms) << goal.stroke;
    EXPECT_LT(error.largest, 0.01 * goal.largest) << goal.stroke;
    EXPECT_LT(std::abs(event_error(half, j.truth).time), 2 * kOutputPeriod / 100) << goal.stroke;
  }
}

TEST(Accuracy, ForceIsWithinItsGoalUpToTheRelease) {
  for (const Goal& goal : kGoals) {
    const Judged& j = judged(goal.stroke);
    const ForceError error = force_error(j.run, j.truth, j.stroke.end);
    EXPECT_LT(error.rms, goal.rms) << goal.stroke;
    EXPECT_LT(error.largest, goal.largest) << goal.stroke;
  }
}

TEST(Accuracy, ForceIsWithinItsGoalBeforeTheCheck) {
  for (const Goal& goal : kGoals) {
    const Judged& j = judged(goal.stroke);
    if (j.stroke.check == 0) continue;
    const ForceError error = force_error(j.run, j.truth, j.stroke.check);
    EXPECT_LT(error.rms, goal.rms) << goal.stroke;
    EXPECT_LT(error.largest, goal.largest) << goal.stroke;
  }
}

TEST(Accuracy, StepsOfTheSameLengthThatAreNeverRefusedMissTheGoals) {
  for (const Goal& goal : kGoals) {
    const ForceError error = error_of(goal.stroke, fixed_steps(0.5, kCalmStep), judged(goal.stroke).stroke.end);
    EXPECT_GT(error.largest, goal.largest) << goal.stroke;
  }
}

TEST(Accuracy, HammerMeetsTheStringAtItsSpeed) {
  for (const Goal& goal : kGoals) {
    const Judged& j = judged(goal.stroke);
    EXPECT_LT(std::abs(event_error(j.run, j.truth).speed), 0.005) << goal.stroke;
  }
}

TEST(Accuracy, EventsAreWithinAQuarterOfAMillisecond) {
  for (const Goal& goal : kGoals) {
    const Judged& j = judged(goal.stroke);
    const EventError error = event_error(j.run, j.truth);
    EXPECT_EQ(error.missing, 0) << goal.stroke;
    EXPECT_EQ(j.run.events.size(), j.truth.events.size()) << goal.stroke;
    EXPECT_LT(std::abs(error.time), 2.5e-4) << goal.stroke << ", " << name_of(error.worst);
  }
}

TEST(Accuracy, RecordedStrokeIsAsGoodAsAForteButForItsLargestError) {
  const Judged& j = judged("recorded_fast");
  EXPECT_LT(force_error(j.run, j.truth, j.stroke.end).rms, 0.05);
  const EventError error = event_error(j.run, j.truth);
  EXPECT_EQ(error.missing, 0);
  EXPECT_LT(std::abs(error.time), 2.5e-4) << name_of(error.worst);
  EXPECT_LT(std::abs(error.speed), 0.005);
}

TEST(Accuracy, KeyRingsOnTheFrontRailAsItShould) {
  for (const auto& [name, from, until] : {std::tuple{"piano", 0.14, 0.20}, {"forte", 0.08, 0.12}}) {
    const RailRinging ours = rail_ringing(judged(name).run, from, until);
    const RailRinging truth = rail_ringing(judged(name).truth, from, until);
    EXPECT_GE(truth.extremes, 6) << name;
    EXPECT_EQ(ours.extremes, truth.extremes) << name;
    EXPECT_NEAR(ours.frequency, truth.frequency, 0.05 * truth.frequency) << name;
    EXPECT_NEAR(ours.amplitude, truth.amplitude, 0.05 * truth.amplitude) << name;
  }
}

TEST(Accuracy, MiddleSchemeIsOfSecondOrderAndEulerOfFirst) {
  const double check = judged("forte").stroke.check;
  const auto gain = [&](double theta) {
    return error_of("forte", fixed_steps(theta, 1.25e-4), check).rms /
           error_of("forte", fixed_steps(theta, 6.25e-5), check).rms;
  };
  EXPECT_NEAR(gain(0.5), 4, 1);  // impacts fall into other places of their steps: no exact power
  EXPECT_NEAR(gain(1), 2, 0.5);
}

TEST(Accuracy, LosersConvergeToTheSameForce) {
  // they have no error of their own: what they compute is the same model
  for (const Candidate& candidate : {fractional_steps(20), extrapolated_steps(20)})
    EXPECT_LT(error_of("forte", candidate, judged("forte").stroke.end).rms, 0.005) << candidate.family;
}

TEST(RailRinging, IsThatOfASine) {
  JudgedRun run;
  for (int i = 0; i <= 400; ++i)
    run.key.push_back(1e-2 + 3e-5 * std::sin(2 * std::numbers::pi * 110 * i * kOutputPeriod));
  const RailRinging ringing = rail_ringing(run, 0.05, 0.15);
  EXPECT_NEAR(ringing.frequency, 110, 0.5);  // parabolas through 18 rows a period
  EXPECT_NEAR(ringing.amplitude, 3e-5, 0.01 * 3e-5);
}

TEST(ForceError, IsTheDifferenceOfTheInstantsThatBothHave) {
  JudgedRun truth, run;
  truth.force = {1, 1, 1, 1, 1, 9};
  run.period = 2 * kOutputPeriod;
  run.force = {1, 1.3, 0.6};
  const ForceError error = force_error(run, truth, 4 * kOutputPeriod);
  EXPECT_DOUBLE_EQ(error.largest, 0.4);
  EXPECT_DOUBLE_EQ(error.rms, std::sqrt((0.09 + 0.16) / 3));
  EXPECT_DOUBLE_EQ(error.eta, 0.7 / 3);
}

TEST(EventError, CountsWhatIsMissing) {
  JudgedRun truth, run;
  truth.events = {{EventKind::hammer_meets_string, 0.1, 1, 2.0}, {EventKind::hammer_meets_string, 0.3, 2, 2.0}};
  run.events = {{EventKind::hammer_meets_string, 0.3002, 1, 2.1}};
  const EventError error = event_error(run, truth);
  EXPECT_EQ(error.missing, 1);
  EXPECT_EQ(error.compared, 1);
  EXPECT_NEAR(error.time, 2e-4, 1e-12);
  EXPECT_NEAR(error.speed, 0.05, 1e-12);
}

}  // namespace
}  // namespace erard::study
