#include "study/key_record.hpp"

#include <algorithm>
#include <cmath>

#include "study/played_stroke.hpp"
#include "study/touch_weight.hpp"

namespace erard::study::simple {
namespace {

constexpr double kRate = 2000;  // of the records, as thesis 6.4.1 [Hz]
constexpr double kTail = 0.02;  // recorded after the release [s]

/// Horizontal lever arm of a point (x, y) of a body that stands at `angle`.
double lever_arm(double x, double y, double angle) { return x * std::cos(angle) - y * std::sin(angle); }

/// Gap of the front rail punching at rest, as an angle of the key [rad].
double rail_angle(const ActionFile& action, double arm) {
  const Keystroke still(KeystrokeQuantity::position, {0, 1 / kRate}, {0, 0});
  const Snapshot rest = play(action, still, tick_at(DriveKind::piston, kRate)).row.front();
  return -rest.compression[static_cast<std::size_t>(action.roles.front_rail)] / arm;
}

}  // namespace

KeyRecord record_keystroke(const ActionFile& action, const Keystroke& keystroke, const std::string& name,
                           double release) {
  const PlayedStroke played = play(action, keystroke, tick_at(DriveKind::piston, kRate), release + kTail);
  const auto key = static_cast<std::size_t>(action.model.finger.body);
  const auto hammer = static_cast<std::size_t>(action.roles.hammer);
  KeyRecord record;
  record.name = name;
  for (const Snapshot& row : played.row) {
    record.motion.time.push_back(row.time);
    record.motion.angle.push_back(row.key_position / action.model.finger.arm);
    record.motion.rate.push_back(-row.rate[key]);
    record.hammer_rate.push_back(-row.rate[hammer]);
    record.force.push_back(row.force);
  }
  record.motion.acceleration = differentiate(record.motion.time, record.motion.rate);
  const Event& let_off = played.event(EventKind::jack_meets_let_off);
  record.let_off = let_off.time;
  record.let_off_angle = let_off.key_position / action.model.finger.arm;
  record.rail = played.event(EventKind::key_meets_front_rail).time;
  record.release = release;
  return record;
}

KeyParts measure_parts(const ActionFile& action) {
  const auto value = [&action](const std::string& name) { return parameter(action, name); };
  const auto square = [&value](const std::string& point) {
    return value(point + "x") * value(point + "x") + value(point + "y") * value(point + "y");
  };
  // counterclockwise moment of a mass at a point of a body about that body's joint
  const auto weight = [&value](const std::string& mass, const std::string& point, double angle) {
    return -value("g") * value("m_" + mass) * lever_arm(value(point + "x"), value(point + "y"), angle);
  };
  KeyParts parts;
  parts.arm = value("L_finger");
  // jack and lever have their centres of gravity at their joints on the whippen
  const double whippen = value("rest_theta_W");
  parts.inertia = {
      value("I_K"),
      value("I_W") + value("I_J") + value("m_J") * square("J_O") + value("I_L") + value("m_L") * square("L_O"),
      value("I_H")};
  parts.weight = {weight("K", "K_G", value("rest_theta_K")),
                  weight("W", "W_G", whippen) + weight("J", "J_O", whippen) + weight("L", "L_O", whippen),
                  weight("H", "H_G", value("rest_theta_H"))};
  parts.viscous = {value("c_vK"), value("c_vW"), value("c_vH")};
  parts.key_dry = value("c_dK");
  parts.spring = value("kappa_W");
  parts.spring_rest = value("theta0_W") - whippen;
  const PlayedStroke press = press_slowly(action);
  const TouchWeight touch = touch_weight_of(press);
  parts.down_force = touch.down;
  parts.up_force = touch.up;
  const KinematicRatios ratios = kinematic_ratios(action, press);
  parts.alpha21 = ratios.whippen_to_key;
  parts.alpha31 = ratios.hammer_to_key;
  return parts;
}

double blocked_stiffness(const std::vector<KeyRecord>& records, const KeyParts& parts) {
  double products = 0, squares = 0;
  for (const KeyRecord& record : records)
    for (std::size_t i = 0; i < row_of_force(record, parts.down_force); ++i) {
      products += parts.arm * record.force[i] * record.motion.angle[i];
      squares += record.motion.angle[i] * record.motion.angle[i];
    }
  return products / squares;
}

std::size_t row_of_force(const KeyRecord& record, double force) {
  const auto first = std::find_if(record.force.begin(), record.force.end(), [force](double f) { return f >= force; });
  return static_cast<std::size_t>(first - record.force.begin());
}

double carried_from(const KeyRecord& record, double alpha31) {
  double from = record.motion.time.front();
  for (std::size_t i = 0; i < record.motion.time.size() && record.motion.time[i] < record.let_off; ++i) {
    const double carried = alpha31 * record.motion.rate[i];
    if (std::abs(record.hammer_rate[i] - carried) > 0.1 * std::abs(carried)) from = record.motion.time[i];
  }
  return from;
}

SimpleAction action_model(const ActionFile& action, const KeyParts& parts, double stiffness) {
  SimpleAction model = simple_action(parts, stiffness);
  const double arm = parameter(action, "K_S+x");
  model.rail = {arm, rail_angle(action, arm), parameter(action, "k_KS+"), parameter(action, "r_KS+"),
                thesis_action().rail.damping};
  return model;
}

}  // namespace erard::study::simple
