// The section of the pendulum study: sentences and tables.
#include <fmt/format.h>

#include <cmath>

#include "study/pendulum_parts.hpp"

namespace erard::study {
namespace {

using fmt::format;
using Rows = std::vector<std::vector<std::string>>;

/// Y of the bodies that have a finite one, thesis Table 5.2, and the two of its text.
const std::vector<double> kUpsilons{1.26, 1.68, 1.98, 2, 3.51, 5};

/// Steps a period at 1 %, 0 for not found: contestants x kUpsilons.
using StepsTable = std::vector<std::vector<int>>;

StepsTable find_steps() {
  StepsTable steps;
  for (const PendulumContestant& who : kPendulumContestants) {
    steps.emplace_back();
    for (const double upsilon : kUpsilons)
      steps.back().push_back(steps_needed(who.scheme, {.upsilon = upsilon}, kOnePercent, who.limit).lasting);
  }
  return steps;
}

int look_up(const StepsTable& steps, const PendulumContestant& who, double upsilon) {
  std::size_t row = 0, column = 0;
  while (kPendulumContestants[row].name != who.name) ++row;
  while (kUpsilons[column] != upsilon) ++column;
  return steps[row][column];
}

std::string count_or_more(int steps, int limit) { return steps > 0 ? format("{}", steps) : format("> {}", limit); }

std::string small_number(double value) { return value == 0 ? "0" : format("{:.1e}", value); }

std::string result_line(const StepsTable& steps) {
  return format(
      "at 1 % the projected scheme needs {} and {} steps a period (Y = 2, 5), the regularised one {} and {}, this "
      "engine {} and {}",
      look_up(steps, kProjectedRow, 2), look_up(steps, kProjectedRow, 5), look_up(steps, kLinearlyImplicitRow, 2),
      look_up(steps, kLinearlyImplicitRow, 5), look_up(steps, kEngineMiddleRow, 2),
      look_up(steps, kEngineMiddleRow, 5));
}

std::string summary(const StepsTable& steps) {
  const ExactPendulum exact(5, {1, 0});
  const PendulumCase twenty{.upsilon = 5, .steps = 20};
  return format(
      "A pendulum with dry friction in its hinge must stop at an angle and stay there. In twenty steps a period (Y = "
      "5) the "
      "projected scheme of the thesis does, {:.1f} % off on average, while its regularised scheme slips on towards "
      "zero, "
      "{:.0f} % off. For 1 % the one needs {} steps a period and the other {} (Y = 2: {} and {}); this engine's own "
      "middle "
      "scheme needs {} ({}).\n\n",
      100 * mean_error(kProjected, twenty, exact), 100 * mean_error(kLinearlyImplicit, twenty, exact),
      look_up(steps, kProjectedRow, 5), look_up(steps, kLinearlyImplicitRow, 5), look_up(steps, kProjectedRow, 2),
      look_up(steps, kLinearlyImplicitRow, 2), look_up(steps, kEngineMiddleRow, 5),
      look_up(steps, kEngineMiddleRow, 2));
}

std::string exact_table() {
  Rows rows;
  for (const double upsilon : {2.0, 5.0}) {
    const ExactPendulum exact(upsilon, {1, 0});
    rows.push_back({format("{}", upsilon), format("{}", exact.swings().size()), format("{:.9f}", exact.stick_angle()),
                    format("{:.6f}", exact.stick_time())});
  }
  return table({"Y", "half swings", "sticks at [rad]", "at time [T]"}, rows);
}

std::string error_table(double upsilon) {
  const ExactPendulum exact(upsilon, {1, 0});
  std::vector<std::string> head{format("Y = {}; steps a period", upsilon)};
  for (const int steps : kPendulumSteps) head.push_back(format("{}", steps));
  Rows rows;
  for (const PendulumContestant& who : kPendulumContestants) {
    rows.push_back({who.name});
    for (const int steps : kPendulumSteps)
      rows.back().push_back(format("{:.2e}", mean_error(who.scheme, {.upsilon = upsilon, .steps = steps}, exact)));
  }
  if (upsilon == 5)
    rows.push_back({"MuJoCo RK4, stiffest settings (measured elsewhere)", "3.99e-02", "1.83e-02", "9.85e-03",
                    "2.76e-03", "7.14e-04", "1.90e-04", "8.28e-05", "2.33e-05", "7.23e-06"});
  return table(head, rows);
}

/// Where the engine's middle scheme is not better than the projected one.
std::string exceptions_of_the_engine() {
  std::string text;
  for (const double upsilon : {2.0, 5.0})
    for (const int steps : kPendulumSteps) {
      const PendulumCase c{.upsilon = upsilon, .steps = steps};
      const ExactPendulum exact(upsilon, c.start);
      const double engine = mean_error(kEngineMiddleRow.scheme, c, exact), projected = mean_error(kProjected, c, exact);
      if (engine < projected) continue;
      text += format("{} at Y = {} and {} steps ({:.2e} against {:.2e})", text.empty() ? " but" : " and", upsilon,
                     steps, engine, projected);
    }
  return text;
}

std::string steps_table(const StepsTable& steps) {
  std::vector<std::string> head{"steps a period at 1 %"};
  for (const char* body : {"damper", "hammer", "whippen", "", "key", ""}) {
    const double upsilon = kUpsilons[head.size() - 1];
    head.push_back(format("Y = {}{}{}", upsilon, *body == 0 ? "" : ", ", body));
  }
  Rows rows;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    rows.push_back({kPendulumContestants[i].name});
    for (const int count : steps[i]) rows.back().push_back(count_or_more(count, kPendulumContestants[i].limit));
  }
  return table(head, rows);
}

std::string cost_table(const StepsTable& steps) {
  Rows rows;
  for (const PendulumContestant& who : kPendulumContestants) {
    rows.push_back({who.name});
    for (const double upsilon : {2.0, 5.0}) {
      const int count = look_up(steps, who, upsilon);
      const double seconds = seconds_per_step(who.scheme, {.upsilon = upsilon, .steps = count > 0 ? count : who.limit});
      rows.back().push_back(count_or_more(count, who.limit));
      rows.back().push_back(format("{:.0f}", 1e9 * seconds));
      const double microseconds = 1e6 * seconds * count;
      rows.back().push_back(count > 0 ? format("{:.{}f}", microseconds, microseconds < 10 ? 2 : 0) : "");
    }
  }
  return table({"cost at 1 %", "Y = 2: steps a second", "ns a step", "us a second", "Y = 5: steps a second",
                "ns a step", "us a second"},
               rows);
}

/// Friction law by treatment of gravity: which of the two costs the steps.
std::string cause_table() {
  Rows rows;
  for (const auto& [name, law] :
       {std::pair{"regularised, linearised at the start of the step", FrictionLaw::linearised},
        std::pair{"regularised, met by the end of the step", FrictionLaw::regularised},
        std::pair{"set-valued, met by the end of the step", FrictionLaw::set_valued}}) {
    rows.push_back({name});
    for (const double upsilon : {2.0, 5.0})
      for (const Gravity gravity : {Gravity::linearised, Gravity::at_start}) {
        const EulerScheme scheme{law, gravity};
        rows.back().push_back(format("{}", steps_needed(scheme, {.upsilon = upsilon}, kOnePercent, 4000).lasting));
      }
  }
  return table({"steps a period at 1 %", "Y = 2: gravity implicit", "gravity explicit", "Y = 5: gravity implicit",
                "gravity explicit"},
               rows);
}

std::string rest_table() {
  Rows rows;
  for (const PendulumContestant& who : kPendulumContestants) {
    rows.push_back({who.name});
    for (const double upsilon : {2.0, 5.0}) {
      const PendulumRest rest = rest_of(who.scheme, {.upsilon = upsilon, .steps = 1000});
      const ExactPendulum exact(upsilon, {1, 0});
      for (const double value : {std::abs(rest.angle - exact.stick_angle()), rest.fastest, rest.drift})
        rows.back().push_back(small_number(value));
    }
  }
  return table({"1000 steps a period", "Y = 2: error at 5 T [rad]", "fastest in the minute after [rad/s]",
                "drift [rad]", "Y = 5: error at 5 T [rad]", "fastest [rad/s]", "drift [rad]"},
               rows);
}

}  // namespace

