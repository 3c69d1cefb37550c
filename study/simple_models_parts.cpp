#include "study/simple_models_parts.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "study/thesis_numbers.hpp"

namespace erard::study::simple {
std::string parts_table(const SimpleModelsStudy& study) {
  const KeyParts thesis_own = thesis_parts();
  const KeyParts& own = study.parts;
  const Equivalents thesis = equivalents(thesis_own), ours = equivalents(own);
  struct Row {
    const char* name;
    double printed, computed, ours;
    const char *unit, *why;
  };
  const std::array all{
      Row{"alpha_21 (2.1)", 2.15, thesis_own.alpha21, own.alpha21, "-", ""},
      Row{"alpha_31 (2.1)", 10.1, thesis_own.alpha31, own.alpha31, "-", "mean over y = 0.5 to 7.5 mm"},
      Row{"J (2.2)", 0.0221, thesis.inertia, ours.inertia, "kg m^2", "alpha_31"},
      Row{"C_w of the parts (2.4)", 0.138, thesis.weight, ours.weight, "N m", ""},
      Row{"F_down (2.2)", 0.70, NAN, own.down_force, "N", "spring and frictions of chapter 4: docs/action.md"},
      Row{"F_up (2.2)", 0.38, NAN, own.up_force, "N", "the same"},
      Row{"C_w of the static test (2.7)", 0.132, thesis.static_weight, ours.static_weight, "N m", "the same"},
      Row{"C_d (2.8)", 0.039, thesis.dry, ours.dry, "N m", "the same"},
      Row{"c_v (2.4)", 0.0273, thesis.viscous, ours.viscous, "N m s", ""},
      Row{"kappa (2.4)", 0.4, thesis.spring, ours.spring, "N m", "kappa_2 of Table 4.12"},
      Row{"theta_0", 0.1947, thesis.spring_rest, ours.spring_rest, "rad", "counted from the whippen's angle at rest"},
      Row{"theta_e", 0.0343, NAN, study.piano.record.let_off_angle, "rad", "the text of 2.2 says about 0.035 too"},
      Row{"theta_p", 0.0397, NAN, study.model.rail.angle, "rad", ""},
      Row{"K of BH", thesis_action().blocked.stiffness, NAN, study.model.blocked.stiffness, "N m",
          "this key yields much less before F_down is reached"}};
  std::vector<std::vector<std::string>> rows;
  for (const Row& row : all) {
    const bool has_parts = std::isfinite(row.computed);
    rows.push_back({row.name, fmt::format("{:.4g} {}", row.printed, row.unit),
                    has_parts ? fmt::format("{:.4g}", row.computed) : "",
                    has_parts ? signed_percent(row.computed / row.printed - 1) : "", fmt::format("{:.4g}", row.ours),
                    signed_percent(row.ours / row.printed - 1), row.why});
  }
  const double middle = 4.25e-3 / own.arm;  // of the key positions over which the touch is weighed [rad]
  const std::string closure = fmt::format(
      R"(
The static test weighs the whippen spring too: in this action C_w of the parts less the spring that lifts, C_w +
kappa (theta - theta_0), is {:.4f} N m in the middle of the press, the static test gives {:.4f}. So neither model
here has a spring beside C_w of the static test.
)",
      ours.weight + ours.spring * (middle - ours.spring_rest), ours.static_weight);
  return table({"", "printed", "from Table 2.1 and 2.2", "", "this action", "", "why this action differs"}, rows) +
         closure;
}

std::vector<Contradiction> contradictions() {
  const KeyParts parts = thesis_parts();
  const SimpleAction model = thesis_action(), printed = thesis_action_with_printed_spring();
  const double weight = 0.138;  // C_w, Table 2.2 [N m]
  const double mean = (parts.down_force + parts.up_force) / 2;
  const double lifting = (2 * weight - printed.key.load) / parts.arm;  // the spring's moment at rest turned round
  const double at = 0.8e-3;                                            // y where BH ends, by the text of 2.3 [m]
  return contradictions_of(
      {{"(F_down + F_up) / 2 by (2.6) [N]", mean, printed.key.load / parts.arm,
        "C_w = 0.138 N m and the spring as printed, on the side of the weights"},
       {"the same, the spring lifting the whippen as it does [N]", mean, lifting, "(2.7) holds the spring already"},
       {"y where BH ends, 2.3 [mm]", 1e3 * at, 1e3 * parts.arm * model.takeover_angle,
        "where (2.5) with K = 60 N m reaches F_down"},
       {"K of BH, Table 2.2 [N m]", model.blocked.stiffness, parts.down_force * parts.arm * parts.arm / at,
        "L F_down / theta at y = 0.8 mm; K is an average over three strokes"},
       {"b of the punching over that of the felt, 2.3 [-]", 100, model.rail.damping / thesis::kFeltDamping,
        "b of (4.9), (4.10)"}});
}

}  // namespace erard::study::simple
