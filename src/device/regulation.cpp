#include "erard/device/regulation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace erard {
namespace {

constexpr double kMillimetre = 1e3;   // [mm/m]
constexpr double kGram = 1e3 / 9.81;  // weight of a touch [g/N]
constexpr double kRate = 2000;        // of the slow presses [Hz]

// touch weight as the reference measured it
constexpr double kTouchSpeed = 0.006, kTouchDepth = 0.0078;  // [m/s], [m]
constexpr double kTouchFrom = 0.0015, kTouchTo = 0.007;      // mean force between these key positions [m]

// the press that lets the hammer off; deep enough to lie on the front rail
constexpr double kPressSpeed = 0.012, kPressDepth = 0.0108, kPressHold = 0.3;  // [m/s], [m], [s]

constexpr double kCheckWindow = 0.06;  // the hammer has come to rest in the backcheck that long after [s]

/// A piston position that goes straight through these points. Dense samples: the spline then leaves the lines only
/// within some milliseconds of a corner.
Keystroke straight_lines(const std::vector<std::pair<double, double>>& corners) {
  constexpr double kSpacing = 0.005;  // [s]
  std::vector<double> times{corners.front().first}, values{corners.front().second};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const auto [t0, y0] = corners[i - 1];
    const auto [t1, y1] = corners[i];
    const int parts = std::max(1, static_cast<int>(std::ceil((t1 - t0) / kSpacing)));
    for (int k = 1; k <= parts; ++k) {
      times.push_back(t0 + (t1 - t0) * k / parts);
      values.push_back(y0 + (y1 - y0) * k / parts);
    }
  }
  return {KeystrokeQuantity::position, times, values};
}

struct SlowPress {
  std::vector<Snapshot> rows;
  RunResult result;
};

std::optional<SlowPress> press(const ActionFile& action, const Keystroke& keystroke) {
  SlowPress press;
  RunSettings settings;
  settings.tick.set_rate(kRate, 1);
  settings.duration = keystroke.end();
  settings.on_row = [&press](const Snapshot& row) { press.rows.push_back(row); };
  press.result = run(action, keystroke, settings);
  if (!press.result.is_finite) return std::nullopt;
  return press;
}

const Event* find_event(const std::vector<Event>& events, EventKind kind) {
  const auto found = std::find_if(events.begin(), events.end(), [kind](const Event& e) { return e.kind == kind; });
  return found == events.end() ? nullptr : &*found;
}

/// Open distance of a contact [mm].
double distance_mm(const Snapshot& row, int contact) {
  return -kMillimetre * row.compression[static_cast<std::size_t>(contact)];
}

void add_touch_weight(const ActionFile& action, std::vector<Measure>& measures) {
  const double turn = kTouchDepth / kTouchSpeed;
  Measure down{"touch weight down",
               "N",
               {},
               0.45,
               0.55,
               "46 to 56 g; Appendix A: about 50 g",
               "mean force, piston at 6 mm/s, y = 1.5 to 7 mm, damper off",
               kGram};
  Measure up{"touch weight up",          "N",  {}, 0.20, 0.30, "20 to 30 g; Appendix A: about 25 g",
             "the same on the way back", kGram};
  Measure friction{
      "friction of the touch",          "N",  {}, 0.08, 0.17, "8 to 17 g: 10-11 g treble, 15 g bass, +-2 g",
      "half the difference of the two", kGram};
  if (const auto slow = press(action, straight_lines({{0, 0}, {turn, kTouchDepth}, {2 * turn, 0}}))) {
    double sum[2] = {0, 0};
    int count[2] = {0, 0};
    for (const Snapshot& row : slow->rows) {
      if (row.key_position < kTouchFrom || row.key_position > kTouchTo) continue;
      sum[row.time > turn] += row.force;
      ++count[row.time > turn];
    }
    if (count[0] > 0) down.values = {sum[0] / count[0]};
    if (count[1] > 0) up.values = {sum[1] / count[1]};
    if (count[0] > 0 && count[1] > 0) friction.values = {0.5 * (down.values[0] - up.values[0])};
  }
  measures.insert(measures.end(), {down, up, friction});
}

void add_let_off(const ActionFile& action, std::vector<Measure>& measures) {
  const ActionRoles& roles = action.roles;
  const double end = kPressDepth / kPressSpeed;
  const auto slow = press(action, straight_lines({{0, 0}, {end, kPressDepth}, {end + kPressHold, kPressDepth}}));
  const std::vector<Event> none;
  const std::vector<Event>& events = slow ? slow->result.events : none;
  const Event* rail = find_event(events, EventKind::key_meets_front_rail);
  const Event* impact = find_event(events, EventKind::hammer_meets_string);
  std::optional<Snapshot> highest;  // of the hammer
  if (slow && roles.string >= 0)
    highest = *std::min_element(slow->rows.begin(), slow->rows.end(), [&](const Snapshot& a, const Snapshot& b) {
      return distance_mm(a, roles.string) < distance_mm(b, roles.string);
    });
  if (roles.string >= 0) {
    Measure blow{"blow distance", "mm", {}, 45, 47, "Appendix A", "hammer to string at rest"};
    Measure let_off{"let-off",
                    "mm",
                    {},
                    1,
                    3,
                    "Askenfelt & Jansson; Appendix A: 1.5 mm or less",
                    "nearest to the string in a press of 12 mm/s"};
    Measure drop{"drop", "mm", {}, NAN, NAN, "", "how far the hammer falls after let-off, key held down"};
    if (slow) {
      blow.values = {distance_mm(slow->rows.front(), roles.string)};
      let_off.values = {impact != nullptr ? 0.0 : distance_mm(*highest, roles.string)};
      drop.values = {distance_mm(slow->rows.back(), roles.string) - let_off.values[0]};
    }
    measures.insert(measures.end(), {blow, let_off, drop});
  }
  if (roles.escapement >= 0) {
    Measure gap{"jack below the knuckle",
                "mm",
                {},
                0.1,
                0.3,
                "Appendix A",
                "gap of the jack's top at rest, the lever carrying the hammer"};
    if (slow) gap.values = {distance_mm(slow->rows.front(), roles.escapement)};
    measures.push_back(gap);
  }
  if (roles.front_rail >= 0) {
    Measure dip{"key dip",
                "mm",
                {},
                9.5,
                10.5,
                "Appendix A",
                "key down to the first force of the front rail punching, 12 mm/s"};
    Measure aftertouch{
        "aftertouch", "mm", {}, NAN, NAN, "", "key travel from the hammer's highest point to the punching, 12 mm/s"};
    if (rail != nullptr) dip.values = {kMillimetre * rail->key_position};
    if (rail != nullptr && highest) aftertouch.values = {kMillimetre * (rail->key_position - highest->key_position)};
    measures.insert(measures.end(), {dip, aftertouch});
  }
}

