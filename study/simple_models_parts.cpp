#include "study/simple_models_parts.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace erard::study::simple {
namespace {

std::string difference(double printed, double computed) {
  return fmt::format("{:+.1f}", 100 * (computed / printed - 1));
}

}  // namespace

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
                    has_parts ? difference(row.printed, row.computed) : "", fmt::format("{:.4g}", row.ours),
                    difference(row.printed, row.ours), row.why});
  }
  const double middle = 4.25e-3 / own.arm;  // of the key positions over which the touch is weighed [rad]
  const std::string closure = fmt::format(
      R"(
The static test weighs the whippen spring too: in this action C_w of the parts less the spring that lifts, C_w +
kappa (theta - theta_0), is {:.4f} N m in the middle of the press, the static test gives {:.4f}. So neither model
here has a spring beside C_w of the static test.
)",
      ours.weight + ours.spring * (middle - ours.spring_rest), ours.static_weight);
  return table({"", "printed", "from Table 2.1 and 2.2", "%", "this action", "%", "why this action differs"}, rows) +
         closure;
}

std::string contradiction_table() {
  const KeyParts parts = thesis_parts();
  const SimpleAction model = thesis_action(), printed = thesis_action_with_printed_spring();
  const double weight = 0.138;  // C_w, Table 2.2
  const double mean = (parts.down_force + parts.up_force) / 2;
  const double lifting = (2 * weight - printed.key.load) / parts.arm;  // the spring's moment at rest turned round
  const double at = 0.8e-3;                                            // y where BH ends, by the text of 2.3 [m]
  struct Row {
    const char* quantity;
    double printed, computed;
    const char *unit, *why;
  };
  const std::array all{
      Row{"C_w of the parts", weight, equivalents(parts).weight, "N m",
          "(2.4) with Table 2.1; alpha_31 = 9.88 instead of 10.12 would give it"},
      Row{"(F_down + F_up) / 2", mean, printed.key.load / parts.arm, "N",
          "(2.6) with C_w = 0.138 and the spring as printed, on the side of the weights"},
      Row{"(F_down + F_up) / 2", mean, lifting, "N",
          "the same with the spring lifting the whippen, as it does; (2.7) holds the spring already"},
      Row{"y where BH ends", at, parts.arm * model.takeover_angle, "m", "where (2.5) with K = 60 N m reaches F_down"},
      Row{"K", model.blocked.stiffness, parts.down_force * parts.arm * parts.arm / at, "N m",
          "L F_down / theta at y = 0.8 mm; K is an average over three strokes"},
      Row{"b of the punching over that of the felt", 100, model.rail.damping / 5e7, "-",
          "text of 2.3 against b of (4.9), (4.10)"},
      Row{"kappa_2", parts.spring, 0.0355, "N m", "Table 4.12, the same spring"}};
  std::vector<std::vector<std::string>> rows;
  for (const Row& row : all)
    rows.push_back({row.quantity, fmt::format("{:.3g} {}", row.printed, row.unit), fmt::format("{:.3g}", row.computed),
                    difference(row.printed, row.computed), row.why});
  return table({"quantity", "printed", "computed", "%", "from what, why"}, rows);
}

}  // namespace erard::study::simple
