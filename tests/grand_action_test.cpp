// The grand action works as a grand action: 2 kHz, default settings.
// Targets: the regulation of thesis Appendix A and the figures of docs/action.md, reached there by an independent
// simulation of the same parameters in steps of 2.5 us.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "support/strokes.hpp"

namespace erard {
namespace {

using test::Stroke;

/// Position of the piston along straight lines through (time, position).
Keystroke lines(const std::vector<std::pair<double, double>>& points) {
  // sampled at 2 kHz: the spline between samples follows the lines but for one sample at each corner
  std::vector<double> times, values;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const auto [t0, y0] = points[i];
    const auto [t1, y1] = points[i + 1];
    const long n = std::lround((t1 - t0) / 5e-4);
    for (long k = 0; k < n; ++k) {
      times.push_back(t0 + 5e-4 * static_cast<double>(k));
      values.push_back(y0 + (y1 - y0) * static_cast<double>(k) / static_cast<double>(n));
    }
  }
  times.push_back(points.back().first);
  values.push_back(points.back().second);
  return {KeystrokeQuantity::position, times, values};
}

int contact(const char* name) {
  static const ActionFile action = test::grand_action();
  return find_contact(action.model, name);
}

double gap(const Snapshot& row, const char* name) { return -row.compression[static_cast<std::size_t>(contact(name))]; }
double normal(const Snapshot& row, const char* name) { return row.normal[static_cast<std::size_t>(contact(name))]; }

const Snapshot& row_at(const Stroke& stroke, double time) {
  return stroke.row[static_cast<std::size_t>(std::lround((time - stroke.row[0].time) / 5e-4))];
}

const Stroke& piano() {
  static const Stroke stroke = test::play(test::grand_action(), test::keystroke("piano"));
  return stroke;
}
const Stroke& forte() {
  static const Stroke stroke = test::play(test::grand_action(), test::keystroke("forte"));
  return stroke;
}
const Stroke& repetition() {
  static const Stroke stroke = test::play(test::grand_action(), test::keystroke("repetition"));
  return stroke;
}

TEST(GrandAction, RestsWhereItsFileSays) {
  const ActionFile action = test::grand_action();
  const Stroke stroke = test::play(action, lines({{0, 0}, {1, 0}}), test::default_tick(DriveKind::none), 2.0);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(stroke.row.back().angle[i], stroke.row.front().angle[i],
                2e-3);  // well inside the 5 to 40 mrad of thesis Table 3.3
    EXPECT_LT(std::abs(stroke.row.back().rate[i]), 1e-9);
  }
  EXPECT_GT(normal(stroke.row.back(), "LH"), 0.3);  // the hammer lies on the lever, not on the jack
  EXPECT_EQ(normal(stroke.row.back(), "JH"), 0);
}

TEST(GrandAction, BlowIs46Millimetres) { EXPECT_NEAR(gap(piano().row.front(), "HG"), 46.0e-3, 1e-4); }

TEST(GrandAction, JackIsATenthOfAMillimetreBelowTheKnuckle) {
  EXPECT_NEAR(gap(piano().row.front(), "JH"), 0.122e-3, 5e-6);  // 0.1 to 0.3 mm by regulation
}

TEST(GrandAction, LetOffComesAtItsKeyAngle) {
  for (const Stroke* stroke : {&piano(), &forte()})
    // 0.035 rad, reached 0.0349 to 0.0353 (8.58 and 8.65 mm); a period of 0.5 ms is 0.0006 rad in forte
    EXPECT_NEAR(stroke->find(EventKind::jack_meets_let_off)->key_position / 0.245, 0.0351, 6e-4);
}

TEST(GrandAction, KeyMeetsTheFrontRailAt98Millimetres) {
  for (const Stroke* stroke : {&piano(), &forte()}) {
    const double angle = stroke->find(EventKind::key_meets_front_rail)->key_position / 0.245;
    EXPECT_GT(angle, 0.0397 - 2e-4);  // Table 2.2: 0.0397, Figure 4.23 and 6.4.1: 0.040
    EXPECT_LT(angle, 0.0400 + 2e-4);
  }
}

