// Pictures of the pendulum study.
#include <fmt/format.h>

#include <cmath>
#include <initializer_list>

#include "study/pendulum_parts.hpp"

namespace erard::study {
namespace {

using fmt::format;
using std::filesystem::path;

constexpr const char* kKeyOfErrors = "bottom left Left reverse samplen 2 spacing 0.8";

Curve exact_curve(double upsilon, PendulumState start) {
  const ExactPendulum exact(upsilon, start);
  Curve curve{"exact", {}, {}, "lines lw 5 lc rgb '#bbbbbb'"};
  constexpr int kPoints = 1000;
  for (int i = 0; i <= kPoints; ++i) {
    curve.x.push_back(kPendulumPeriods * static_cast<double>(i) / kPoints);
    curve.y.push_back(exact.angle_at(curve.x.back()));
  }
  return curve;
}

/// Angle against time, every step.
Curve angle_curve(const PendulumScheme& scheme, const PendulumCase& c, const std::string& label,
                  const std::string& style) {
  Curve curve{label, {}, {}, style};
  run_pendulum(scheme, c, static_cast<long>(kPendulumPeriods) * c.steps, [&](long k, const PendulumState& state) {
    curve.x.push_back(static_cast<double>(k) / c.steps);
    curve.y.push_back(state.angle);
  });
  return curve;
}

Panel angle_panel(const std::string& title, double upsilon, PendulumState start, std::pair<double, double> range) {
  return {title,
          {.label = "time [T]", .range = {0, kPendulumPeriods}},
          {.label = "angle [rad]", .range = range},
          {exact_curve(upsilon, start)}};
}

/// Mean error at every number of steps to 50, then in rungs of 4 %.
Curve error_curve(const PendulumContestant& who, double upsilon, int limit, const std::string& style) {
  const ExactPendulum exact(upsilon, {1, 0});
  Curve curve{who.name, {}, {}, style};
  for (int steps = 10; steps <= limit; steps += std::max(1, steps / 25)) {
    curve.x.push_back(steps);
    curve.y.push_back(mean_error(who.scheme, {.upsilon = upsilon, .steps = steps}, exact));
  }
  return curve;
}

Panel error_panel(const std::string& title, const std::string& key) {
  constexpr double kMost = 4000;
  const Curve line{"1 % of the initial angle", {10, kMost}, {kOnePercent, kOnePercent}, "lines dt 2 lc rgb '#444444'"};
  return {title,
          {.label = "steps a period", .range = {10, kMost}, .is_logarithmic = true},
          {.label = "mean error over five periods [rad]", .range = {1e-7, 1}, .is_logarithmic = true},
          {line},
          key};
}

/// One of the Figures 5.3 to 5.6: the regularised schemes beside each other.
Panel regularised_panel(const std::string& title, const PendulumCase& c, std::pair<double, double> range) {
  Panel panel = angle_panel(title, c.upsilon, c.start, range);
  for (const PendulumContestant& who : {kExplicitRow, kLinearlyImplicitRow, kFrictionOnlyRow})
    panel.curves.push_back(angle_curve(who.scheme, c, who.name, who.style));
  return panel;
}

/// Adds one scheme with more and more steps a period, light to dark.
void add_family(Panel& panel, const PendulumScheme& scheme, PendulumCase c, const std::vector<int>& family) {
  const char* const colours[] = {"#fdbe85", "#fd8d3c", "#e6550d", "#a63603", "#000000"};
  for (std::size_t i = 0; i < family.size(); ++i) {
    c.steps = family[i];
    const std::string style = format("lines lw 1 lc rgb '{}'", colours[i]);
    panel.curves.push_back(angle_curve(scheme, c, format("{} steps", c.steps), style));
  }
}

Panel convergence_panel(double upsilon) {
  const ExactPendulum exact(upsilon, {1, 0});
  Panel panel{format("Angle after five periods, Y = {}", upsilon),
              {.label = "steps a period", .range = {10, 20000}, .is_logarithmic = true},
              {.label = "|angle - exact sticking angle| [rad]", .range = {1e-13, 1}, .is_logarithmic = true},
              {},
              "bottom left Left reverse samplen 2"};
  for (const PendulumContestant& who : {kLinearlyImplicitRow, kEngineEulerRow, kProjectedRow, kEngineMiddleRow}) {
    Curve curve{who.name, {}, {}, who.style};
    for (double steps = 10; steps <= 20000; steps *= std::pow(10.0, 0.05)) {
      const PendulumCase c{.upsilon = upsilon, .steps = static_cast<int>(std::lround(steps))};
      curve.x.push_back(c.steps);
      curve.y.push_back(std::abs(final_angle(who.scheme, c) - exact.stick_angle()));
    }
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

Panel minute_panel(double upsilon) {
  const ExactPendulum exact(upsilon, {1, 0});
  Panel panel{format("A minute at rest, 1000 steps a period, Y = {}", upsilon),
              {.label = "time [T]", .range = {0, 65}},
              {.label = "angle - exact sticking angle [mrad]", .range = {-5, 8}},
              {}};
  const PendulumCase c{.upsilon = upsilon, .steps = 1000};
  for (const PendulumContestant& who :
       {kLinearlyImplicitRow, kImplicitFrictionRow, kEngineEulerRow, kProjectedRow, kEngineMiddleRow}) {
    Curve curve{who.name, {}, {}, who.style};
    run_pendulum(who.scheme, c, 65L * c.steps, [&](long k, const PendulumState& state) {
      if (k < c.steps || k % c.steps != 0) return;
      curve.x.push_back(static_cast<double>(k) / c.steps);
      curve.y.push_back(1e3 * (state.angle - exact.stick_angle()));
    });
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

}  // namespace

void draw_pendulum_at_a_glance(const path& svg) {
  const PendulumCase c{.upsilon = 5, .steps = 20};
  Panel motion = angle_panel("Twenty steps a period, Y = 5 (Figure 5.9)", 5, c.start, {-0.4, 1.2});
  motion.curves.push_back(
      angle_curve(kLinearlyImplicit, c, kLinearlyImplicitRow.name, "linespoints lw 1 pt 2 ps 0.5 lc rgb '#d62728'"));
  motion.curves.push_back(
      angle_curve(kProjected, c, kProjectedRow.name, "linespoints lw 1 pt 9 ps 0.6 lc rgb '#1f77b4'"));
  Panel error = error_panel("The steps it takes, Y = 5 (Figure 5.10)", kKeyOfErrors);
  error.curves.push_back(error_curve(kLinearlyImplicitRow, 5, 4000, "points pt 2 ps 0.4 lc rgb '#d62728'"));
  error.curves.push_back(error_curve(kProjectedRow, 5, 4000, "points pt 9 ps 0.4 lc rgb '#1f77b4'"));
  error.curves.push_back(error_curve(kEngineMiddleRow, 5, 1000, "points pt 7 ps 0.35 lc rgb '#2ca02c'"));
  draw(svg, {motion, error}, 2, 560, 400);
}

void draw_pendulum_errors(const path& svg) {
  std::vector<Panel> panels;
  for (const auto& [name, upsilon] : std::initializer_list<std::pair<const char*, double>>{
           {"Y = 1.26 (damper)", 1.26}, {"Y = 1.68 (hammer)", 1.68}, {"Y = 2", 2}, {"Y = 3.51 (key)", 3.51}}) {
    Panel panel = error_panel(name, panels.empty() ? kKeyOfErrors : "off");
    for (const PendulumContestant& who : kPendulumContestants)
      if (who.name != kImplicitFrictionRow.name)  // covers the projected one
        panel.curves.push_back(error_curve(who, upsilon, std::min(who.limit, 4000), who.style));
    panels.push_back(std::move(panel));
  }
  draw(svg, panels, 2, 560, 380);
}

void draw_pendulum_rest(const path& svg) { draw(svg, {convergence_panel(5), minute_panel(5)}, 2, 560, 400); }

void draw_pendulum_cases(const path& svg) {
  std::vector<Panel> panels{regularised_panel("5.3: 100 steps, Psi = 10, Y = 1", {1, 10, 100}, {-2, 4}),
                            regularised_panel("5.4: 1000 steps, Psi = 0.1, Y = 5", {5, 0.1, 1000}, {-0.8, 1.6}),
                            regularised_panel("5.5: 250 steps, Psi = 10000, Y = 5", {5, 1e4, 250}, {0, 1.2}),
                            regularised_panel("5.6: 50 steps, Psi = 10000, Y = 5", {5, 1e4, 50}, {-0.2, 1.2}),
                            angle_panel("5.7: thrown (1, -10), linearly implicit, Y = 5", 5, kThrownStart, {-1.2, 2.4}),
                            angle_panel("5.8: projected, Y = 5", 5, {1, 0}, {0.2, 1.1})};
  add_family(panels[4], kLinearlyImplicit, {.upsilon = 5, .start = kThrownStart}, {20, 100, 250, 500, 4000});
  add_family(panels[5], kProjected, {.upsilon = 5}, {5, 10, 15, 20, 50});
  draw(svg, panels, 2, 560, 320);
}

}  // namespace erard::study
