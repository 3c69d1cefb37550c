// Thesis 5.1 and 5.2 against the numbers computed here.
#include <fmt/format.h>

#include <cmath>

#include "study/pendulum_parts.hpp"

namespace erard::study {
namespace {

using fmt::format;
using Row = std::vector<std::string>;  // where, printed, computed, difference, why

constexpr int kLimit = 4000;  // of the searches

int steps_at_one_percent(const PendulumScheme& scheme, const PendulumCase& c) {
  return steps_needed(scheme, c, kOnePercent, kLimit).lasting;
}

/// A quantity of the two readings of the linearly implicit scheme.
template <typename Quantity>
std::string both(Quantity&& quantity) {
  return format("{} (5.26); {} gravity explicit", quantity(kLinearlyImplicit), quantity(kLinearlyImplicitFriction));
}

std::string difference(double computed, double printed) { return format("{:+.1f} %", 100 * (computed / printed - 1)); }

/// Mean error relative to the initial radian.
std::string error_percent(const PendulumScheme& scheme, const PendulumCase& c) {
  return format("{:.1f} %", 100 * mean_error(scheme, c, ExactPendulum(c.upsilon, c.start)));
}

/// Steps for 1 %, thesis 5.2.5.
std::vector<Row> one_percent_rows() {
  const int regularised = steps_at_one_percent(kLinearlyImplicit, {.upsilon = 2});
  const int friction_only = steps_at_one_percent(kLinearlyImplicitFriction, {.upsilon = 2});
  const int projected_2 = steps_at_one_percent(kProjected, {.upsilon = 2});
  const int projected_5 = steps_at_one_percent(kProjected, {.upsilon = 5});
  return {{"5.2.5: steps at 1 %, Y = 2, regularised", "250",
           format("{} (5.26); {} gravity explicit", regularised, friction_only),
           difference(regularised, 250) + "; " + difference(friction_only, 250),
           "(5.26) damps the swing itself; with gravity explicit 250 may be the next number tried"},
          {"the same, non-smooth", "40", format("{}", projected_2), difference(projected_2, 40),
           format("{} at 40", error_percent(kProjected, {.upsilon = 2, .steps = 40}))},
          {"the same, Y = 5, non-smooth", "15", format("{}", projected_5), difference(projected_5, 15),
           format("{} at 15: may be the next number tried", error_percent(kProjected, {.upsilon = 5, .steps = 15}))},
          {"the same, Y = 5, regularised", "much more than 500",
           both([](const PendulumScheme& s) { return steps_at_one_percent(s, {.upsilon = 5}); }), "",
           format("for good; by luck already at {}", steps_needed(kLinearlyImplicit, {}, kOnePercent, kLimit).first)}};
}

/// Figures 5.3 to 5.5.
std::vector<Row> figure_rows() {
  const PendulumCase figure_3{1, 10, 100}, figure_5{5, 1e4, 250};
  const double exact = ExactPendulum(5, {1, 0}).stick_angle();
  const double kept = final_angle(kLinearlyImplicit, figure_5) / exact;
  const double kept_friction_only = final_angle(kLinearlyImplicitFriction, figure_5) / exact;
  return {
      {"Figure 5.3: mean error of the regularised scheme", "\"excellent\"",
       both([&](const PendulumScheme& s) { return error_percent(s, figure_3); }), "", "(5.26) damps the swing"},
      {"Figure 5.3: spectral radius of C, said to be why the explicit scheme is unstable", "> 1",
       format("{:.3f}", explicit_spectral_radius(figure_3)), "",
       format("it is the sliding that explicit Euler excites, where C does not apply: from about {:.1f} rad on more "
              "than friction takes, whatever Psi",
              explicit_growth_threshold(figure_3))},
      {"Figure 5.4: steps a period", "1000 (caption), 10000 (text)",
       format("ends at {:.5f}, {:.5f} rad", final_angle(kLinearlyImplicit, {5, 0.1, 1000}),
              final_angle(kLinearlyImplicit, {5, 0.1, 10000})),
       "", format("both next to 0 instead of {:.4f}: the conclusion holds", exact)},
      {"Figure 5.5: angle after five periods against the exact one", "half",
       format("{:.2f} (5.26); {:.2f} gravity explicit; {:.2f} explicit", kept, kept_friction_only,
              final_angle(ExplicitEuler{}, figure_5) / exact),
       difference(kept, 0.5) + "; " + difference(kept_friction_only, 0.5), "the scheme is not named"}};
}

/// Figure 5.7 and what is said about cost and gravity.
std::vector<Row> cost_rows() {
  const PendulumCase let_go{.upsilon = 5, .steps = 20};
  const PendulumCase thrown{.upsilon = 5, .steps = 20, .start = kThrownStart};
  const int projected = steps_at_one_percent(kProjected, thrown);
  const int regularised = steps_at_one_percent(kLinearlyImplicit, thrown);
  const double ratio =
      static_cast<double>(steps_at_one_percent(kLinearlyImplicit, let_go)) / steps_at_one_percent(kProjected, let_go);
  constexpr EulerScheme kImplicitGravity{FrictionLaw::set_valued, Gravity::linearised};
  return {
      {"5.1.2: steps for Figure 5.7, regularised", "several thousand", format("{} at 1 %", regularised), "",
       "what \"correctly\" means is not said"},
      {"the same, non-smooth", "20", format("{} at 1 %", projected), difference(projected, 20),
       format("with 20 it sticks at {:.3f} instead of {:.3f} rad; let go at rest (Figure 5.8) 20 are enough: {}",
              final_angle(kProjected, thrown), ExactPendulum(5, kThrownStart).stick_angle(),
              error_percent(kProjected, let_go))},
      {"5.1.2: ratio of the costs", "about 100",
       format("{:.0f} thrown, {:.0f} let go", static_cast<double>(regularised) / projected, ratio), "",
       "steps at 1 %; a step of either costs about the same"},
      {"5.2.4: effect of taking gravity explicitly, Y = 5, 20 steps", "\"no significant influence\"",
       format("{} explicit, {} implicit", error_percent(kProjected, let_go), error_percent(kImplicitGravity, let_go)),
       "", "mean error; implicit Euler damps the swing, explicit gravity with the rate at the end does not"}};
}

}  // namespace

std::string pendulum_contradictions() {
  std::vector<Row> rows;
  for (const auto& group : {one_percent_rows(), figure_rows(), cost_rows()})
    rows.insert(rows.end(), group.begin(), group.end());
  rows.push_back({"(5.42): factor of the forces", "1", "1/Theta", "", "as in (5.46)"});
  const double key = 2 * M_PI * std::sqrt(0.012 / 0.0155);
  rows.push_back({"Table 5.2: Y of the key", "3.51", format("{:.2f}", key), difference(key, 3.51),
                  "(5.7) with c_d = 0.012 N m, m g l = 0.0155 N m of Table 2.1"});
  return table({"where", "printed", "computed", "difference", "why"}, rows);
}

}  // namespace erard::study