TEST(GrandAction, EscapesInASlowPressCloseToTheString) {
  const Stroke press = test::play(test::grand_action(), lines({{0, 0}, {0.88, 10.56e-3}, {1.2, 10.56e-3}}));
  double closest = 1, peak = 0;
  for (const Snapshot& row : press.row) {
    closest = std::min(closest, gap(row, "HG"));
    peak = std::max(peak, normal(row, "JG") > 0 && row.key_position < 9.7e-3 ? row.force : 0.0);
  }
  EXPECT_NEAR(closest, 1.9e-3, 0.2e-3);  // regulation: at most 3 mm, ideally 1.5; the reference reaches 1.9
  EXPECT_EQ(press.find(EventKind::hammer_meets_string), nullptr);
  EXPECT_LT(peak, 3.5);  // it does not block: 3.1 N
}

TEST(GrandAction, JackReturnsInASlowReleaseBelowTheLetOff) {
  const Stroke press = test::play(test::grand_action(), lines({{0, 0}, {0.88, 10.56e-3}, {1.0, 10.56e-3}, {1.88, 0}}));
  ASSERT_NE(press.find(EventKind::jack_returned), nullptr);
  EXPECT_NEAR(press.find(EventKind::jack_returned)->key_position, 8.5e-3, 0.2e-3);
  EXPECT_NE(press.find(EventKind::escapement), nullptr);
}

TEST(GrandAction, HammerMeetsTheStringOnceWithTheSpeedOfTheReference) {
  EXPECT_NEAR(piano().find(EventKind::hammer_meets_string)->hammer_speed, 0.973, 0.03 * 0.973);
  EXPECT_NEAR(forte().find(EventKind::hammer_meets_string)->hammer_speed, 1.534, 0.03 * 1.534);
  EXPECT_NEAR(piano().find(EventKind::hammer_meets_string)->time, 0.11524, 1e-3);
  EXPECT_NEAR(forte().find(EventKind::hammer_meets_string)->time, 0.07302, 1e-3);
  EXPECT_EQ(piano().find(EventKind::hammer_meets_string, 1), nullptr);
  EXPECT_EQ(forte().find(EventKind::hammer_meets_string, 1), nullptr);
}

TEST(GrandAction, EscapementSpeedsAreThoseOfTable61) {
  EXPECT_NEAR(piano().find(EventKind::escapement)->hammer_speed, 1.00, 0.03);
  EXPECT_NEAR(forte().find(EventKind::escapement)->hammer_speed, 1.56, 0.03 * 1.56);
}

TEST(GrandAction, BackcheckHoldsTheHammer) {
  // 13.9 and 14.4 mm in the reference, about 15 mm by regulation; where it comes to rest is set by friction
  EXPECT_NEAR(gap(row_at(piano(), 0.20), "HG"), 13.9e-3, 0.5e-3);
  EXPECT_NEAR(gap(row_at(forte(), 0.14), "HG"), 14.4e-3, 0.5e-3);
  EXPECT_NE(piano().find(EventKind::hammer_checked), nullptr);
  EXPECT_NE(forte().find(EventKind::hammer_checked), nullptr);
}

TEST(GrandAction, JackReturnsWhenTheKeyRises) {
  EXPECT_NEAR(piano().find(EventKind::jack_returned)->time, 0.2579, 5e-3);
  EXPECT_NEAR(forte().find(EventKind::jack_returned)->time, 0.1787, 5e-3);
  EXPECT_NE(piano().find(EventKind::repetition_ready), nullptr);
  EXPECT_LE(piano().find(EventKind::repetition_ready)->time, piano().find(EventKind::jack_returned)->time + 5e-3);
}

TEST(GrandAction, StrikesAgainFromAHalfReleasedKey) {
  const Event* second = repetition().find(EventKind::hammer_meets_string, 1);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->strike, 2);
  EXPECT_NEAR(second->time, 0.32762, 2e-3);
  EXPECT_NEAR(second->hammer_speed, 1.21, 0.03 * 1.21);
  ASSERT_NE(repetition().find(EventKind::hammer_checked, 1), nullptr);
  const double half = 4.94e-3;  // where the key turns between the strikes
  double least = 1;
  for (const Snapshot& row : repetition().row)
    if (row.time > 0.15 && row.time < 0.33) least = std::min(least, row.key_position);
  EXPECT_NEAR(least, half, 0.1e-3);
}

