// Events of a keystroke: their order, their names, their strikes.
#include <gtest/gtest.h>

#include "support/strokes.hpp"

namespace erard {
namespace {

std::vector<std::string> names(const test::Stroke& stroke, int strike) {
  std::vector<std::string> list;
  for (const Event& event : stroke.result.events)
    if (event.strike == strike) list.emplace_back(name_of(event.kind));
  return list;
}

TEST(Events, APianoStrokeHasEachOnceInTheOrderOfTheThesis) {
  // thesis 6.4.1: (b) let-off, escapement, (d) string before (c) rail in a piano stroke here, (e) check, (f) return
  const auto stroke = test::play(test::grand_action(), test::keystroke("piano"));
  const std::vector<std::string> expected{"jack_meets_let_off",   "escapement",     "hammer_meets_string",
                                          "key_meets_front_rail", "hammer_checked", "jack_returned",
                                          "repetition_ready"};
  EXPECT_EQ(names(stroke, 1), expected);
}

TEST(Events, ARepetitionHasTwoStrikes) {
  const auto stroke = test::play(test::grand_action(), test::keystroke("repetition"));
  EXPECT_NE(stroke.find(EventKind::hammer_meets_string, 1), nullptr);
  EXPECT_EQ(stroke.find(EventKind::hammer_meets_string, 1)->strike, 2);
  EXPECT_EQ(names(stroke, 2).front(), "jack_meets_let_off");
}

TEST(Events, SpeedIsThatOfTheStepBeforeTheImpact) {
  const auto stroke = test::play(test::grand_action(), test::keystroke("forte"));
  const Event& hit = *stroke.find(EventKind::hammer_meets_string);
  double last = 0;
  for (const Snapshot& row : stroke.row)
    if (row.time < hit.time) last = 0.1312 * std::abs(row.rate[4]);  // design: radius of the head's centre 0.1312 m
  EXPECT_NEAR(hit.hammer_speed, last, 0.01 * last);  // rows are up to four steps earlier; the hammer flies freely
}

TEST(Events, WithoutStringTheEscapementIsStillTold) {
  ActionOptions options;
  options.without = {"HG"};
  const auto stroke = test::play(test::grand_action(options), test::keystroke("piano"));
  EXPECT_EQ(stroke.find(EventKind::hammer_meets_string), nullptr);
  ASSERT_NE(stroke.find(EventKind::escapement), nullptr);
  EXPECT_NEAR(stroke.find(EventKind::escapement)->time, 0.11275, 1e-3);
}

TEST(Events, DoNotDependOnTheClock) {
  const Keystroke forte = test::keystroke("forte");
  std::vector<double> times(forte.times().begin(), forte.times().end()),
      values(forte.values().begin(), forte.values().end());
  for (double& t : times) t -= 5;
  const auto early = test::play(test::grand_action(), Keystroke(KeystrokeQuantity::position, times, values));
  const auto stroke = test::play(test::grand_action(), forte);
  ASSERT_EQ(early.result.events.size(), stroke.result.events.size());
  for (std::size_t i = 0; i < stroke.result.events.size(); ++i) {
    EXPECT_EQ(early.result.events[i].kind, stroke.result.events[i].kind);
    EXPECT_NEAR(early.result.events[i].time + 5, stroke.result.events[i].time, 1.3e-4);  // one internal step
  }
}

TEST(Events, AHammerThrownBeforeTheLetOffHasEscaped) {
  // 3 cm in 0.1 s: the hammer leaves the jack at 3.4 m/s before the jack meets its button
  const Keystroke blow(KeystrokeQuantity::position, {0, 0.1, 0.2}, {0, 0.03, 0});
  const auto stroke = test::play(test::grand_action(), blow);
  ASSERT_NE(stroke.find(EventKind::escapement), nullptr);
  EXPECT_LT(stroke.find(EventKind::escapement)->time, stroke.find(EventKind::jack_meets_let_off)->time);
}

TEST(Events, RestHasNone) {
  const Keystroke rest(KeystrokeQuantity::position, {0, 0.5}, {0, 0});
  EXPECT_TRUE(test::play(test::grand_action(), rest).result.events.empty());
}

TEST(Events, NineRecordedStrikesAreNineStrikes) {
  const auto stroke = test::play(test::grand_action(), test::keystroke("recorded_repeated"));
  int hits = 0;
  for (const Event& event : stroke.result.events) hits += event.kind == EventKind::hammer_meets_string;
  EXPECT_GE(hits, 9);
}

}  // namespace
}  // namespace erard
