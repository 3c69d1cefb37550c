#include "study/touch_weight.hpp"

#include <cmath>
#include <numbers>

namespace erard::study {
namespace {

using std::numbers::pi;

constexpr double kSpeed = 0.006, kDepth = 0.0078;         // of the piston [m/s], [m]
constexpr double kTurn = kDepth / kSpeed;                 // [s]
constexpr double kFrom = 0.0015, kTo = 0.007;             // key positions of the mean force [m]
constexpr double kRatioFrom = 0.0005, kRatioTo = 0.0075;  // and of the lever ratios [m]

constexpr double kGravity = 9.81;  // [m/s^2]
using thesis::kAlpha21, thesis::kAlpha31, thesis::kArm;
constexpr double kWeightKey = thesis::kWeight[0], kWeightWhippen = thesis::kWeight[1],
                 kWeightHammer = thesis::kWeight[2];
// thesis Table 5.2
constexpr double kUpsilonWhippen = 1.98, kUpsilonHammer = 1.68;
// thesis Figure 4.23
constexpr double kWhippenAtRest = -0.03;  // [rad]

/// c_d = m g l (Upsilon / 2 pi)^2                                                   thesis (5.7)
double dry_friction(double upsilon, double weight_moment) { return weight_moment * std::pow(upsilon / (2 * pi), 2); }

}  // namespace

PlayedStroke press_slowly(const ActionFile& action) {
  const Keystroke there_and_back = sampled_keystroke(KeystrokeQuantity::position, 2 * kTurn, 5e-3, [](double t) {
    return t < kTurn ? kSpeed * t : kDepth - kSpeed * (t - kTurn);
  });
  return play(action, there_and_back, tick_at(DriveKind::piston, 2000, 1));
}

TouchWeight touch_weight_of(const PlayedStroke& press) {
  TouchWeight sum;
  int downs = 0, ups = 0;
  for (const Snapshot& row : press.row) {
    if (row.key_position < kFrom || row.key_position > kTo) continue;
    (row.time < kTurn ? sum.down : sum.up) += row.force;
    ++(row.time < kTurn ? downs : ups);
  }
  return {sum.down / downs, sum.up / ups};
}

KinematicRatios kinematic_ratios(const ActionFile& action, const PlayedStroke& press) {
  const auto at = [&press](double y) {
    return *std::find_if(press.row.begin(), press.row.end(),
                         [y](const Snapshot& row) { return row.key_position >= y; });
  };
  const Snapshot from = at(kRatioFrom), to = at(kRatioTo);
  const auto turn = [&](const char* body) {
    const auto i = static_cast<std::size_t>(find_body(action.model, body));
    return to.angle[i] - from.angle[i];
  };
  return {-turn("W") / turn("K"), turn("H") / turn("K")};
}

ActionOptions touch_options(const StaticTouch& parameters) {
  ActionOptions options;
  options.settings = {{"kappa_W", parameters.kappa}, {"theta0_W", parameters.rest}};
  for (const Parameter& p : default_action().parameters)
    if (p.name == "c_dK" || p.name == "c_dW" || p.name == "c_dH")
      options.settings.push_back({p.name, parameters.friction * p.value});
  return options;
}

TouchWeight measure_touch_weight(const ActionOptions& options) {
  return touch_weight_of(press_slowly(default_action(options)));
}

TouchWeight static_touch_weight(const StaticTouch& parameters) noexcept {
  const double key_angle = (kFrom + kTo) / 2 / kArm;
  const double whippen_angle = kWhippenAtRest + kAlpha21 * key_angle;
  const double spring = parameters.kappa * (parameters.rest - whippen_angle);
  const double mean = (kWeightKey - kAlpha21 * kWeightWhippen + kAlpha31 * kWeightHammer - kAlpha21 * spring) / kArm;
  const double friction = parameters.friction *
                          (thesis::kKeyDry + kAlpha21 * dry_friction(kUpsilonWhippen, -kWeightWhippen) +
                           kAlpha31 * dry_friction(kUpsilonHammer, kWeightHammer)) /
                          kArm;
  return {mean + friction, mean - friction};
}

namespace {

TouchCase touch_case(const std::string& what, const StaticTouch& parameters) {
  return {what, parameters, measure_touch_weight(touch_options(parameters)), static_touch_weight(parameters)};
}

}  // namespace

std::vector<TouchCase> touch_cases() {
  const StaticTouch printed;
  std::vector<TouchCase> cases{
      touch_case("the thesis's numbers: Tables 2.1, 4.12, 5.2", printed),
      touch_case("no spring at the whippen", {0, printed.rest, 1}),
      touch_case("frictions of key, whippen, hammer x 1.6", {printed.kappa, printed.rest, 1.6}),
      touch_case("no spring, frictions x 1.6", {0, printed.rest, 1.6}),
      touch_case("the spring of Table 2.1: 0.087 N m, 0.42 rad", {0.087, 0.42, 1})};
  // mean falls with the spring, friction rises with its factor, both on straight lines: where they meet the thesis's
  const TouchWeight &with = cases[0].measured, &without = cases[1].measured, &rough = cases[2].measured;
  const double slope = (rough.friction() - with.friction()) / 0.6;
  StaticTouch wanted;
  wanted.friction = 1 + (kThesisTouchWeight.friction() - with.friction()) / slope;
  wanted.kappa = printed.kappa * (without.mean() - kThesisTouchWeight.mean()) / (without.mean() - with.mean());
  cases.push_back(touch_case("what 0.70 and 0.38 N would take", wanted));
  return cases;
}

std::vector<Recomputed> recompute_touch(const TouchWeight& measured) {
  const TouchWeight formula = static_touch_weight({});
  const TouchWeight no_spring = static_touch_weight({.kappa = 0});
  const TouchWeight no_friction = static_touch_weight({.friction = 0});
  return {
      {"F_down [N], 2.2", kThesisTouchWeight.down, measured.down, "played on its other numbers; see the cases below"},
      {"F_up [N], 2.2", kThesisTouchWeight.up, measured.up, "the same"},
      {"C_w from the parts of Table 2.1 [N m], Table 2.2", 0.138, kArm * no_spring.mean(),
       "the parts of Table 2.1 add up to 0.141"},
      {"L (F_down + F_up) / 2 (2.7) [N m], Table 2.2", 0.132, kArm * formula.mean(),
       "(2.7) has no spring; Table 4.12 has"},
      {"L (F_down - F_up) / 2 = C_d (2.8) [N m], Table 2.2", 0.039, kArm * formula.friction(),
       "c_d1 of Table 2.1 and Table 5.2 add up to 0.024"},
      {"kappa of the whippen's spring [N m], Table 2.1", 0.087, thesis::kWhippenSpring, "Table 4.12, the same spring"},
      {"mass that moves the key without dry friction [g], 5.1.1", 15, 1e3 * no_friction.mean() / kGravity,
       "mean of F_down and F_up without friction"}};
}

TouchCurve touch_curve(const ActionOptions& options) {
  TouchCurve curve;
  for (const Snapshot& row : press_slowly(default_action(options)).row) {
    const bool is_down = row.time < kTurn;
    (is_down ? curve.down_y : curve.up_y).push_back(row.key_position);
    (is_down ? curve.down : curve.up).push_back(row.force);
  }
  return curve;
}

}  // namespace erard::study
