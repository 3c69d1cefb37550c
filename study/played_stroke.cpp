#include "study/played_stroke.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace erard::study {

TickSettings tick_at(DriveKind drive, double rate_Hz, int internal_steps) {
  TickSettings tick;
  tick.drive = drive;
  tick.set_rate(rate_Hz, internal_steps);
  return tick;
}

Keystroke sampled_keystroke(KeystrokeQuantity quantity, double duration, double spacing,
                            const std::function<double(double)>& value) {
  const long count = std::lround(duration / spacing) + 1;
  std::vector<double> times, values;
  for (long i = 0; i < count; ++i) {
    times.push_back(static_cast<double>(i) * spacing);
    values.push_back(value(times.back()));
  }
  return {quantity, times, values};
}

const Event* first_event(const std::vector<Event>& events, EventKind kind) {
  const auto found = std::find_if(events.begin(), events.end(), [kind](const Event& e) { return e.kind == kind; });
  return found == events.end() ? nullptr : &*found;
}

const Event& PlayedStroke::event(EventKind kind) const {
  const Event* found = find(kind);
  if (found == nullptr) throw std::runtime_error(fmt::format("a stroke without the event {}", name_of(kind)));
  return *found;
}

const Snapshot& PlayedStroke::at(double time) const {
  const auto later =
      std::lower_bound(row.begin(), row.end(), time, [](const Snapshot& r, double t) { return r.time < t; });
  if (later == row.begin()) return *later;
  if (later == row.end()) return row.back();
  return later->time - time < time - (later - 1)->time ? *later : *(later - 1);
}

PlayedStroke play(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick) {
  return play(action, keystroke, tick, keystroke.end());
}

PlayedStroke play(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick, double end) {
  PlayedStroke stroke;
  RunSettings settings;
  settings.tick = tick;
  settings.start = keystroke.start();
  settings.duration = end - keystroke.start();
  settings.on_row = [&stroke](const Snapshot& row) { stroke.row.push_back(row); };
  stroke.result = run(action, keystroke, settings);
  return stroke;
}

Keystroke force_of(const PlayedStroke& stroke) {
  const ForceCurve force = curve_of(stroke, finger_force);
  return {KeystrokeQuantity::force, force.time, force.force};
}

const Snapshot& hardest_push(const PlayedStroke& stroke) {
  const double end = stroke.event(EventKind::jack_meets_let_off).time;
  const auto last = std::find_if(stroke.row.begin(), stroke.row.end(), [&](const Snapshot& r) { return r.time > end; });
  return *std::max_element(stroke.row.begin(), last,
                           [](const Snapshot& a, const Snapshot& b) { return a.force < b.force; });
}

}  // namespace erard::study
