// The section of Tables 4.1 and 5.2, touch weight and front rail: text, tables, pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/figure.hpp"
#include "study/front_rail.hpp"
#include "study/thesis_tables.hpp"
#include "study/touch_weight.hpp"

namespace erard::study {
namespace {

constexpr double kMillimetre = 1e3;  // [mm/m]
constexpr double kGram = 1e3;        // [g/kg]

/// Player's mass at the finger that brings (6.2) down to the measured frequency [kg].
double player_mass(double force, double measured) {
  return (ringing_mass(linear_rail(force).stiffness, measured) - kKeyMassAtRail) / mass_at_rail(1);
}

struct RailRow {
  const char* name;
  double force, measured, printed, release;
  StrokeOscillation stroke;
  double mass;   // of the player, by (6.2)
  HeldKey held;  // with that mass
};

std::vector<RailRow> rail_rows() {
  std::vector<RailRow> rows{{"piano", 3.5, 70, 121, 0.220, {}, 0, {}}, {"forte", 9, 90, 167, 0.142, {}, 0, {}}};
  for (RailRow& row : rows) {
    row.stroke = stroke_oscillation(row.name, row.release);
    row.mass = player_mass(row.force, row.measured);
    row.held = ring_held_key(row.force, row.mass);
  }
  return rows;
}

std::string touch_table(const std::vector<TouchCase>& cases) {
  std::vector<std::vector<std::string>> rows;
  for (const TouchCase& c : cases)
    rows.push_back({c.what, fmt::format("{:.4f}", c.parameters.kappa), fmt::format("{:.2f}", c.parameters.friction),
                    fmt::format("{:.2f} / {:.2f}", c.measured.down, c.measured.up),
                    fmt::format("{:.2f} / {:.2f}", c.predicted.down, c.predicted.up)});
  return table({"", "kappa [N m]", "frictions", "down / up, played [N]", "by the formula [N]"}, rows);
}

std::string rail_table(const std::vector<RailRow>& rows) {
  std::vector<std::vector<std::string>> cells;
  for (const RailRow& r : rows)
    cells.push_back(
        {r.name, fmt::format("{:.0f}", r.measured),
         fmt::format("{:.0f} / {:.0f}", r.printed, ringing_frequency(linear_rail(r.force).stiffness, kKeyMassAtRail)),
         fmt::format("{:.0f}", r.stroke.oscillation.frequency),
         fmt::format("{:.1f} / {:.1f} / {:.1f}", r.stroke.plateau, r.stroke.rail, r.stroke.check),
         fmt::format("{:.0f}", kGram * r.mass), fmt::format("{:.0f}", r.held.frequency)});
  return table({"stroke", "measured [Hz]", "(6.2): printed / computed [Hz]", "this action [Hz]",
                "finger / rail / check, held [N]", "player for the measured [g]", "key held with that mass [Hz]"},
               cells);
}

void draw_touch(const Pictures& pictures, const std::vector<TouchCase>& cases) {
  const auto panel = [](const std::string& title, const ActionOptions& options, const TouchWeight& measured) {
    TouchCurve curve = touch_curve(options);
    for (auto* y : {&curve.down_y, &curve.up_y})
      for (double& value : *y) value *= kMillimetre;
    const auto thin = [](const std::vector<double>& all) {
      std::vector<double> few;
      for (std::size_t i = 0; i < all.size(); i += 10) few.push_back(all[i]);
      return few;
    };
    return Panel{
        title,
        {"key position [mm]", {0, 8}},
        {"force on the finger [N]", {0, 1}},
        {{"down", thin(curve.down_y), thin(curve.down), "lines lw 2 lc rgb '#1f5fa8'"},
         {"up", thin(curve.up_y), thin(curve.up), "lines lw 2 lc rgb '#c8501e'"},
         {"means", {1.5, 7}, {measured.down, measured.down}, "lines lw 2 dashtype 2 lc rgb '#1f5fa8'"},
         {"", {1.5, 7}, {measured.up, measured.up}, "lines lw 2 dashtype 2 lc rgb '#c8501e'"},
         {"thesis: 0.70 and 0.38 N", {1.5, 7}, {thesis::kDownForce, thesis::kDownForce}, "lines lw 1 lc rgb '#000000'"},
         {"", {1.5, 7}, {thesis::kUpForce, thesis::kUpForce}, "lines lw 1 lc rgb '#000000'"}},
        "bottom center"};
  };
  const StaticTouch& wanted = cases.back().parameters;
  draw(pictures.folder / "touch_weight.svg",
       {panel("the thesis's numbers", {}, cases.front().measured),
        panel(fmt::format("kappa {:.4f} N m, frictions x {:.2f}", wanted.kappa, wanted.friction), touch_options(wanted),
              cases.back().measured)},
       2, 520, 380);
}

Panel stroke_panel(const RailRow& row) {
  std::vector<double> time, at, level;
  for (const double t : row.stroke.time) time.push_back(kMillimetre * t);
  for (const double t : row.stroke.oscillation.maxima) {
    const auto next = std::lower_bound(row.stroke.time.begin(), row.stroke.time.end(), t - 2.5e-4);
    at.push_back(kMillimetre * t);
    level.push_back(row.stroke.force[static_cast<std::size_t>(next - row.stroke.time.begin())]);
  }
  return {fmt::format("{}: {:.0f} Hz", row.name, row.stroke.oscillation.frequency),
          {"time [ms]"},
          {"force on the finger [N]"},
          {{"from the check to the release", time, row.stroke.force, "lines lw 2 lc rgb '#1f5fa8'"},
           {"maxima", at, level, "points pt 7 ps 0.6 lc rgb '#c8501e'"}},
          "top right"};
}

void draw_rail(const Pictures& pictures, const std::vector<RailRow>& rows) {
  Panel masses{"the key held on the rail: what a player's mass does",
               {"mass on the key at the finger [g]"},
               {"frequency [Hz]", {40, 280}},
               {},
               "top right"};
  const char* colours[] = {"#1f5fa8", "#c8501e"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RailRow& row = rows[i];
    const std::string force = fmt::format("{:.1f} N", row.force);
    Curve formula{"(6.2), " + force, {}, {}, fmt::format("lines lw 2 lc rgb '{}'", colours[i])};
    Curve played{"played, " + force, {}, {}, fmt::format("points pt 7 ps 0.6 lc rgb '{}'", colours[i])};
    for (const double gram : {0., 15., 30., 50., 75., 100., 125., 150., 200.}) {
      formula.x.push_back(gram);
      formula.y.push_back(
          ringing_frequency(linear_rail(row.force).stiffness, kKeyMassAtRail + mass_at_rail(1e-3 * gram)));
      const HeldKey held = ring_held_key(row.force, 1e-3 * gram);
      played.x.push_back(gram);
      played.y.push_back(held.frequency > 0 ? held.frequency : NAN);
    }
    masses.curves.push_back(formula);
    masses.curves.push_back(played);
    masses.curves.push_back({"measured in the thesis, " + std::string(row.name),
                             {0, 200},
                             {row.measured, row.measured},
                             fmt::format("lines lw 1 dashtype 2 lc rgb '{}'", colours[i])});
  }
  draw(pictures.folder / "front_rail.svg", {stroke_panel(rows[0]), stroke_panel(rows[1]), masses}, 3, 420, 380);
}

constexpr const char* kTablesText = R"(
The frictions of whippen, hammer and damper in `config/grand_action.yaml` were derived from Table 5.2, so only the
key tests it: its c_d would have to be 0.0048 N m, or its centre of gravity 47 mm from its pivot. The forces of
Table 4.1 are not the balance of 10 N at the finger through the lever arms of Table 2.1, which is {:.0f} N at the
whippen and {:.0f} N at the knuckle; jack and hammer are there with 30 N.

(4.11) speaks of 1 mm in 0.1 s, for which the felt would have to be pressed with 127 N. Where the key meets the
front rail, the punching gives {:.2f} mm in piano and {:.2f} mm in forte, and stores {:.0f} and {:.0f} times what it
loses until then. So the viscous part is as little negligible as the thesis says, although the number it gives for
that is wrong.
)";

constexpr const char* kTouchText = R"(
Piston at 6 mm/s to Y = 7.8 mm and back, no damper, mean force over y = 1.5 to 7 mm. "By the formula" is the balance
of moments of Tables 2.1, 4.12 and 5.2, in which neither geometry nor solver has a part; the two agree within {:.3f}
N. The spring of the whippen takes {:.2f} N off both weights, which (2.7) leaves out; without it the mean is {:.2f}
N (thesis: 0.54 N). The frictions of Tables 2.1 and 5.2 make {:.2f} N each way where 0.16 N are needed. Of the two
springs that the thesis prints for the whippen, that of Table 2.1 leads further away. The action keeps the printed
numbers.
)";

