// The strokes of thesis 6.2 and 6.3: what must hold whatever the parameters of the action are, and what is printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "study/front_rail.hpp"
#include "study/strokes.hpp"
#include "support/program.hpp"

namespace erard::study {
namespace {

const DrivenStroke& piano() {
  static const DrivenStroke stroke = drive_both_ways(kPiano);
  return stroke;
}
const DrivenStroke& forte() {
  static const DrivenStroke stroke = drive_both_ways(kForte);
  return stroke;
}

double time_of(const DrivenStroke& stroke, EventKind kind) { return stroke.by_position.event(kind).time; }

PlayedStroke play_with_string(const StrokeCase& stroke, double restitution) {
  return play(action_with_rigid_string(restitution), default_keystroke(stroke.name), study_tick(DriveKind::piston),
              stroke.release);
}

TEST(Strokes, EventsComeInOrder) {
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    EXPECT_LT(time_of(*s, EventKind::jack_meets_let_off), time_of(*s, EventKind::escapement));
    EXPECT_LT(time_of(*s, EventKind::escapement), time_of(*s, EventKind::key_meets_front_rail));
    EXPECT_LT(time_of(*s, EventKind::escapement), time_of(*s, EventKind::hammer_meets_string));
    EXPECT_LT(time_of(*s, EventKind::key_meets_front_rail), time_of(*s, EventKind::hammer_checked));
    EXPECT_LT(time_of(*s, EventKind::hammer_meets_string), time_of(*s, EventKind::hammer_checked));
    EXPECT_LT(time_of(*s, EventKind::hammer_checked), s->stroke.release);
    EXPECT_LT(s->stroke.release, time_of(*s, EventKind::jack_returned));
  }
}

TEST(Strokes, HammerIsAtTheStringBeforeTheKeyIsOnTheRailInPianoOnly) {
  EXPECT_LT(time_of(piano(), EventKind::hammer_meets_string), time_of(piano(), EventKind::key_meets_front_rail));
  EXPECT_GT(time_of(forte(), EventKind::hammer_meets_string), time_of(forte(), EventKind::key_meets_front_rail));
}

TEST(Strokes, EscapementSpeedsAreThoseOfTable61) {
  // 2 %: above it the document would have to list them as contradicted; measured and simulated differ by 1 % in print
  EXPECT_NEAR(piano().by_position.event(EventKind::escapement).hammer_speed, 1.00, 0.02);
  EXPECT_NEAR(forte().by_position.event(EventKind::escapement).hammer_speed, 1.56, 0.02 * 1.56);
}

TEST(Strokes, ForceHasTheHumpAndTheFallOfTheLetOff) {
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    const LetOffPattern pattern = let_off_pattern(s->by_position);
    EXPECT_GT(pattern.hump, 0.1);           // [N] what the thesis's force sensor resolves, Table 3.2
    EXPECT_GT(pattern.fall, pattern.hump);  // "a small hump and a rather sharp decrease"
    // the minimum marks the rail: nearer than the 5 ms by which the thesis's own simulation misses it
    EXPECT_LT(std::abs(pattern.minimum_after_rail), 0.005);
  }
}

TEST(Strokes, RailOscillatesAsItsLinearisedFeltDoes) {
  // (6.1), (6.2) with nobody's hand on the key. 10 %: the amplitude, 0.05 to 0.1 mm of 0.2 to 0.3 mm, is not small, and
  // the spring of the caught hammer acts beside the felt
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    const bool is_piano = s == &piano();
    const RailOscillation seen =
        rail_oscillation(default_action(), s->by_position, is_piano ? 0.14 : 0.08, is_piano ? 0.20 : 0.12);
    const double expected = ringing_frequency(linear_rail(seen.mean_force).stiffness, kKeyMassAtRail);
    EXPECT_NEAR(seen.frequency, expected, 0.1 * expected) << s->stroke.name;
  }
}

TEST(Replay, ForceGivesTheMotionBack) {
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    // a tenth of what a force late by one internal step does: it shifts the key by its speed times 125 us
    double speed = 0;
    const auto& row = s->by_position.row;
    for (std::size_t i = 1; i < row.size(); ++i)
      speed = std::max(speed, (row[i].key_position - row[i - 1].key_position) / kStudyStep);
    const double check = time_of(*s, EventKind::hammer_checked);
    EXPECT_LT(largest_difference(s->by_position, s->by_force, check, key_position), 0.1 * speed * kStudyStep);
    // the wedge of the caught hammer may settle elsewhere; still less than the lasers of thesis 3.1 resolve
    EXPECT_LT(largest_difference(s->by_position, s->by_force, s->stroke.release, key_position), 50e-6);
  }
}

TEST(Replay, ForceLateByOneStepDoesNot) {
  const Keystroke force = force_of(forte().by_position);
  std::vector<double> times(force.times().begin(), force.times().end());
  for (double& time : times) time += kStudyStep;
  const Keystroke late(KeystrokeQuantity::force, times, {force.values().begin(), force.values().end()});
  PlayedStroke shifted = play(default_action(), late, study_tick(DriveKind::force), 0.08);
  // it starts one step later, at rest: put its rows at the times of the others
  shifted.row.insert(shifted.row.begin(), shifted.row.front());
  for (std::size_t i = 0; i < shifted.row.size(); ++i) shifted.row[i].time = forte().by_position.row[i].time;
  EXPECT_GT(largest_difference(forte().by_position, shifted, 0.07, key_position), 30e-6);
}

