#include "study/stroke_times.hpp"

#include <algorithm>
#include <cmath>

#include "study/played_stroke.hpp"

namespace erard::study {
namespace {

constexpr double kRounding = 1e-9;  // instants of events and rows are the same but for rounding [s]

/// First time at which the key passes `level`, by the straight line between two rows.
double passes(const StrokeTrace& trace, double level) {
  for (std::size_t i = 1; i < trace.key.size(); ++i)
    if (trace.key[i - 1] < level && trace.key[i] >= level)
      return trace.time[i - 1] +
             (trace.time[i] - trace.time[i - 1]) * (level - trace.key[i - 1]) / (trace.key[i] - trace.key[i - 1]);
  return StrokeTimes::kNone;
}

/// First row after `from` in which the key has half the speed of then.
double half_speed(const StrokeTrace& trace, double from) {
  const auto start = static_cast<std::size_t>(std::lower_bound(trace.time.begin(), trace.time.end(), from - kRounding) -
                                              trace.time.begin());
  for (std::size_t i = start; i < trace.time.size(); ++i)
    if (trace.key_speed[i] <= trace.key_speed[start] / 2) return trace.time[i];
  return StrokeTimes::kNone;
}

/// Way of the hammer between two instants, by the trapezoid rule over the rows between them.
double hammer_way(const StrokeTrace& trace, double from, double until) {
  double way = 0;
  for (std::size_t i = 1; i < trace.time.size(); ++i)
    if (trace.time[i - 1] >= from - kRounding && trace.time[i] <= until + kRounding)
      way += (trace.time[i] - trace.time[i - 1]) * (trace.hammer_speed[i - 1] + trace.hammer_speed[i]) / 2;
  return way;
}

}  // namespace

StrokeTimes time_stroke(const StrokeTrace& trace, const std::vector<Event>& events, double key_start) {
  StrokeTimes times;
  times.finger_key = passes(trace, key_start);
  if (const Event* string = first_event(events, EventKind::hammer_meets_string)) {
    times.hammer_string = string->time;
    times.string_speed = string->hammer_speed;
  }
  if (const Event* escapement = first_event(events, EventKind::escapement)) times.escapement = escapement->time;
  if (const Event* rail = first_event(events, EventKind::key_meets_front_rail)) {
    times.key_bottom = rail->time;
    times.key_braked = half_speed(trace, rail->time);
  }
  if (std::isnan(times.hammer_string)) return times;
  times.free_way = hammer_way(trace, times.escapement, times.hammer_string);
  for (std::size_t i = 0; i < trace.time.size() && trace.time[i] < times.hammer_string; ++i) {
    if (trace.hammer_speed[i] <= times.maximum_speed) continue;  // false for the first, while there is none
    times.maximum_speed = trace.hammer_speed[i];
    times.fastest = trace.time[i];
  }
  return times;
}

TracedStroke trace_stroke(const ActionFile& action, const Keystroke& keystroke, DriveKind drive) {
  const Model& model = action.model;
  const Contact& string = model.contacts[static_cast<std::size_t>(action.roles.string)];
  const Shape& head = string.body_a == action.roles.hammer ? string.shape_a : string.shape_b;
  const double radius = head.centre.norm();
  const auto hammer = static_cast<std::size_t>(action.roles.hammer), key = static_cast<std::size_t>(model.finger.body);
  TracedStroke stroke;
  const PlayedStroke played = play(action, keystroke, study_tick(drive));
  for (const Snapshot& row : played.row) {
    stroke.trace.time.push_back(row.time);
    stroke.trace.key.push_back(row.key_position);
    stroke.trace.key_speed.push_back(-model.finger.arm * row.rate[key]);
    // clockwise is up: the head lies left of its pivot
    stroke.trace.hammer_speed.push_back(-radius * row.rate[hammer]);
  }
  stroke.events = played.result.events;
  return stroke;
}

}  // namespace erard::study
