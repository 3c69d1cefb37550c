#include "study/simple_key.hpp"

#include <algorithm>
#include <cmath>

#include "study/thesis_numbers.hpp"

namespace erard::study::simple {
namespace {

/// Spring and damper of the punching at one angle: moment = elastic + viscous * rate.
struct RailMoment {
  double elastic = 0;  // [N m]
  double viscous = 0;  // [N m s/rad]
};

RailMoment rail_moment(const Punching& rail, double angle) {
  const double d = rail.arm * (angle - rail.angle);
  if (d <= 0) return {};
  return {rail.arm * rail.stiffness * std::pow(d, rail.exponent), rail.arm * rail.arm * rail.damping * d * d};
}

/// Rate at the end of a step: J (w' - w)/h + c (w + w')/2 + m + C_d Sign(w') = 0 with moments m and losses c.
double next_rate(const OneBody& body, double rate, double moment, double viscous, double step) {
  const double push = (body.inertia / step - 0.5 * viscous) * rate - moment;
  if (std::abs(push) <= body.dry) return 0;
  return (push - std::copysign(body.dry, push)) / (body.inertia / step + 0.5 * viscous);
}

/// Moves the key by one step under its moments.
class Stepper {
 public:
  Stepper(const SimpleAction& action, const KeyStart& start)
      : action_(action), angle_(start.angle), rate_(start.rate), is_blocked_(start.angle < action.takeover_angle) {}

  /// @param force  of the finger in the middle of the step [N]
  void step(double force, double h) {
    angle_ += 0.5 * h * rate_;
    if (is_blocked_ && angle_ >= action_.takeover_angle) take_over();
    const OneBody& body = is_blocked_ ? action_.blocked : action_.key;
    const double moment = body.load + body.stiffness * angle_ - action_.arm * force;
    const RailMoment rail = rail_moment(action_.rail, angle_);
    double next = next_rate(body, rate_, moment + rail.elastic, body.viscous + rail.viscous, h);
    const bool pulls = rail.elastic + rail.viscous * 0.5 * (rate_ + next) < 0;
    if (pulls) next = next_rate(body, rate_, moment, body.viscous, h);
    rate_ = angle_ <= 0 ? std::max(next, 0.0) : next;
    angle_ += 0.5 * h * rate_;
  }

  double angle() const { return angle_; }
  double rate() const { return rate_; }

 private:
  void take_over() {
    is_blocked_ = false;
    if (action_.takeover == Takeover::keeps_momentum) rate_ *= action_.blocked.inertia / action_.key.inertia;
  }

