#include "study/thesis_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "erard/mechanics/felt_law.hpp"
#include "study/front_rail.hpp"
#include "study/played_stroke.hpp"
#include "study/thesis_numbers.hpp"
#include "study/touch_weight.hpp"

namespace erard::study {
namespace {

using std::numbers::pi;

constexpr double kYoung = 1e10;      // E of wood, thesis 4.2.3 [Pa]
constexpr double kDensity = 1000;    // rho [kg/m3]
constexpr double kStrokeTime = .05;  // tau [s]

/// m B_G of a body about its own origin [kg m].
Vector2 first_moment(const ActionFile& action, const std::string& body) {
  return parameter(action, "m_" + body) * Vector2(parameter(action, body + "_Gx"), parameter(action, body + "_Gy"));
}

/// m g l of a body [N m]; a body of the whippen whose centre of gravity is its pivot is there with all its mass.
double weight_moment(const ActionFile& action, const std::string& body) {
  Vector2 moment = first_moment(action, body);
  if (body == "W")
    for (const std::string part : {"J", "L"})
      moment +=
          parameter(action, "m_" + part) * Vector2(parameter(action, part + "_Ox"), parameter(action, part + "_Oy"));
  return parameter(action, "g") * moment.norm();
}

double second_moment(const ClampedBeam& beam) { return beam.width * std::pow(beam.height, 3) / 12; }  // I [m^4]

Felt common_felt() {
  Felt felt;
  felt.stiffness = thesis::kFeltStiffness;
  felt.exponent = thesis::kFeltExponent;
  felt.damping = thesis::kFeltDamping;
  return felt;
}

}  // namespace

const std::array<ClampedBeam, 6>& table_4_1() {
  // E and rho as the thesis takes them; the last two columns are ours
  static constexpr const char* kCut = "cut, not rounded, to one digit";
  static constexpr const char* kRounded = "rounded to one digit";
  static const std::array<ClampedBeam, 6> beams{
      {{"key", .380, .015, .025, 10, .002, .230, kCut, ""},
       {"whippen", .060, .010, .008, 20, .005, .020, kCut, kRounded},
       {"jack", .025, .005, .005, 30, .012, .004, "", kCut},
       {"lever", .030, .005, .005, 10, .008, .007, "0.0082 with 14 N, what the lever arms make of 10 N at the finger",
        ""},
       {"hammer", .130, .005, .005, 30, .300, .130, kCut, ""},
       {"damper", .070, .010, .020, 10, .0002, .010, kCut, kRounded}}};
  return beams;
}

double relative_deflection(const ClampedBeam& beam) noexcept {
  return beam.force * beam.length * beam.length / (3 * kYoung * second_moment(beam));
}

double first_frequency(const ClampedBeam& beam) noexcept {
  const double area = beam.width * beam.height;
  return 1.875 * 1.875 / (2 * pi * beam.length * beam.length) *
         std::sqrt(kYoung * second_moment(beam) / (kDensity * area));
}

double relative_period(const ClampedBeam& beam) noexcept { return 1 / (first_frequency(beam) * kStrokeTime); }

LeverForces lever_forces(double finger_force) noexcept {
  using namespace thesis;
  return {finger_force * kArm / kL12, finger_force * kArm / (kAlpha31 * kL32)};
}

double upsilon(double dry, double weight_moment) noexcept {
  return weight_moment > 0 ? 2 * pi * std::sqrt(dry / weight_moment) : std::numeric_limits<double>::infinity();
}

std::array<Recomputed, 6> table_5_2(const ActionFile& action) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<Recomputed, 6> table{{{"key", 3.51, 0, "c_d = 0.012 and m g l = 0.0155 N m of Table 2.1 do not give it"},
                                   {"whippen", 1.98, 0, ""},
                                   {"jack", kInfinity, 0, ""},
                                   {"lever", kInfinity, 0, ""},
                                   {"hammer", 1.68, 0, ""},
                                   {"damper", 1.26, 0, ""}}};
  const std::array<std::string, 6> bodies{"K", "W", "J", "L", "H", "D"};
  for (std::size_t i = 0; i < table.size(); ++i)
    table[i].computed = upsilon(parameter(action, "c_d" + bodies[i]), weight_moment(action, bodies[i]));
  return table;
}