constexpr const char* kRailText = R"(
"This action": mean interval of the maxima of the finger force between check and release that stand out by 2 % of
the force held. The keystrokes carry a finger of 15 g (piano) and 10 g (forte), and the backcheck bears part of the
force as a second spring. (6.2) with m_eq = 62 g has no player in it. {:.0f} g on the key at the finger would bring
it down to the measured 70 Hz, {:.0f} g to 90 Hz: about ten times the finger of these keystrokes. The engine agrees:
held by a steady 3.5 or 9 N with such a mass, and given another tenth, the key rings at {:.0f} and {:.0f} Hz. That
is not exactly (6.2) because under 3.5 N the rail bears only {:.1f} N, whippen and let-off the rest, and because
those ring along.
)";

constexpr const char* kOpening =
    R"(Of {} printed numbers recomputed here {} are met within 2 %; of the other {}, {} are rounding to one digit. On
the thesis's other numbers the key sinks under {:.2f} N and rises under {:.2f} N, not 0.70 and 0.38 N: those contradict
each other. On the front rail the action rings at {:.0f} (piano) and {:.0f} Hz (forte), where 70 and 90 Hz were
measured: a player's mass of {:.0f} to {:.0f} g at the finger accounts for that.

![Force on the finger in a press of 6 mm/s]({link}/touch_weight.svg)