  const SimpleAction& action_;
  double angle_;
  double rate_;
  bool is_blocked_;
};

double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

}  // namespace

KeyParts thesis_parts() {
  KeyParts parts;
  parts.arm = thesis::kArm;
  parts.alpha21 = thesis::kL12 / thesis::kL21;
  parts.alpha31 = parts.alpha21 * thesis::kL23 / thesis::kL32;
  parts.inertia = thesis::kInertia;
  parts.weight = thesis::kWeight;
  parts.viscous = {0.022, 4.93e-5, 4.93e-5};
  parts.key_dry = thesis::kKeyDry;
  parts.spring = 0.087;
  parts.spring_rest = 0.42;
  parts.down_force = thesis::kDownForce;
  parts.up_force = thesis::kUpForce;
  return parts;
}

Equivalents equivalents(const KeyParts& parts) {
  const double a21 = parts.alpha21, a31 = parts.alpha31;
  const auto& [J1, J2, J3] = parts.inertia;
  const auto& [C1, C2, C3] = parts.weight;
  const auto& [c1, c2, c3] = parts.viscous;
  Equivalents one;
  one.inertia = J1 + a21 * a21 * J2 + a31 * a31 * J3;
  one.weight = C1 - a21 * C2 + a31 * C3;
  one.static_weight = parts.arm * (parts.down_force + parts.up_force) / 2;
  one.dry = parts.arm * (parts.down_force - parts.up_force) / 2;
  one.viscous = c1 + a21 * a21 * c2 + a31 * a31 * c3;
  one.spring = a21 * a21 * parts.spring;
  one.spring_rest = parts.spring_rest / a21;
  return one;
}

SimpleAction simple_action(const KeyParts& parts, double stiffness) {
  const Equivalents one = equivalents(parts);
  SimpleAction action;
  action.arm = parts.arm;
  action.blocked = {parts.inertia[0], parts.viscous[0], parts.key_dry, parts.weight[0], stiffness};
  action.key = {one.inertia, one.viscous, one.dry, one.static_weight, 0};
  action.takeover_angle = takeover_angle(action.blocked, action.key);
  return action;
}

SimpleAction thesis_action() {
  SimpleAction action = simple_action(thesis_parts(), 60);
  action.key = {0.0221, 0.0273, 0.039, 0.132, 0};
  action.takeover_angle = takeover_angle(action.blocked, action.key);
  action.rail = {action.arm, 0.0397, 1.6e10, 2.7, 2e9};
  return action;
}

SimpleAction thesis_action_with_printed_spring() {
  constexpr double kKappa = 0.4, kRest = 0.1947;  // [N m/rad], [rad]
  SimpleAction action = thesis_action();
  action.key.load = 0.138 + kKappa * kRest;
  action.key.stiffness = kKappa;
  action.takeover_angle = takeover_angle(action.blocked, action.key);
  return action;
}

double takeover_angle(const OneBody& blocked, const OneBody& key) {
  return (key.load + key.dry - blocked.load - blocked.dry) / (blocked.stiffness - key.stiffness);
}

KeyMotion move(const SimpleAction& action, const Keystroke& force, const std::vector<double>& times,
               const KeyStart& start, double step) {
  KeyMotion motion;
  Stepper body(action, start);
  double now = start.time;
  for (const double time : times) {
    if (time < start.time) continue;
    const int parts = static_cast<int>(std::ceil((time - now) / step - 1e-9));
    const double h = parts > 0 ? (time - now) / parts : 0;
    for (int i = 0; i < parts; ++i) body.step(force.at(now + (i + 0.5) * h).value, h);
    now = time;
    motion.time.push_back(time);
    motion.angle.push_back(body.angle());
    motion.rate.push_back(body.rate());
  }
  return motion;
}

std::vector<double> feel(const SimpleAction& action, const KeyMotion& motion) {
  std::vector<double> force;
  bool is_blocked = true;
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    const double angle = motion.angle[i], rate = motion.rate[i];
    is_blocked = is_blocked && angle < action.takeover_angle;
    const OneBody& body = is_blocked ? action.blocked : action.key;
    const RailMoment rail = rail_moment(action.rail, angle);
    const double moment = body.inertia * motion.acceleration[i] + body.viscous * rate + body.dry * sign(rate) +
                          body.load + body.stiffness * angle + std::max(0.0, rail.elastic + rail.viscous * rate);
    force.push_back(moment / action.arm);
  }
  return force;
}

std::vector<double> differentiate(const std::vector<double>& time, const std::vector<double>& value) {
  const std::size_t n = time.size();
  std::vector<double> rate(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i > 0 ? i - 1 : i, b = i + 1 < n ? i + 1 : i;
    rate[i] = (value[b] - value[a]) / (time[b] - time[a]);
  }
  return rate;
}

std::vector<double> integrate(const std::vector<double>& time, const std::vector<double>& value, double start) {
  std::vector<double> sum(time.size(), start);
  for (std::size_t i = 1; i < time.size(); ++i)
    sum[i] = sum[i - 1] + 0.5 * (time[i] - time[i - 1]) * (value[i] + value[i - 1]);
  return sum;
}

}  // namespace erard::study::simple