FeltEnergies press_felt(double compression, double duration) {
  Felt lossless = common_felt();
  lossless.damping = 0;
  // work of the law, in steps in which its mean force is exact
  constexpr int kSteps = 1000;
  FeltEnergies energies{compression};
  for (int i = 0; i < kSteps; ++i) {
    const double d0 = compression * i / kSteps, d1 = compression * (i + 1) / kSteps;
    energies.work += mean_felt_force(common_felt(), d0, d1, duration / kSteps).force * (d1 - d0);
    energies.stored += mean_felt_force(lossless, d0, d1, duration / kSteps).force * (d1 - d0);
  }
  energies.lost = energies.work - energies.stored;
  return energies;
}

FeltEnergies front_rail_energies(const ActionFile& action, const std::string& keystroke) {
  const auto rail = static_cast<std::size_t>(action.roles.front_rail);
  const PlayedStroke stroke = play(action, default_keystroke(keystroke), tick_at(DriveKind::piston, 16000));
  const Felt& felt = action.model.contacts[rail].felt;
  FeltEnergies energies;
  for (std::size_t i = 1; i < stroke.row.size(); ++i) {
    const double d0 = std::max(0.0, stroke.row[i - 1].compression[rail]);
    const double d1 = std::max(0.0, stroke.row[i].compression[rail]);
    if (d1 == 0) continue;
    if (d1 <= d0) break;
    const double middle = (d0 + d1) / 2, rate = (d1 - d0) / (stroke.row[i].time - stroke.row[i - 1].time);
    energies.compression = d1;
    energies.stored = felt_energy(felt, d1);
    energies.lost += felt.damping * middle * middle * rate * (d1 - d0);
    energies.work += stroke.row[i].normal[rail] * (d1 - d0);
  }
  return energies;
}

std::vector<Recomputed> recompute_tables(const ActionFile& action) {
  std::vector<Recomputed> all;
  for (const ClampedBeam& beam : table_4_1()) {
    const std::string of = std::string(" of the ") + beam.body + ", Table 4.1";
    all.push_back({"delta / L" + of, beam.printed_deflection, relative_deflection(beam), beam.why_deflection});
    all.push_back({"1 / (f_1 tau)" + of, beam.printed_period, relative_period(beam), beam.why_period});
  }
  const KinematicRatios ratios = kinematic_ratios(action, press_slowly(action));
  all.push_back({"alpha_21, whippen to key, Table 2.1", thesis::kAlpha21, ratios.whippen_to_key, ""});
  all.push_back({"alpha_31, hammer to key, Table 2.1", thesis::kAlpha31, ratios.hammer_to_key, ""});
  for (const Recomputed& row : table_5_2(action))
    all.push_back({"Upsilon of the " + row.quantity + ", Table 5.2", row.printed, row.computed, row.why});
  all.push_back({"W_elastic / W_viscous (4.11)", 22, press_felt(1e-3, 0.1).ratio(),
                 "1 mm in 10 ms instead of 0.1 s would give 20.6"});
  for (const auto& [force, millimetres, frequency] : {std::tuple{3.5, 0.26, 121.0}, {9.0, 0.38, 167.0}}) {
    const LinearRail rail = linear_rail(force);
    const std::string at = " of the front rail at " + std::string(force < 9 ? "3.5" : "9") + " N";
    all.push_back({"compression" + at + " [mm] (4.4)", millimetres, 1e3 * rail.compression, ""});
    all.push_back({"frequency" + at + " [Hz] (6.2)", frequency, ringing_frequency(rail.stiffness, kKeyMassAtRail),
                   "the rounded 0.38 mm gives 164.5"});
  }
  return all;
}

}  // namespace erard::study
