#include "study/repetition_limit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/played_stroke.hpp"

namespace erard::study {
namespace {

constexpr double kSoftest = 0.18;                   // hammer speed, Goebl et al. 2005 [m/s]
constexpr double kImpactPhase = 0.4;                // of the period, where strokes that sound meet the string [-]
constexpr double kFrom = 8, kStep = 0.5, kTo = 30;  // [Hz]
constexpr int kHalvings = 5;

/// Which strokes sound.
std::vector<bool> find_sounding(const std::vector<Event>& events, double period, int strokes) {
  std::vector<bool> sounds(static_cast<std::size_t>(strokes), false);
  for (const Event& event : events) {
    const auto nth = static_cast<std::size_t>(event.time / period);
    if (event.kind == EventKind::hammer_meets_string && event.hammer_speed >= kSoftest && nth < sounds.size())
      sounds[nth] = true;
  }
  return sounds;
}

/// Whether at `time` the jack has come back under the knuckle since the last impact.
bool is_ready(const std::vector<Event>& events, double time) {
  bool ready = true;  // before the first impact
  for (const Event& event : events) {
    if (event.time > time) break;
    if (event.kind == EventKind::hammer_meets_string) ready = false;
    if (event.kind == EventKind::repetition_ready) ready = true;
  }
  return ready;
}

}  // namespace

RepeatedRun play_repeated(const ActionFile& action, const RepeatedStroke& stroke, double rate_Hz, int strokes) {
  const double period = 1 / rate_Hz;
  const Keystroke swing = sampled_keystroke(KeystrokeQuantity::position, strokes * period, 5e-4, [&](double t) {
    const double top = t < period / 2 ? 0 : stroke.top;
    return top + (stroke.bottom - top) * (1 - std::cos(2 * std::numbers::pi * t / period)) / 2;
  });
  RepeatedRun played;
  RunSettings settings;
  settings.tick = tick_at(DriveKind::piston, 2000);
  settings.duration = swing.end();
  settings.on_row = [&](const Snapshot& row) {
    played.farthest = std::max(played.farthest, -row.compression[static_cast<std::size_t>(action.roles.string)]);
  };
  const std::vector<Event> events = run(action, swing, settings).events;
  const std::vector<bool> sounds = find_sounding(events, period, strokes);
  for (std::size_t i = 0; i < sounds.size(); ++i) {
    played.sounding += sounds[i];
    played.late_jack += !sounds[i] && !is_ready(events, (static_cast<double>(i) + kImpactPhase) * period);
  }
  return played;
}

RepetitionLimit find_repetition_limit(const ActionFile& action, const RepeatedStroke& stroke) {
  RepetitionLimit limit;
  const auto sounds_at = [&](double rate) {
    const RepeatedRun played = play_repeated(action, stroke, rate, kRepeatedStrokes);
    const bool sounds = played.sounding == kRepeatedStrokes;
    (sounds ? limit.rate : limit.beyond) = rate;
    (sounds ? limit.at : limit.failing) = played;
    return sounds;
  };
  for (double rate = kFrom; rate < kTo && sounds_at(rate);) rate += kStep;
  for (int i = 0; i < kHalvings && limit.rate > 0 && limit.beyond > 0; ++i) sounds_at((limit.rate + limit.beyond) / 2);
  return limit;
}

}  // namespace erard::study
