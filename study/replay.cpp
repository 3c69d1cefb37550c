#include "study/replay.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace erard::study {

const Event* PlayedStroke::find(EventKind kind) const {
  for (const Event& event : result.events)
    if (event.kind == kind) return &event;
  return nullptr;
}

const Event& PlayedStroke::event(EventKind kind) const {
  const Event* found = find(kind);
  if (found == nullptr) throw std::runtime_error(fmt::format("a stroke without the event {}", name_of(kind)));
  return *found;
}

const Snapshot& PlayedStroke::at(double time) const {
  const long nearest = std::lround((time - row.front().time) * kReplayRate);
  return row[static_cast<std::size_t>(std::clamp(nearest, 0L, static_cast<long>(row.size()) - 1))];
}

PlayedStroke play(const ActionFile& action, const Keystroke& keystroke, DriveKind drive, double end) {
  PlayedStroke stroke;
  RunSettings settings;
  settings.tick.drive = drive;
  settings.tick.set_rate(kReplayRate, 1);
  settings.start = keystroke.start();
  settings.duration = end - keystroke.start();
  settings.on_row = [&stroke](const Snapshot& row) { stroke.row.push_back(row); };
  stroke.result = run(action, keystroke, settings);
  return stroke;
}

Keystroke force_of(const PlayedStroke& stroke) {
  std::vector<double> time, force;
  for (const Snapshot& row : stroke.row) {
    time.push_back(row.time);
    force.push_back(row.force);
  }
  return {KeystrokeQuantity::force, time, force};
}

const Snapshot& hardest_push(const PlayedStroke& stroke) {
  const double end = stroke.event(EventKind::jack_meets_let_off).time;
  const auto last = std::find_if(stroke.row.begin(), stroke.row.end(), [&](const Snapshot& r) { return r.time > end; });
  return *std::max_element(stroke.row.begin(), last,
                           [](const Snapshot& a, const Snapshot& b) { return a.force < b.force; });
}

}  // namespace erard::study
