// What thesis 6.4.2 concludes from leaving the felts out, and what the felts themselves explain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "study/rigid_contact.hpp"
#include "study/without_felts.hpp"

namespace erard::study {
namespace {

const FeltlessComparison& piano() {
  static const FeltlessComparison comparison = compare_felts(kPiano);
  return comparison;
}
const FeltlessComparison& forte() {
  static const FeltlessComparison comparison = compare_felts(kForte);
  return comparison;
}

double gap(const Snapshot& row, const char* contact) {
  static const Model model = default_action().model;
  return -row.compression[static_cast<std::size_t>(find_contact(model, contact))];
}

TEST(WithoutFelts, ForceIsOffByFarMoreThanTheKey) {
  // "very little difference" against "a bad estimation": nearer to a factor of ten than to one, on a logarithmic scale
  for (const FeltlessComparison* c : {&piano(), &forte()})
    for (const FeltlessStroke& s : c->without)
      EXPECT_GT(s.error.force, std::sqrt(10) * s.error.key) << c->stroke.name << ", felts " << name_of(s.felts);
}

TEST(WithoutFelts, InPianoOnlyTheForceIsWorseThanTheThesisModelWithFelts) {
  // its 21 % of force error (6.4.1) is what the thesis accepts as a good simulation of its Figures 6.11 and 6.12
  for (const FeltlessStroke& s : piano().without) {
    EXPECT_LT(s.error.key, 0.21) << name_of(s.felts);
    EXPECT_GT(s.error.force, 2 * 0.21) << name_of(s.felts);
  }
}

TEST(WithoutFelts, DescentAloneTellsLess) {
  // what docs/validation.md says against the thesis: before the let-off the key, too, is off by more than a quarter
  for (const FeltlessComparison* c : {&piano(), &forte()})
    for (const Felts felts : {Felts::out, Felts::out_reset}) {
      EXPECT_GT(c->of(felts).descent.key, 0.25) << c->stroke.name;
      EXPECT_GT(c->of(felts).descent.force, c->of(felts).descent.key) << c->stroke.name;
    }
}

TEST(WithoutFelts, KnucklesLeatherIsTheLargestPartOfTheLead) {
  // one felt of fourteen; more than a third of the error goes when it stays
  for (const FeltlessComparison* c : {&piano(), &forte()})
    EXPECT_LT(c->of(Felts::knuckle_kept).error.key, 2.0 / 3 * c->of(Felts::out_reset).error.key) << c->stroke.name;
}

TEST(WithoutFelts, KeyOnARigidRailDoesNotSwing) {
  for (const FeltlessComparison* c : {&piano(), &forte()}) {
    const double release = c->stroke.release;
    // with its felt the key swings by more than the lasers of thesis 3.1 resolve, 50 um; without by less than they can see
    EXPECT_GT(swing_on_rail(c->full_by_force, release, key_position), 50e-6) << c->stroke.name;
    for (const FeltlessStroke& s : c->without)
      EXPECT_LT(swing_on_rail(s.by_force, release, key_position), 5e-6) << c->stroke.name << ", " << name_of(s.felts);
  }
}

TEST(WithoutFelts, OverlapOfTheRestIsPushedApart) {
  const PlayedStroke& stroke = piano().of(Felts::out).by_position;
  const auto overlap = [](const Snapshot& row) {
    return *std::max_element(row.compression.begin(), row.compression.end());
  };
  EXPECT_GT(overlap(stroke.row.front()), 1e-4);  // the felts' compression at rest, 0.13 to 0.19 mm
  EXPECT_LT(end_of_overlap(stroke), 5e-3);       // before the finger presses
  EXPECT_LT(overlap(stroke.at(5e-3)), 1e-6);
  // of 46.0 mm: the hammer's head moves several times as far as the felts at its foot gave
  EXPECT_LT(gap(stroke.at(5e-3), "HG"), 45e-3);
  EXPECT_LT(gap(stroke.at(5e-3), "JH"), 1e-6);  // the jack carries the hammer
}

TEST(WithoutFelts, SurfacesResetKeepTheRegulation) {
  const Snapshot& with = piano().full.at(5e-3);
  for (const Felts felts : {Felts::out_reset, Felts::knuckle_kept}) {
    const Snapshot& without = piano().of(felts).by_position.at(5e-3);
    // 0.05 mm: resolution of the lasers of thesis 3.1; the felts of the full action still creep by 0.01 mm
    EXPECT_NEAR(gap(without, "HG"), gap(with, "HG"), 5e-5) << name_of(felts);
    EXPECT_NEAR(gap(without, "JH"), gap(with, "JH"), 1e-5) << name_of(felts);
    EXPECT_NEAR(without.key_position, with.key_position, 1e-5) << name_of(felts);
  }
}

TEST(WithoutFelts, RemovedFeltsLeaveTheMassesOfTheFile) {
  ActionOptions options;
  options.felts = FeltModel::bodies;  // whose masses were taken from their carriers
  ActionFile removed = default_action(options);
  for (int c = 0; c < removed.model.contact_count; ++c)
    if (removed.model.contacts[static_cast<std::size_t>(c)].has_felt) remove_felt(removed.model, c);
  const Model rigid = action_without(Felts::out).model;  // loaded without felts: nothing was taken from the carriers
  for (std::size_t i = 0; i < static_cast<std::size_t>(rigid.body_count); ++i) {
    // rounding of one subtraction and one addition for each felt
    EXPECT_NEAR(removed.model.bodies[i].mass, rigid.bodies[i].mass, 1e-15);
    EXPECT_NEAR(removed.model.bodies[i].inertia, rigid.bodies[i].inertia, 1e-16);
    EXPECT_LT((removed.model.bodies[i].centre - rigid.bodies[i].centre).norm(), 1e-14);
  }
}

TEST(Replay, ErrorsAreThoseOfTheirDefinition) {
  // constant 2 against constant 3: half of the reference apart everywhere
  PlayedStroke two, three;
  for (int i = 0; i < 9; ++i) {
    Snapshot row;
    row.time = i * kStudyStep;
    row.force = 2;
    two.row.push_back(row);
    row.force = i < 5 ? 3 : 1e6;  // beyond the end: not looked at
    three.row.push_back(row);
  }
  EXPECT_DOUBLE_EQ(relative_error(two, three, 4 * kStudyStep, finger_force), 0.5);
  EXPECT_DOUBLE_EQ(largest_difference(two, three, 4 * kStudyStep, finger_force), 1);
  EXPECT_DOUBLE_EQ(spread(three, 0, 4.5 * kStudyStep, finger_force), 0);
}

}  // namespace
}  // namespace erard::study
