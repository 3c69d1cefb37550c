#include "study/strokes.hpp"

#include <fmt/format.h>

#include <utility>

#include "study/front_rail.hpp"
#include "study/rigid_contact.hpp"

namespace erard::study {
namespace {

std::size_t index_of(const PlayedStroke& stroke, double time) {
  return static_cast<std::size_t>(&stroke.at(time) - stroke.row.data());
}

}  // namespace

DrivenStroke drive_both_ways(const StrokeCase& stroke) {
  constexpr double kAfterRelease = 0.08;  // [s] the jack is back 40 (piano) and 50 ms (forte) after the release
  const double end = stroke.release + kAfterRelease;
  DrivenStroke result;
  result.stroke = stroke;
  result.by_position = play(default_action(), default_keystroke(stroke.name), study_tick(DriveKind::piston), end);
  result.by_force = play(default_action(), force_of(result.by_position), study_tick(DriveKind::force), end);
  return result;
}

ActionFile action_with_rigid_string(double restitution) {
  ActionFile action = default_action();
  remove_felt(action.model, action.roles.string, restitution);
  return action;
}

Impact impact_of(const ActionFile& action, const PlayedStroke& stroke) {
  const auto string = static_cast<std::size_t>(action.roles.string);
  const auto hammer = static_cast<std::size_t>(action.roles.hammer);
  const double radius = action.model.contacts[string].shape_a.centre.norm();
  const auto speed = [&](std::size_t i) { return radius * std::abs(stroke.row[i].rate[hammer]); };
  const std::size_t first = index_of(stroke, stroke.event(EventKind::hammer_meets_string).time);
  std::size_t last = first;
  while (last + 1 < stroke.row.size() && stroke.row[last + 1].normal[string] > 0) ++last;
  return {speed(first - 1), speed(last)};
}

double peak_after_impact(const PlayedStroke& stroke, double end) {
  const double impact = stroke.event(EventKind::hammer_meets_string).time;
  double peak = 0;
  for (const Snapshot& row : stroke.row)
    if (row.time >= impact && row.time <= end) peak = std::max(peak, row.force);
  return peak;
}

LetOffPattern let_off_pattern(const PlayedStroke& stroke) {
  const double let_off = stroke.event(EventKind::jack_meets_let_off).time;
  const double rail = stroke.event(EventKind::key_meets_front_rail).time;
  const auto first = stroke.row.begin() + static_cast<std::ptrdiff_t>(index_of(stroke, let_off));
  const auto last = stroke.row.begin() + static_cast<std::ptrdiff_t>(index_of(stroke, rail + 0.005));
  const auto less = [](const Snapshot& a, const Snapshot& b) { return a.force < b.force; };
  const auto minimum = std::min_element(first, last, less);
  const auto hump = std::max_element(first, minimum, less);
  return {hump->force - first->force, hump->force - minimum->force, minimum->time - rail};
}

RailOscillation rail_oscillation(const ActionFile& action, const PlayedStroke& stroke, double from, double until) {
  constexpr double kLeast = 5e-6;  // [m] above the ripple of hammer and backcheck
  const auto rail = static_cast<std::size_t>(action.roles.front_rail);
  RailOscillation result;
  ForceCurve key;
  for (const Snapshot& row : stroke.row) {
    if (row.time < from || row.time > until) continue;
    result.mean_force += row.force;
    result.compression += row.compression[rail];
    key.time.push_back(row.time);
    key.force.push_back(row.key_position);
  }
  const auto rows = static_cast<double>(key.time.size());
  result.mean_force /= rows;
  result.compression /= rows;
  result.frequency = find_oscillation(key.time, key.force, kLeast).frequency;
  return result;
}

StrokeResults compute_stroke(const StrokeCase& stroke) {
  StrokeResults r{drive_both_ways(stroke), {}};
  const double end = r.driven.by_position.row.back().time;
  const auto add = [&](const std::string& name, const ActionFile& action) {
    r.strings.push_back(
        {name, action, play(action, default_keystroke(stroke.name), study_tick(DriveKind::piston), end)});
  };
  add("felt", default_action());
  const double share = impact_of(r.strings[0].action, r.strings[0].played).share();
  add("rigid, e = 0", action_with_rigid_string(0));
  add(fmt::format("rigid, e = {:.3f}", share), action_with_rigid_string(share));
  add("rigid, e = 1", action_with_rigid_string(1));
  for (const auto& [name, contact] : {std::pair{"felt, no backcheck", "KH"}, std::pair{"felt, no drop screw", "LG"}}) {
    ActionFile action = default_action();
    action.model.contacts[static_cast<std::size_t>(find_contact(action.model, contact))].is_active = false;
    add(name, action);
  }
  return r;
}

}  // namespace erard::study