TEST(GrandAction, TouchWeightIsThatOfItsParameters) {
  // 6 mm/s to Y = 7.8 mm and back, mean force over y = 1.5 to 7 mm
  const Stroke stroke = test::play(test::grand_action(), lines({{0, 0}, {1.3, 7.8e-3}, {2.6, 0}}));
  double down = 0, up = 0;
  int downs = 0, ups = 0;
  for (const Snapshot& row : stroke.row) {
    if (row.key_position < 1.5e-3 || row.key_position > 7e-3) continue;
    (row.time < 1.3 ? down : up) += row.force;
    ++(row.time < 1.3 ? downs : ups);
  }
  EXPECT_NEAR(down / downs, 0.54, 0.054);
  EXPECT_NEAR(up / ups, 0.34, 0.034);
  std::printf("touch weight: down %.3f N, up %.3f N\n", down / downs, up / ups);
}

TEST(GrandAction, DamperStartsWhenTheHammerIsHalfWay) {
  ActionOptions options;
  options.damper = true;
  const Stroke press = test::play(test::grand_action(options), lines({{0, 0}, {1.5, 6e-3}}));
  const Snapshot* first = nullptr;
  for (const Snapshot& row : press.row)
    if (first == nullptr && normal(row, "KD") > 1e-3) first = &row;
  ASSERT_NE(first, nullptr);
  EXPECT_NEAR(gap(*first, "HG"), 23.2e-3, 0.5e-3);  // regulation 23.5 mm, reached 23.2 mm
  EXPECT_NEAR(first->key_position, 4.4e-3, 0.1e-3);
}

// ---- against the independent simulation

double eta(const Stroke& stroke, const char* name, double end) {
  const auto reference = read_force_curve(std::filesystem::path(ERARD_REFERENCE_DIR) / (std::string(name) + ".csv"));
  return relative_error(reference, stroke.force(), end);
}

TEST(Reference, ForceAgreesAtTwoKilohertz) {
  for (const auto& [name, stroke, release, check] :
       {std::tuple{"piano", &piano(), 0.220, 0.139}, {"forte", &forte(), 0.142, 0.088}}) {
    EXPECT_LT(eta(*stroke, name, release), 0.01) << name;  // 5 % is asked; 0.2 to 0.4 % is where it stands
    EXPECT_LT(eta(*stroke, name, check), 0.01) << name;
    std::printf("%s, 2 kHz: eta %.2f %% to the release, %.2f %% to the check\n", name,
                100 * eta(*stroke, name, release), 100 * eta(*stroke, name, check));
  }
}

TEST(Reference, ForceAgreesAtTwentyKilohertz) {
  TickSettings fine = test::default_tick();
  fine.set_rate(20000, 1);
  for (const auto& [name, release, check] : {std::tuple{"piano", 0.220, 0.139}, {"forte", 0.142, 0.088}}) {
    const Stroke stroke = test::play(test::grand_action(), test::keystroke(name), fine);
    EXPECT_LT(eta(stroke, name, release), 0.02) << name;
    std::printf("%s, 20 kHz: eta %.2f %% to the release, %.2f %% to the check\n", name,
                100 * eta(stroke, name, release), 100 * eta(stroke, name, check));
  }
}

/// Absolute angles of the independent simulation, a row every 0.5 ms.
std::vector<std::array<double, 6>> read_angles(const char* name) {
  std::ifstream file(std::filesystem::path(ERARD_REFERENCE_DIR) / (std::string(name) + ".csv"));
  std::vector<std::array<double, 6>> rows;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    for (int i = 0; i < 4; ++i) std::getline(cells, cell, ',');
    for (double& angle : rows.emplace_back()) {
      std::getline(cells, cell, ',');
      angle = std::strtod(cell.c_str(), nullptr);
    }
  }
  return rows;
}

TEST(Reference, AnglesAgreeUpToTheStringImpact) {
  for (const auto& [name, stroke] : {std::pair{"piano", &piano()}, {"forte", &forte()}}) {
    const double impact = stroke->find(EventKind::hammer_meets_string)->time;
    const auto reference = read_angles(name);
    double worst = 0;
    for (std::size_t i = 0; i < stroke->row.size() && stroke->row[i].time <= impact; ++i)
      for (std::size_t b = 0; b < 6; ++b) worst = std::max(worst, std::abs(stroke->row[i].angle[b] - reference[i][b]));
    EXPECT_LT(worst, 3e-3) << name;
    std::printf("%s: angles within %.2f mrad\n", name, 1e3 * worst);
  }
}

