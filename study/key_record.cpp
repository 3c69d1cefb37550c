#include "study/key_record.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "erard/device/simulation.hpp"

namespace erard::study::simple {
namespace {

constexpr double kRate = 2000;                            // of the records, as thesis 6.4.1 [Hz]
constexpr double kTail = 0.02;                            // recorded after the release [s]
constexpr double kDepth = 0.0078, kSpeed = 0.006;         // of the slow press [m], [m/s]
constexpr double kTouchFrom = 0.0015, kTouchTo = 0.007;   // touch weight: mean force between these key positions [m]
constexpr double kRatioFrom = 0.0005, kRatioTo = 0.0075;  // lever ratios: between these [m]

double value_of(const ActionFile& action, const std::string& name) {
  for (const Parameter& parameter : action.parameters)
    if (parameter.name == name) return parameter.value;
  throw std::invalid_argument("the action has no parameter " + name);
}

struct Rows {
  std::vector<Snapshot> row;
  RunResult result;
};

/// @param internal_steps  a period; 0: as erard-sim
Rows play(const ActionFile& action, const Keystroke& keystroke, double duration, int internal_steps) {
  Rows rows;
  RunSettings settings;
  settings.tick.set_rate(kRate, internal_steps);
  settings.start = keystroke.start();
  settings.duration = duration;
  settings.on_row = [&rows](const Snapshot& row) { rows.row.push_back(row); };
  rows.result = run(action, keystroke, settings);
  return rows;
}

const Event& event_of(const RunResult& result, EventKind kind) {
  for (const Event& event : result.events)
    if (event.kind == kind) return event;
  throw std::runtime_error(std::string("the stroke has no event ") + name_of(kind));
}

/// Piston down to kDepth and back at kSpeed, in straight lines.
Keystroke slow_press() {
  constexpr int kParts = 260;  // a sample every 5 ms: the spline leaves the lines only near the corners
  const double turn = kDepth / kSpeed;
  std::vector<double> times, values;
  for (int i = 0; i <= 2 * kParts; ++i) {
    times.push_back(turn * i / kParts);
    values.push_back(kDepth * (1 - std::abs(1 - static_cast<double>(i) / kParts)));
  }
  return {KeystrokeQuantity::position, times, values};
}

double mean_force(const std::vector<Snapshot>& rows, double from, double until) {
  double sum = 0;
  int count = 0;
  for (const Snapshot& row : rows) {
    const bool is_touch = row.key_position >= kTouchFrom && row.key_position <= kTouchTo;
    if (!is_touch || row.time < from || row.time > until) continue;
    sum += row.force;
    ++count;
  }
  return sum / count;
}

/// Horizontal lever arm of a point (x, y) of a body that stands at `angle`.
double lever_arm(double x, double y, double angle) { return x * std::cos(angle) - y * std::sin(angle); }

/// Gap of the front rail punching at rest, as an angle of the key [rad].
double rail_angle(const ActionFile& action, double arm) {
  const Keystroke still(KeystrokeQuantity::position, {0, 1 / kRate}, {0, 0});
  const Snapshot rest = play(action, still, 1 / kRate, 0).row.front();
  return -rest.compression[static_cast<std::size_t>(action.roles.front_rail)] / arm;
}

/// What the slow press shows: touch weights and lever ratios.
void press_slowly(const ActionFile& action, KeyParts& parts) {
  const double turn = kDepth / kSpeed;
  const std::vector<Snapshot> rows = play(action, slow_press(), 2 * turn, 1).row;
  parts.down_force = mean_force(rows, 0, turn);
  parts.up_force = mean_force(rows, turn, 2 * turn);
  const auto at = [&rows](double y) {
    return *std::find_if(rows.begin(), rows.end(), [y](const Snapshot& row) { return row.key_position >= y; });
  };
  const Snapshot from = at(kRatioFrom), to = at(kRatioTo);
  const auto turned = [&](const char* body) {
    const auto i = static_cast<std::size_t>(find_body(action.model, body));
    return to.angle[i] - from.angle[i];
  };
  parts.alpha21 = -turned("W") / turned("K");
  parts.alpha31 = turned("H") / turned("K");
}

}  // namespace

KeyRecord record_keystroke(const ActionFile& action, const Keystroke& keystroke, const std::string& name,
                           double release) {
  const Rows rows = play(action, keystroke, release + kTail, 0);
  const auto key = static_cast<std::size_t>(action.model.finger.body);
  const auto hammer = static_cast<std::size_t>(action.roles.hammer);
  KeyRecord record;
  record.name = name;
  for (const Snapshot& row : rows.row) {
    record.motion.time.push_back(row.time);
    record.motion.angle.push_back(row.key_position / action.model.finger.arm);
    record.motion.rate.push_back(-row.rate[key]);
    record.hammer_rate.push_back(-row.rate[hammer]);
    record.force.push_back(row.force);
  }
  record.motion.acceleration = differentiate(record.motion.time, record.motion.rate);
  const Event& let_off = event_of(rows.result, EventKind::jack_meets_let_off);
  record.let_off = let_off.time;
  record.let_off_angle = let_off.key_position / action.model.finger.arm;
  record.rail = event_of(rows.result, EventKind::key_meets_front_rail).time;
  record.release = release;
  return record;
}

KeyParts measure_parts(const ActionFile& action) {
  const auto value = [&action](const std::string& name) { return value_of(action, name); };
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
  press_slowly(action, parts);
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
  const double arm = value_of(action, "K_S+x");
  model.rail = {arm, rail_angle(action, arm), value_of(action, "k_KS+"), value_of(action, "r_KS+"),
                thesis_action().rail.damping};
  return model;
}

}  // namespace erard::study::simple