/// First event of that kind after `time`, of the same strike.
const Event* next_of(const std::vector<Event>& events, EventKind kind, const Event& after) {
  const auto found = std::find_if(events.begin(), events.end(), [&](const Event& e) {
    return e.kind == kind && e.strike == after.strike && e.time >= after.time;
  });
  return found == events.end() ? nullptr : &*found;
}

/// Largest distance from the string while the backcheck holds the hammer.
std::optional<double> check_distance(const ActionRoles& roles, const ReportRows& rows, const Event& check) {
  std::optional<double> deepest;
  const std::size_t end = rows.row_at(check.time + kCheckWindow);
  for (std::size_t i = rows.row_at(check.time); i <= end; ++i) {
    const Snapshot row = rows.snapshot(i);
    if (row.normal[static_cast<std::size_t>(roles.backcheck)] <= 0) continue;
    deepest = std::max(deepest.value_or(0), distance_mm(row, roles.string));
  }
  return deepest;
}

/// Where the hammer is when the key takes the damper along.
Measure damper_lift(const ActionRoles& roles, const ReportRows& rows, int contact) {
  Measure lift{"damper lifts, hammer to string",
               "mm",
               {},
               21,
               26,
               "Appendix A: half-way, 23.5 mm; +-2.5 mm taken",
               "distance at the first force of the key on the damper's lever"};
  for (std::size_t i = 0; i < rows.count() && lift.values.empty(); ++i) {
    const Snapshot row = rows.snapshot(i);
    if (row.normal[static_cast<std::size_t>(contact)] > 0) lift.values = {distance_mm(row, roles.string)};
  }
  return lift;
}

}  // namespace

std::vector<Measure> measure_action(const ActionFile& action) {
  std::vector<Measure> measures;
  if (action.model.finger.body == kGround || action.roles.string < 0) return measures;
  add_touch_weight(action, measures);
  add_let_off(action, measures);
  return measures;
}

std::vector<Measure> measure_stroke(const ActionFile& action, const ReportRows& rows,
                                    const std::vector<Event>& events) {
  const ActionRoles& roles = action.roles;
  if (roles.string < 0 || rows.count() == 0) return {};
  Measure speed{"hammer speed at the string",   "m/s", {}, 0.18, 6.8, "softest to loudest, Goebl et al. 2005",
                "at the step before the impact"};
  Measure bottom{"key bottom after the string",
                 "ms",
                 {},
                 -4,
                 39,
                 "loudest to softest, Goebl et al. 2005",
                 "front rail punching against string, negative: before"};
  Measure check{"check distance",
                "mm",
                {},
                13,
                17,
                "Appendix A: forte, 15 mm; +-2 mm taken",
                "hammer held by the backcheck, to the string"};
  Measure ready{"repetition ready, key down",
                "mm",
                {},
                2,
                NAN,
                "Goebl et al. 2005: key 2 to 4 mm below its rest; deeper is better",
                "key position when the jack is under the knuckle again"};
  Measure wait{"repetition ready after", "ms", {}, NAN, NAN, "", "time from the string, mostly the player's"};
  for (const Event& impact : events) {
    if (impact.kind != EventKind::hammer_meets_string) continue;
    speed.values.push_back(impact.hammer_speed);
    for (const Event& rail : events)
      if (rail.kind == EventKind::key_meets_front_rail && rail.strike == impact.strike)
        bottom.values.push_back(kMillimetre * (rail.time - impact.time));
    if (const Event* caught = next_of(events, EventKind::hammer_checked, impact);
        caught != nullptr && roles.backcheck >= 0)
      if (const auto held = check_distance(roles, rows, *caught)) check.values.push_back(*held);
    if (const Event* again = next_of(events, EventKind::repetition_ready, impact)) {
      ready.values.push_back(kMillimetre * again->key_position);
      wait.values.push_back(kMillimetre * (again->time - impact.time));
    }
  }
  std::vector<Measure> measures{speed, bottom, check, ready, wait};
  if (const int lift = find_contact(action.model, "KD"); lift >= 0 && action.model.contacts[lift].is_active)
    measures.push_back(damper_lift(roles, rows, lift));
  return measures;
}

}  // namespace erard