TEST(Reference, FeltMassHardlyMatters) {
  // Table 6.3: half to eleven times the mass moves the force by less than 1.6 %; the moving mass alone, totals held.
  // 0: felts without mass, the default
  for (const auto& [name, stroke, release] : {std::tuple{"piano", &piano(), 0.220}, {"forte", &forte(), 0.142}})
    for (const bool keep_totals : {true, false})
      for (const double factor : {0.5, 1.0, 2.0, 5.0, 11.0}) {
        ActionOptions options;
        options.felts = FeltModel::bodies;
        options.keep_totals = keep_totals;
        for (const Parameter& parameter : test::grand_action().parameters)
          if (parameter.name.starts_with("m_f")) options.settings.push_back({parameter.name, factor * parameter.value});
        const Stroke heavy = test::play(test::grand_action(options), test::keystroke(name));
        const double moved = relative_error(stroke->force(), heavy.force(), release);
        if (keep_totals) {
          EXPECT_LT(moved, 0.016) << name << " x " << factor;
        }
        std::printf("%s, felt masses x %.1f, totals %s, against none: force moves by %.2f %%\n", name, factor,
                    keep_totals ? "held" : "not held", 100 * moved);
      }
}

// ---- laws on the whole action

TEST(Contacts, ClosedContactsDoNotPenetrate) {
  double closed = 0, closing = 0;
  for (const auto& [name, damper] : {std::pair{"piano", false},
                                     {"forte", false},
                                     {"repetition", false},
                                     {"recorded_fast", false},
                                     {"recorded_fast_free_release", false},
                                     {"recorded_medium", false},
                                     {"recorded_repeated", false},
                                     {"forte", true},
                                     {"recorded_fast", true}}) {
    ActionOptions options;
    options.damper = damper;
    const ActionFile action = test::grand_action(options);
    const Mechanism mechanism = build_mechanism(action.model);
    const Keystroke keystroke = test::keystroke(name);
    const TickSettings settings = test::default_tick();
    State state = rest_state(mechanism, settings.scheme.time_step);
    Workspace work;
    std::array<bool, kMaxContacts> was_closed{};
    const auto measure = [&](const State& s, const StepReport&, double) noexcept {
      Frames frames;
      ContactFrames contacts;
      place_bodies(mechanism.model, s.x, frames);
      locate_contacts(mechanism, s.x, frames, contacts);
      for (int c = 0; c < mechanism.contact_count(); ++c) {
        if (!action.model.contacts[static_cast<std::size_t>(c)].is_active) continue;
        const auto at = static_cast<std::size_t>(c);
        double& worst = was_closed[at] ? closed : closing;
        // with the compression of its felt, which those with mass have in their gap
        const double compression = mechanism.felt_coordinate[at] < 0 ? s.compression[c] : 0.0;
        worst = std::max(worst, -contacts[at].gap - compression);
        was_closed[at] = s.impulse[mechanism.normal_row[c]] > 0;
      }
    };
    const long periods = std::lround((keystroke.end() - keystroke.start()) / settings.period);
    state.time = keystroke.start();
    for (long i = 0; i < periods; ++i) tick(mechanism, settings, KeystrokeInput{&keystroke}, state, work, measure);
  }
  EXPECT_LT(closed, 1e-6);
  EXPECT_LT(closing, 5e-6);
  std::printf("penetration: closed %.1e m, at the closing step %.1e m\n", closed, closing);
}

