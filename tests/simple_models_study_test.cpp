// Chapter 2: one degree of freedom against the complete action.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "study/simple_models.hpp"
#include "support/program.hpp"

using namespace erard;
using namespace erard::study;
using namespace erard::study::simple;

namespace {

const SimpleModelsStudy& study_() {
  static const SimpleModelsStudy study = study_simple_models();
  return study;
}

std::vector<const Stroke*> strokes() { return {&study_().piano, &study_().forte}; }
std::vector<SimpleAction> both_models() { return {thesis_action(), study_().model}; }

Sensitivity up_to_let_off(Path path, const Stroke& stroke) {
  return sensitivity(path, study_().model, stroke.record, study_().parts.down_force, stroke.record.let_off);
}
Sensitivity up_to_release(Path path, const Stroke& stroke) {
  return sensitivity(path, study_().model, stroke.record, study_().parts.down_force, stroke.record.release);
}

}  // namespace

// ---- this action

TEST(SimpleParts, StaticTestWeighsTheSpringToo) {
  const KeyParts& parts = study_().parts;
  const Equivalents one = equivalents(parts);
  const double middle = 4.25e-3 / parts.arm;  // touch is weighed from 1.5 to 7 mm
  // lever ratios that change along the way by some per cent weigh as much; without the spring it is 30 % off
  EXPECT_NEAR((one.weight + one.spring * (middle - one.spring_rest)) / one.static_weight, 1, 0.03);
}

TEST(SimpleParts, ActionHasTheWhippenAssemblyOfTableTwoOne) {
  // I_W is derived from J_2, printed to three digits
  EXPECT_NEAR(study_().parts.inertia[1], 3.97e-4, 0.005e-4);
  EXPECT_NEAR(study_().parts.weight[1], -0.0103, 0.5e-4);
  EXPECT_NEAR(study_().parts.weight[2], 0.0133, 0.5e-4);
}

// ---- the argument

TEST(SimpleModels, MotionUnderTheForceLooksRight) {
  // 5 % is what the thesis accepts between two measurements of the key's position (3.1.4)
  for (const Stroke* stroke : strokes())
    for (const SimpleAction& model : both_models())
      EXPECT_LT(judge(model, stroke->record, stroke->carried).motion.whole.eta, 0.05) << stroke->record.name;
}

TEST(SimpleModels, ForceUnderTheMotionIsWrong) {
  // more than twice what the thesis's complete model leaves against the measurement: 21 and 13 % (6.4.1)
  for (const SimpleAction& model : both_models()) {
    EXPECT_GT(judge(model, study_().piano.record, study_().piano.carried).force.whole.eta, 2 * 0.21);
    EXPECT_GT(judge(model, study_().forte.record, study_().forte.carried).force.whole.eta, 2 * 0.13);
  }
}

TEST(SimpleModels, ForceErrorIsAnOrderOfMagnitudeAboveThatOfTheMotion) {
  for (const Stroke* stroke : strokes())
    for (const SimpleAction& model : both_models()) {
      const Verdict verdict = judge(model, stroke->record, stroke->carried);
      EXPECT_GT(verdict.force.whole.eta, 10 * verdict.motion.whole.eta) << stroke->record.name;
    }
}

TEST(SimpleModels, ForceIsBestWhileTheHammerIsCarried) {
  for (const Stroke* stroke : strokes())
    for (const SimpleAction& model : both_models()) {
      const PhaseErrors force = judge(model, stroke->record, stroke->carried).force;
      EXPECT_LT(force.carried.eta, 0.5 * force.pick_up.eta) << stroke->record.name;
      EXPECT_LT(force.carried.eta, 0.5 * force.after.eta) << stroke->record.name;
    }
}