TEST(RigidString, InelasticLeavesNoReboundSpeed) {
  for (const StrokeCase& stroke : {kPiano, kForte}) {
    const Impact impact = impact_of(action_with_rigid_string(0), play_with_string(stroke, 0));
    EXPECT_GT(impact.before, 0.9);
    EXPECT_LT(impact.after, 1e-5 * impact.before);  // the sweeps stop at 1e-6 of the largest velocity
  }
}

TEST(RigidString, RestitutionReturnsItsShare) {
  for (const StrokeCase& stroke : {kPiano, kForte})
    for (const double e : {0.3, 0.656, 1.0})
      // Newton's law on the end velocity of one step: exact but for where the sweeps stop
      EXPECT_NEAR(impact_of(action_with_rigid_string(e), play_with_string(stroke, e)).share(), e, 1e-5) << stroke.name;
}

TEST(RigidString, NothingPassesThroughIt) {
  for (const double e : {0.0, 0.656, 1.0}) {
    const ActionFile action = action_with_rigid_string(e);
    const auto string = static_cast<std::size_t>(action.roles.string);
    double deepest = 0;
    for (const Snapshot& row : play_with_string(kForte, e).row) deepest = std::max(deepest, row.compression[string]);
    EXPECT_LT(deepest, 1e-6) << e;  // the step's own projection; an unstopped hammer would go 0.2 mm in one step
  }
}

TEST(RigidString, ForceBeforeTheBlowDoesNotKnowTheString) {
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    const PlayedStroke inelastic = play_with_string(s->stroke, 0);
    const double before = time_of(*s, EventKind::hammer_meets_string) - 2 * kStudyStep;
    // the same action up to there, but for the rounding of steps that have one row less
    EXPECT_LT(relative_error(s->by_position, inelastic, before, finger_force), 1e-3) << s->stroke.name;
  }
}

TEST(RigidString, InelasticHammerIsNotCaught) {
  for (const StrokeCase& stroke : {kPiano, kForte})
    EXPECT_EQ(play_with_string(stroke, 0).find(EventKind::hammer_checked), nullptr) << stroke.name;
}

TEST(RigidString, HarderReboundIsCaughtEarlier) {
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    const double share = impact_of(default_action(), s->by_position).share();
    const double as_felt = play_with_string(s->stroke, share).event(EventKind::hammer_checked).time;
    const double elastic = play_with_string(s->stroke, 1).event(EventKind::hammer_checked).time;
    EXPECT_LT(elastic, as_felt);
    // the same way back at the same speed, begun earlier by what the felt's blow lasts, less than 3 ms
    EXPECT_LT(as_felt, time_of(*s, EventKind::hammer_checked));
    EXPECT_GT(as_felt, time_of(*s, EventKind::hammer_checked) - 0.003);
  }
}

/// Rebound of a mass on a felt, integrated in steps of 0.1 us:  m d'' = -max(0, k d^r + b d^2 d')         (4.4)
double rebound_share(const Felt& felt, double mass, double speed) {
  constexpr double h = 1e-7;
  double depth = 0, rate = speed, force = 0;
  do {
    force = felt.stiffness * std::pow(depth, felt.exponent) + felt.damping * depth * depth * rate;
    rate -= h * std::max(force, 0.0) / mass;
    depth += h * rate;
  } while (force > 0 || rate > 0);
  return -rate / speed;
}

TEST(FeltString, GivesBackWhatItsLawSays) {
  const ActionFile action = default_action();
  const auto string = static_cast<std::size_t>(action.roles.string);
  const double radius = action.model.contacts[string].shape_a.centre.norm();
  const double mass = action.model.bodies[static_cast<std::size_t>(action.roles.hammer)].inertia / (radius * radius);
  for (const DrivenStroke* s : {&piano(), &forte()}) {
    const Impact impact = impact_of(action, s->by_position);
    // 3 %: gravity and spring of the lever during 1 to 2 ms, and ten to fifteen steps for the blow
    const double expected = rebound_share(action.model.contacts[string].felt, mass, impact.before);
    EXPECT_NEAR(impact.share(), expected, 0.03 * expected) << s->stroke.name;
  }
}

TEST(StrokesSection, SaysWhatItDrawsAndTheDrawingsAreSmall) {
  const test::TemporaryFolder folder;
  const Section section = strokes_section({folder.path(), "pictures"});
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    EXPECT_NE(section.text.find("(pictures/" + name + ")"), std::string::npos) << name;
    EXPECT_LT(entry.file_size(), 160'000u) << name;
    ++pictures;
  }
  EXPECT_EQ(pictures, 7);
  const std::string sheet = test::read_text(folder / "strokes_poses_piano.svg");
  const auto count = [&](const std::string& what) {
    int n = 0;
    for (std::size_t at = sheet.find(what); at != std::string::npos; at = sheet.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("<svg "), 7);  // the sheet and six poses
  EXPECT_EQ(count("</svg>"), 7);
  EXPECT_EQ(count("<style>"), 1);
}

}  // namespace
}  // namespace erard::study