![Force on the finger on the front rail, and frequency against the player's mass]({link}/front_rail.svg)
)";

/// Largest distance of the played touch weights from the formula [N].
double largest_distance(const std::vector<TouchCase>& cases) {
  double largest = 0;
  for (const TouchCase& c : cases)
    largest =
        std::max({largest, std::abs(c.measured.down - c.predicted.down), std::abs(c.measured.up - c.predicted.up)});
  return largest;
}

}  // namespace

Section thesis_tables_section(const Pictures& pictures) {
  const ActionFile action = default_action();
  const std::vector<TouchCase> cases = touch_cases();
  const std::vector<RailRow> rails = rail_rows();
  draw_touch(pictures, cases);
  draw_rail(pictures, rails);

  const TouchWeight &played = cases[0].measured, &no_spring = cases[1].measured;
  std::vector<Recomputed> all = recompute_tables(action);
  for (const Recomputed& r : recompute_touch(played)) all.push_back(r);
  const std::vector<Contradiction> contradicted = contradictions_of(all);
  const auto rounded = std::count_if(contradicted.begin(), contradicted.end(),
                                     [](const Contradiction& c) { return c.why.ends_with("one digit"); });
  std::string text =
      fmt::format(kOpening, all.size(), all.size() - contradicted.size(), contradicted.size(), rounded, played.down,
                  played.up, rails[0].stroke.oscillation.frequency, rails[1].stroke.oscillation.frequency,
                  kGram * rails[0].mass, kGram * rails[1].mass, fmt::arg("link", pictures.link));

  const LeverForces forces = lever_forces(10);
  const FeltEnergies piano = front_rail_energies(action, "piano"), forte = front_rail_energies(action, "forte");
  text += "\n### Printed numbers that the computed ones contradict by more than 2 %\n" + table(contradicted);
  text += "\n### Those they confirm\n" + table_of_confirmed(all);
  text += fmt::format(kTablesText, forces.whippen, forces.knuckle, kMillimetre * piano.compression,
                      kMillimetre * forte.compression, piano.ratio(), forte.ratio());
  text += "\n### Touch weight\n" + touch_table(cases);
  text += fmt::format(kTouchText, largest_distance(cases), no_spring.mean() - played.mean(), no_spring.mean(),
                      played.friction());
  text += "\n### Front rail\n" + rail_table(rails);
  text += fmt::format(kRailText, kGram * rails[0].mass, kGram * rails[1].mass, rails[0].held.frequency,
                      rails[1].held.frequency, rails[0].held.rail);
  const std::string result = fmt::format(
      "{} of {} printed numbers are met within 2 %; touch weight {:.2f} / {:.2f} N, not 0.70 / 0.38; the front rail "
      "rings "
      "at {:.0f} / {:.0f} Hz, 70 / 90 with a player's {:.0f} to {:.0f} g",
      all.size() - contradicted.size(), all.size(), played.down, played.up, rails[0].stroke.oscillation.frequency,
      rails[1].stroke.oscillation.frequency, kGram * rails[0].mass, kGram * rails[1].mass);
  return {"Tables 4.1 and 5.2, touch weight, front rail", result, text, contradicted};
}

}  // namespace erard::study