TEST(SimpleModels, DifferenceIsNotThatOfTheMethod) {
  // SK in place of the complete action: its force comes back at least ten times nearer
  const double down = study_().parts.down_force;
  for (const Stroke* stroke : strokes()) {
    const KeyRecord simple = simple_record(study_().model, stroke->record, down);
    const Verdict control = judge_alone(study_().model, simple, stroke->carried, down);
    const Verdict verdict = judge_alone(study_().model, stroke->record, stroke->carried, down);
    EXPECT_LT(10 * control.force.whole.eta, verdict.force.whole.eta) << stroke->record.name;
    EXPECT_LT(control.motion.whole.eta, 1e-12) << stroke->record.name;  // the same computation twice
  }
}

TEST(SimpleModels, NoInertiaSavesTheForceAndThatOfThePartsGivesTheMotion) {
  for (const Stroke* stroke : strokes()) {
    const InertiaScan scan = scan_inertia(study_().model, stroke->record);
    EXPECT_GT(scan.least_force, 2 * 0.21) << stroke->record.name;  // as above
    EXPECT_NEAR(scan.best_factor, 1, 0.1) << stroke->record.name;  // two steps of the scan
  }
}

TEST(SimpleModels, KeepingTheRateAtTheTakeoverSpoilsTheMotion) {
  SimpleAction jumping = thesis_action();
  jumping.takeover = Takeover::keeps_velocity;
  for (const Stroke* stroke : strokes()) {
    const Error kept = judge(thesis_action(), stroke->record, stroke->carried).motion.whole;
    EXPECT_GT(judge(jumping, stroke->record, stroke->carried).motion.whole.eta, 5 * kept.eta) << stroke->record.name;
  }
}

// ---- Table 2.3, column by column

TEST(TableTwoThree, ModelShowsInTheForcesMoreThanInTheMotion) {
  for (const Stroke* stroke : strokes()) {
    const double in_motion = up_to_let_off(Path::force_to_motion, *stroke).model;
    for (const Path path : {Path::motion_to_force, Path::position_to_force, Path::acceleration_to_force}) {
      EXPECT_GT(up_to_let_off(path, *stroke).model, 2 * in_motion) << stroke->record.name;
      EXPECT_GT(up_to_release(path, *stroke).model, 10 * up_to_release(Path::force_to_motion, *stroke).model);
    }
  }
}

TEST(TableTwoThree, InitialConditionsMatterWhereSomethingIsIntegrated) {
  for (const Stroke* stroke : strokes()) {
    EXPECT_GT(up_to_let_off(Path::force_to_motion, *stroke).initial, 0.1);  // of a displacement of 3 mm, on average
    EXPECT_EQ(up_to_release(Path::motion_to_force, *stroke).initial, 0);
    EXPECT_EQ(up_to_release(Path::position_to_force, *stroke).initial, 0);
    // on the rail alone
    EXPECT_LT(up_to_let_off(Path::acceleration_to_force, *stroke).initial, 0.01);
    EXPECT_GT(up_to_release(Path::acceleration_to_force, *stroke).initial, 1);
  }
}

TEST(TableTwoThree, NoiseMattersWhereSomethingIsDifferentiatedTwice) {
  for (const Stroke* stroke : strokes()) {
    const double differentiated = up_to_let_off(Path::position_to_force, *stroke).noise;
    EXPECT_GT(differentiated, 1) << stroke->record.name;  // nothing of the force is left
    for (const Path path : {Path::force_to_motion, Path::motion_to_force, Path::acceleration_to_force})
      EXPECT_LT(50 * up_to_let_off(path, *stroke).noise, differentiated) << stroke->record.name;
  }
}

// ---- the section

TEST(SimpleModels, SectionDrawsItsPicture) {
  if (std::system("command -v gnuplot >/dev/null") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const test::TemporaryFolder folder;
  const Section section = simple_models_section({folder.path(), "pictures"});
  EXPECT_NE(section.text.find("(pictures/simple_models.svg)"), std::string::npos);
  const auto size = std::filesystem::file_size(folder / "simple_models.svg");
  EXPECT_GT(size, 10'000u);   // curves are in it
  EXPECT_LT(size, 150'000u);  // small enough for a document
}