Section pendulum_section(const Pictures& pictures) {
  const auto picture = [&](const char* name, const char* alt, void (*draw_it)(const std::filesystem::path&)) {
    draw_it(pictures.folder / (std::string(name) + ".svg"));
    return format("![{}]({}/{}.svg)\n\n", alt, pictures.link, name);
  };
  const StepsTable steps = find_steps();
  const PendulumClaims claims = check_pendulum_claims();
  std::string text = summary(steps);
  text += picture("pendulum", "Twenty steps a period, and the steps it takes", draw_pendulum_at_a_glance);
  text +=
      "theta'' + Y^2 sign theta' + 4 pi^2 sin theta = 0 (5.6), Y the thesis's Upsilon, time in periods T of the small "
      "frictionless swing (T = 1 s where seconds are named), let go at 1 rad unless told; the regularised sign is a "
      "ramp of "
      "slope Psi = 10000 (5.11). The exact solution takes the turning angles from the energy of each half swing, by "
      "root "
      "finding, and the times by quadrature:\n\n" +
      exact_table();
  text +=
      "\n### Mean error\nMean of |angle - exact| over the steps k = 0 .. 5 Theta [rad]. Siconos, Box2D and DART give "
      "the "
      "figures of the projected scheme (measured elsewhere). The engine with theta = 1 is implicit Euler: it damps the "
      "swing and is far worse than the projected scheme. With theta = 1/2 it is better everywhere" +
      exceptions_of_the_engine() + ".\n\n" + error_table(2) + "\n" + error_table(5) + "\n" +
      picture("pendulum_errors", "Mean error against steps for the bodies of the action", draw_pendulum_errors);
  text +=
      "Steps a period from which on the mean error stays within 1 % of the initial radian (search over every number to "
      "100, "
      "then in rungs of 1 %):\n\n" +
      steps_table(steps) +
      "\nAnd the computing time that this is for a simulated second, on one core of a shared virtual machine: the only "
      "numbers here that change from run to run. The engine's step is that of any mechanism; the others are a few "
      "lines each.\n\n" +
      cost_table(steps);
  text +=
      "\n### What makes the difference\nNot the ramp itself. Implicit gravity damps the swing, whatever the friction "
      "law: "
      "that is most of it at Y = 2. And friction linearised at the start of the step sees the ramp only if a step "
      "happens to "
      "begin on it, |theta'| <= 1/Psi; until then the pendulum chatters and slips. When it is caught is luck, hence "
      "the "
      "scattered crosses above. Met by the rate at the end of the step, with explicit gravity, the ramp needs hardly "
      "more "
      "steps than the projection, and those cost the same. What no ramp can do is hold.\n\n" +
      cause_table();
  text +=
      "\n### At rest\n" +
      picture("pendulum_rest", "Convergence of the sticking angle, and a minute at rest", draw_pendulum_rest) +
      rest_table() +
      "\nThe sticking angle converges with the square of the step in the projected scheme and in the engine with "
      "theta = 1/2 (here the projected one is a little nearer), with the step itself for theta = 1. A ramp creeps at "
      "4 pi^2 sin theta / (Y^2 Psi), however small the step. Measured elsewhere: Siconos, ODE and Box2D at most 1e-16 "
      "rad/s, DART 1e-9; MuJoCo creeps at 1.3e-2 with its defaults, at 1.5e-6 to 7.6e-5 at its stiffest.\n";
  text +=
      "\n### Figures 5.3 to 5.8\n" +
      picture("pendulum_cases", "Figures 5.3 to 5.8 of the thesis", draw_pendulum_cases) +
      "The thesis's linearly implicit scheme can be read in two ways. (5.13) to (5.26) linearise gravity too, as the "
      "tables above do; but Figure 5.3 and the 250 steps for Y = 2 fit a scheme with explicit gravity, like its "
      "non-smooth one. Where it matters both are given. What is printed and does not come out, numbers and then "
      "statements:\n\n" +
      table(claims.numbers) + "\n" + table({"where", "printed", "computed", "why"}, claims.statements);
  return {"A pendulum with dry friction", result_line(steps), text, claims.numbers};
}

}  // namespace erard::study
