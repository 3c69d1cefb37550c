// Thesis 5.1 and 5.2 against the numbers computed here.
#include <fmt/format.h>

#include <cmath>

#include "study/pendulum_parts.hpp"

namespace erard::study {
namespace {

using fmt::format;
constexpr int kLimit = 4000;  // of the searches

int steps_at_one_percent(const PendulumScheme& scheme, const PendulumCase& c) {
  return steps_needed(scheme, c, kOnePercent, kLimit).lasting;
}

/// A quantity of the two readings of the linearly implicit scheme.
template <typename Quantity>
std::string both(Quantity&& quantity) {
  return format("{} (5.26); {} gravity explicit", quantity(kLinearlyImplicit), quantity(kLinearlyImplicitFriction));
}

/// Adds a printed number that none of the computed ones meets.
void add_number(PendulumClaims& claims, const std::string& quantity, double printed, std::vector<double> values,
                const std::string& computed, const std::string& why) {
  std::string differences;
  for (const double value : values) {
    const double difference = value / printed - 1;
    if (std::abs(difference) <= kContradiction) return;
    differences += (differences.empty() ? "" : "; ") + signed_percent(difference);
  }
  claims.numbers.push_back({quantity, three_digits(printed), computed, differences, why});
}

/// Mean error relative to the initial radian.
std::string error_percent(const PendulumScheme& scheme, const PendulumCase& c) {
  return format("{:.1f} %", 100 * mean_error(scheme, c, ExactPendulum(c.upsilon, c.start)));
}

/// Steps for 1 %, thesis 5.2.5.
void add_steps(PendulumClaims& claims) {
  const int regularised = steps_at_one_percent(kLinearlyImplicit, {.upsilon = 2});
  const int friction_only = steps_at_one_percent(kLinearlyImplicitFriction, {.upsilon = 2});
  add_number(claims, "steps at 1 %, Y = 2, regularised (5.2.5)", 250,
             {static_cast<double>(regularised), static_cast<double>(friction_only)},
             format("{} (5.26); {} gravity explicit", regularised, friction_only),
             "(5.26) damps the swing itself; with gravity explicit 250 may be the next number tried");
  for (const auto& [upsilon, printed] : {std::pair{2, 40}, {5, 15}}) {
    const int steps = steps_at_one_percent(kProjected, {.upsilon = 1.0 * upsilon});
    add_number(claims, format("steps at 1 %, Y = {}, non-smooth (5.2.5)", upsilon), printed, {1.0 * steps},
               format("{}", steps),
               format("mean error {} at {}: may be the next number tried",
                      error_percent(kProjected, {.upsilon = 1.0 * upsilon, .steps = printed}), printed));
  }
  claims.statements.push_back(
      {"steps at 1 %, Y = 5, regularised (5.2.5)", "much more than 500",
       both([](const PendulumScheme& s) { return steps_at_one_percent(s, {.upsilon = 5}); }),
       format("for good; by luck already at {}", steps_needed(kLinearlyImplicit, {}, kOnePercent, kLimit).first)});
}

/// Figures 5.3 to 5.5.
void add_figures(PendulumClaims& claims) {
  const PendulumCase figure_3{1, 10, 100}, figure_5{5, 1e4, 250};
  const double exact = ExactPendulum(5, {1, 0}).stick_angle();
  const double kept = final_angle(kLinearlyImplicit, figure_5) / exact;
  const double kept_friction_only = final_angle(kLinearlyImplicitFriction, figure_5) / exact;
  add_number(claims, "angle after five periods over the exact one (Figure 5.5)", 0.5, {kept, kept_friction_only},
             format("{:.2f} (5.26); {:.2f} gravity explicit; {:.2f} explicit", kept, kept_friction_only,
                    final_angle(ExplicitEuler{}, figure_5) / exact),
             "the scheme is not named");
  claims.statements.push_back({"mean error of the regularised scheme (Figure 5.3)", "\"excellent\"",
                               both([&](const PendulumScheme& s) { return error_percent(s, figure_3); }),
                               "(5.26) damps the swing"});
  claims.statements.push_back(
      {"spectral radius of C, said to be why the explicit scheme is unstable (Figure 5.3)", "> 1",
       format("{:.3f}", explicit_spectral_radius(figure_3)),
       format("it is the sliding that explicit Euler excites, where C does not apply: from about {:.1f} rad on more "
              "than friction takes, whatever Psi",
              explicit_growth_threshold(figure_3))});
  claims.statements.push_back({"steps a period (Figure 5.4)", "1000 (caption), 10000 (text)",
                               format("ends at {:.5f}, {:.5f} rad", final_angle(kLinearlyImplicit, {5, 0.1, 1000}),
                                      final_angle(kLinearlyImplicit, {5, 0.1, 10000})),
                               format("both next to 0 instead of {:.4f}: the conclusion holds", exact)});
}

/// Figure 5.7 and what is said about cost and gravity.
void add_costs(PendulumClaims& claims) {
  const PendulumCase let_go{.upsilon = 5, .steps = 20};
  const PendulumCase thrown{.upsilon = 5, .steps = 20, .start = kThrownStart};
  const double projected = steps_at_one_percent(kProjected, thrown);
  const double regularised = steps_at_one_percent(kLinearlyImplicit, thrown);
  const double ratio =
      static_cast<double>(steps_at_one_percent(kLinearlyImplicit, let_go)) / steps_at_one_percent(kProjected, let_go);
  constexpr EulerScheme kImplicitGravity{FrictionLaw::set_valued, Gravity::linearised};
  add_number(claims, "steps for Figure 5.7, non-smooth (5.1.2)", 20, {projected}, format("{} at 1 %", projected),
             format("with 20 it sticks at {:.3f} instead of {:.3f} rad; let go at rest (Figure 5.8) 20 are enough: {}",
                    final_angle(kProjected, thrown), ExactPendulum(5, kThrownStart).stick_angle(),
                    error_percent(kProjected, let_go)));
  add_number(claims, "ratio of the costs, \"about\" (5.1.2)", 100, {regularised / projected, ratio},
             format("{:.0f} thrown, {:.0f} let go", regularised / projected, ratio),
             "steps at 1 %; a step of either costs about the same");
  claims.statements.push_back({"steps for Figure 5.7, regularised (5.1.2)", "several thousand",
                               format("{} at 1 %", regularised), "what \"correctly\" means is not said"});
  claims.statements.push_back(
      {"effect of taking gravity explicitly, Y = 5, 20 steps (5.2.4)", "\"no significant influence\"",
       format("{} explicit, {} implicit", error_percent(kProjected, let_go), error_percent(kImplicitGravity, let_go)),
       "mean error; implicit Euler damps the swing, explicit gravity with the rate at the end does not"});
}

}  // namespace

PendulumClaims check_pendulum_claims() {
  PendulumClaims claims;
  add_steps(claims);
  add_figures(claims);
  add_costs(claims);
  claims.statements.push_back({"factor of the forces in (5.42)", "1", "1/Theta", "as in (5.46)"});
  return claims;
}

}  // namespace erard::study
