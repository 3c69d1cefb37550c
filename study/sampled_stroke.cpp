#include "study/sampled_stroke.hpp"

#include <algorithm>
#include <cmath>

namespace erard::study {

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

TickSettings tick_at(DriveKind drive, double rate_Hz, int internal_steps) {
  TickSettings tick;
  tick.drive = drive;
  tick.set_rate(rate_Hz, internal_steps);
  return tick;
}

SampledStroke play_sampled(const ActionFile& action, const Keystroke& keystroke, const TickSettings& tick) {
  SampledStroke stroke;
  RunSettings settings;
  settings.tick = tick;
  settings.start = keystroke.start();
  settings.duration = keystroke.end() - keystroke.start();
  settings.on_row = [&stroke](const Snapshot& row) { stroke.rows.push_back(row); };
  stroke.result = run(action, keystroke, settings);
  return stroke;
}

const Event* first_event(const std::vector<Event>& events, EventKind kind) {
  const auto found = std::find_if(events.begin(), events.end(), [kind](const Event& e) { return e.kind == kind; });
  return found == events.end() ? nullptr : &*found;
}

}  // namespace erard::study