TEST(Energy, OfTheReleasedActionNeverGrows) {
  // the action is left alone at several instants of a forte stroke and of its return
  const ActionFile action = test::grand_action();
  const Mechanism mechanism = build_mechanism(action.model);
  const Keystroke keystroke = test::keystroke("forte");
  TickSettings settings = test::default_tick();
  for (const double release : {0.03, 0.06, 0.07, 0.0735, 0.09, 0.16, 0.2, 0.28}) {
    settings.drive = DriveKind::piston;
    State state = rest_state(mechanism, settings.scheme.time_step);
    Workspace work;
    const auto ignore = [](const State&, const StepReport&, double) noexcept {};
    while (state.time < release - 1e-9) tick(mechanism, settings, KeystrokeInput{&keystroke}, state, work, ignore);
    settings.drive = DriveKind::none;
    std::vector<double> energy{measure_energy(mechanism, state).total()};
    for (int i = 0; i < 1000; ++i)
      tick(mechanism, settings, KeystrokeInput{&keystroke}, state, work,
           [&](const State& s, const StepReport&, double) noexcept {
             energy.push_back(measure_energy(mechanism, s).total());
           });
    double growth = 0, above = 0;
    const std::size_t window = 80;  // internal steps of 0.125 ms in 10 ms
    for (std::size_t i = 0; i < energy.size(); ++i) {
      above = std::max(above, energy[i] - energy[0]);
      for (std::size_t j = i + 1; j < std::min(i + window, energy.size()); ++j)
        growth = std::max(growth, energy[j] - energy[i]);
    }
    EXPECT_LE(above, 1e-9) << "released at " << release;  // rounding and linearised gaps; the motion holds 1e-2 J
    EXPECT_LE(growth, 1e-6) << "released at " << release;
    std::printf("released at %.4f s: energy grows by %.1e J within 10 ms, %.1e J above the start\n", release, growth,
                above);
  }
}

TEST(Determinism, ARunRestartedInTheMiddleGivesTheSameBits) {
  const ActionFile action = test::grand_action();
  const Mechanism mechanism = build_mechanism(action.model);
  const Keystroke keystroke = test::keystroke("forte");
  const TickSettings settings = test::default_tick();
  const auto ignore = [](const State&, const StepReport&, double) noexcept {};
  const auto go_on = [&](State& state, int periods) {
    Workspace work;
    double force = 0;
    for (int i = 0; i < periods; ++i)
      force = tick(mechanism, settings, KeystrokeInput{&keystroke}, state, work, ignore).force;
    return force;
  };
  State whole = rest_state(mechanism, settings.scheme.time_step);
  const double force = go_on(whole, 200);
  State half = rest_state(mechanism, settings.scheme.time_step);
  go_on(half, 147);  // in the air, just after the string
  State saved = half;
  EXPECT_EQ(go_on(saved, 53), force);
  EXPECT_EQ(saved.x, whole.x);
  EXPECT_EQ(saved.v, whole.v);
  EXPECT_EQ(saved.impulse, whole.impulse);
}

/// One column of a run as a keystroke: the key's position or the finger's force.
Keystroke column(const Stroke& stroke, double Snapshot::*value) {
  std::vector<double> times, values;
  for (const Snapshot& row : stroke.row) {
    times.push_back(row.time);
    values.push_back(row.*value);
  }
  const bool is_force = value == &Snapshot::force;
  return {is_force ? KeystrokeQuantity::force : KeystrokeQuantity::position, times, values};
}

TEST(Drives, KeyDriveByThePistonRunsOwnKeyGivesItsForce) {
  // the key's motion of the piston run, replayed as a prescribed motion: the same mechanics seen from the other side
  const auto error = [](double rate) {
    TickSettings fine = test::default_tick();
    fine.set_rate(rate, 1);
    const Stroke piston = test::play(test::grand_action(), test::keystroke("piano"), fine, 0.138);
    fine.drive = DriveKind::key;
    const Stroke key = test::play(test::grand_action(), column(piston, &Snapshot::key_position), fine);
    return relative_error(piston.force(), key.force(), 0.138);
  };
  // y differentiated twice shows every impact of the action, and the force is the mean over the last step: first order
  const double coarse = error(10000), fine = error(40000);
  EXPECT_LT(fine, 0.01);
  EXPECT_LT(fine, coarse / 2);
}

TEST(Drives, ForceDriveByThePistonRunsOwnForceGivesItsKeyPosition) {
  TickSettings fine = test::default_tick();
  fine.set_rate(20000, 1);
  const Stroke piston = test::play(test::grand_action(), test::keystroke("piano"), fine, 0.110);
  fine.drive = DriveKind::force;
  const Stroke force = test::play(test::grand_action(), column(piston, &Snapshot::force), fine);
  for (std::size_t i = 0; i < force.row.size(); ++i)
    EXPECT_NEAR(force.row[i].key_position, piston.row[i].key_position, 2e-5);  // force-driven runs drift (thesis 6.4.2)
}

TEST(Drives, FingerNeverPulls) {
  for (const Stroke* stroke : {&piano(), &forte(), &repetition()})
    for (const Snapshot& row : stroke->row) EXPECT_GE(row.force, 0);
}

}  // namespace
}  // namespace erard
