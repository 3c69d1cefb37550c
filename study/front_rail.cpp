#include "study/front_rail.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/played_stroke.hpp"
#include "study/thesis_numbers.hpp"

namespace erard::study {
namespace {

using std::numbers::pi;

using thesis::kArm, thesis::kFeltExponent, thesis::kFeltStiffness;
constexpr double kKeyInertia = thesis::kInertia[0];  // J_1 [kg m^2]
/// Where J_1 weighs 62 g: 0.233 m, squared [m^2].
constexpr double kRailArmSquared = kKeyInertia / kKeyMassAtRail;

/// Time of the extreme of the parabola through three samples, the middle one the extreme of them.
double vertex(const std::vector<double>& time, const std::vector<double>& value, std::size_t i) {
  if (i == 0 || i + 1 >= value.size()) return time[i];
  const double before = value[i - 1] - value[i], after = value[i + 1] - value[i];
  const double bend = before + after;
  return bend == 0 ? time[i] : time[i] + 0.5 * (time[i + 1] - time[i]) * (before - after) / bend;
}

/// Times of the extremes that stand out by `prominence`, alternately highest and lowest.
struct Extremes {
  std::vector<double> highest, lowest;
};
Extremes find_extremes(const std::vector<double>& time, const std::vector<double>& value, double prominence) {
  Extremes extremes;
  std::size_t high = 0, low = 0;
  int towards = 0;  // 1: the last one found was a lowest
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (value[i] > value[high]) high = i;
    if (value[i] < value[low]) low = i;
    if (towards >= 0 && value[i] < value[high] - prominence) {
      if (high > 0) extremes.highest.push_back(vertex(time, value, high));
      towards = -1;
      low = i;
    } else if (towards <= 0 && value[i] > value[low] + prominence) {
      if (low > 0) extremes.lowest.push_back(vertex(time, value, low));
      towards = 1;
      high = i;
    }
  }
  return extremes;
}

}  // namespace

LinearRail linear_rail(double force) noexcept {
  const double compression = std::pow(force / kFeltStiffness, 1 / kFeltExponent);
  return {compression, rail_stiffness(compression)};
}

double rail_stiffness(double compression) noexcept {
  return kFeltStiffness * kFeltExponent * std::pow(compression, kFeltExponent - 1);
}

double ringing_frequency(double stiffness, double mass) noexcept { return std::sqrt(stiffness / mass) / (2 * pi); }

double mass_at_rail(double mass) noexcept { return mass * kArm * kArm / kRailArmSquared; }

double ringing_mass(double stiffness, double frequency) noexcept {
  return stiffness / (4 * pi * pi * frequency * frequency);
}

Oscillation find_oscillation(const std::vector<double>& time, const std::vector<double>& value, double prominence) {
  std::vector<double> smooth = value;
  for (std::size_t i = 1; i + 1 < value.size(); ++i) smooth[i] = (value[i - 1] + value[i] + value[i + 1]) / 3;
  Oscillation oscillation{0, find_extremes(time, smooth, prominence).highest};
  const auto& maxima = oscillation.maxima;
  if (maxima.size() > 1)
    oscillation.frequency = static_cast<double>(maxima.size() - 1) / (maxima.back() - maxima.front());
  return oscillation;
}

StrokeOscillation stroke_oscillation(const std::string& keystroke, double release) {
  const ActionFile action = default_action();
  const PlayedStroke stroke = play(action, default_keystroke(keystroke), tick_at(DriveKind::piston, 2000));
  const double check = stroke.event(EventKind::hammer_checked).time;
  StrokeOscillation result;
  for (const Snapshot& row : stroke.row) {
    if (row.time < check || row.time > release) continue;
    result.time.push_back(row.time);
    result.force.push_back(row.force);
    result.plateau = row.force;
    result.rail = row.normal[static_cast<std::size_t>(action.roles.front_rail)];
    result.check = row.normal[static_cast<std::size_t>(action.roles.backcheck)];
  }
  result.oscillation = find_oscillation(result.time, result.force, 0.02 * result.plateau);
  return result;
}

HeldKey ring_held_key(double force, double mass) {
  constexpr double kRise = 0.8, kKnock = 1.2, kEnd = 1.4;  // [s] the force is there; it is raised; the end
  ActionOptions options;
  options.without = {"KH"};
  options.settings = {{"I_K", kKeyInertia + mass * kArm * kArm}};
  const ActionFile action = default_action(options);
  const Keystroke hold = sampled_keystroke(KeystrokeQuantity::force, kEnd, 5e-4, [force](double t) {
    return t < kRise ? force * (1 - std::cos(pi * t / kRise)) / 2 : t < kKnock ? force : 1.1 * force;
  });
  const PlayedStroke stroke = play(action, hold, tick_at(DriveKind::force, 8000));

  std::vector<double> time, rail;
  for (const Snapshot& row : stroke.row) {
    if (row.time < kKnock) continue;
    time.push_back(row.time);
    rail.push_back(row.normal[static_cast<std::size_t>(action.roles.front_rail)]);
  }
  // the n-th extreme after the knock comes n half periods after it
  const Extremes extremes = find_extremes(time, rail, 0.02 * (rail.back() - rail.front()));
  const std::size_t count = extremes.highest.size() + extremes.lowest.size();
  HeldKey held{mass, rail.back(), 0, 0};
  if (count > 0) {
    const double last = std::max(extremes.highest.empty() ? 0 : extremes.highest.back(),
                                 extremes.lowest.empty() ? 0 : extremes.lowest.back());
    held.frequency = static_cast<double>(count) / (2 * (last - kKnock));
  }
  held.predicted = ringing_frequency(linear_rail(held.rail).stiffness, kKeyMassAtRail + mass_at_rail(mass));
  return held;
}

}  // namespace erard::study
