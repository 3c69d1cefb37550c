// What the comparison with the recordings looks like in the document.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/defaults.hpp"
#include "study/figure.hpp"
#include "study/published_curves.hpp"
#include "study/recordings.hpp"

namespace erard::study {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kRecordedLine = "lines lw 1.6 lc rgb '#b05010'";
constexpr const char* kModelLine = "lines lw 1.6 lc rgb '#1050a0'";

/// Median and extremes of what is finite.
struct Spread {
  double low = kNone, middle = kNone, high = kNone;
};
Spread spread_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {values.front(), (values[(n - 1) / 2] + values[n / 2]) / 2, values.back()};
}

/// Predicted against recorded, of many strikes.
struct Ratios {
  Spread mean_speed, peak_speed;         // predicted over recorded [-]
  Spread delay;                          // predicted less recorded, key bottom after hammer [s]
  Spread recorded_rise, predicted_rise;  // highest over mean speed [-]
};
enum class Which { first, later };  // of a recording: from rest, or out of the repetition
Ratios ratios_of(const std::vector<RecordingRun>& runs, Which which) {
  std::vector<double> mean, peak, delay, recorded, predicted;
  for (const RecordingRun& run : runs)
    for (std::size_t i = which == Which::first ? 0 : 1; i < (which == Which::first ? 1 : run.strikes.size()); ++i) {
      const StrikePair& strike = run.strikes[i];
      mean.push_back(strike.predicted.mean_speed / strike.recorded.mean_speed);
      peak.push_back(strike.predicted.peak_speed / strike.recorded.peak_speed);
      delay.push_back(strike.predicted_delay() - strike.recorded_delay());
      recorded.push_back(strike.recorded.peak_speed / strike.recorded.mean_speed);
      predicted.push_back(strike.predicted.peak_speed / strike.predicted.mean_speed);
    }
  return {spread_of(mean), spread_of(peak), spread_of(delay), spread_of(recorded), spread_of(predicted)};
}

/// "s4_fast_strike_A" -> "s4 fast strike A"
std::string title_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Panel overlay(const RecordingRun& run, double from, double until) {
  Curve recorded{"hammer, recorded", {}, {}, kRecordedLine};
  Curve predicted{"hammer, model", {}, {}, kModelLine};
  Curve key{"key, given", {}, {}, "lines lc rgb '#999999'"};
  const int thinning = 1 + static_cast<int>((until - from) / 0.15);  // some 300 points a curve
  int count = 0;
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    if (run.time[i] < from || run.time[i] > until || count++ % thinning != 0) continue;
    for (Curve* curve : {&recorded, &predicted, &key}) curve->x.push_back(run.time[i] * 1e3);
    recorded.y.push_back(run.recorded_hammer[i]);
    predicted.y.push_back(run.predicted_hammer[i]);
    key.y.push_back(run.recorded_key[i]);
  }
  return {title_of(run.recording),
          {"time [ms]"},
          {"part of the way [-]", {-0.2, 1.3}},
          {key, recorded, predicted},
          "top right horizontal"};
}

/// Hammer over key in the very slow press, down to where the jack lets it go.
struct SlowPress {
  std::vector<double> key, recorded, predicted;
  double lead = 0;  // recorded less predicted way of the hammer, mean from half to three quarters of the key's [-]
};
SlowPress slow_press(const RecordingRun& run) {
  constexpr double kLetOff = 0.92;  // of the hammer's way; it is recorded to reach 0.926, and to fall back
  constexpr int kThinning = 60;     // 30 ms
  const double end = rise_time(run.time, run.recorded_hammer, kLetOff, run.time.front(), run.time.back());
  SlowPress press;
  int count = 0;
  for (std::size_t i = 0; run.time[i] < end; ++i) {
    const double key = run.recorded_key[i];
    if (key > 0.5 && key < 0.75) {
      press.lead += run.recorded_hammer[i] - run.predicted_hammer[i];
      ++count;
    }
    if (i % kThinning != 0 || key == 0) continue;
    press.key.push_back(key);
    press.recorded.push_back(run.recorded_hammer[i]);
    press.predicted.push_back(run.predicted_hammer[i]);
  }
  press.lead /= count;
  return press;
}

Panel slow_panel(const SlowPress& press) {
  return {title_of(kSlowRecording) + ": hammer over key",
          {"key, part of the way [-]"},
          {"hammer, part of the way [-]"},
          {{"recorded", press.key, press.recorded, kRecordedLine}, {"model", press.key, press.predicted, kModelLine}},
          "bottom right"};
}

Panel speed_scatter(const std::vector<RecordingRun>& runs) {
  Curve mean{"mean, 60 to 90 % of the way", {}, {}, "points pt 7 ps 0.8 lc rgb '#1050a0'"};
  Curve peak{"highest", {}, {}, "points pt 6 ps 0.8 lc rgb '#b05010'"};
  for (const RecordingRun& run : runs)
    for (const StrikePair& strike : run.strikes) {
      mean.x.push_back(strike.recorded.mean_speed);
      mean.y.push_back(strike.predicted.mean_speed);
      peak.x.push_back(strike.recorded.peak_speed);
      peak.y.push_back(strike.predicted.peak_speed);
    }
  for (Curve* curve : {&mean, &peak})  // gnuplot knows no NaN in x
    for (std::size_t i = 0; i < curve->x.size(); ++i)
      if (!std::isfinite(curve->x[i])) curve->x[i] = 0, curve->y[i] = kNone;
  const std::vector<double> ends{0, 3.2};
  return {"Hammer speed",
          {"recorded [m/s]", {0, 3.2}},
          {"predicted [m/s]", {0, 3.2}},
          {{"equal", ends, ends, "lines lc rgb '#444444'"},
           {"20 % off", ends, {0, 3.84}, "lines dashtype 2 lc rgb '#888888'"},
           {"", ends, {0, 2.56}, "lines dashtype 2 lc rgb '#888888'"},
           mean,
           peak},
          "bottom right"};
}

Panel delay_scatter(const std::vector<RecordingRun>& runs) {
  Curve delays{"strikes", {}, {}, "points pt 7 ps 0.8 lc rgb '#1050a0'"};
  for (const RecordingRun& run : runs)
    for (const StrikePair& strike : run.strikes) {
      delays.x.push_back(strike.recorded_delay() * 1e3);
      delays.y.push_back(strike.predicted_delay() * 1e3);
    }
  return {"Key bottom after hammer",
          {"recorded [ms]", {-2, 8}},
          {"predicted [ms]", {-2, 8}},
          {{"equal", {-2, 8}, {-2, 8}, "lines lc rgb '#444444'"}, delays},
          "top left"};
}

Panel delay_over_speed(const std::vector<RecordingRun>& runs) {
  Panel panel{
      "Key bottom after hammer, over its mean speed", {"hammer [m/s]", {0, 3}}, {"[ms]", {-2, 17}}, {}, "top right"};
  for (const PublishedGrand& grand : published_grands()) {
    const auto dashes = panel.curves.size() + 1;
    Curve curve{std::string(grand.name) + ", published", {}, {}, fmt::format("lines dt {} lc rgb '#444444'", dashes)};
    for (double speed = 0.4; speed <= 3; speed += 0.1) {
      curve.x.push_back(speed);
      curve.y.push_back(1e3 * grand.bottom[static_cast<std::size_t>(Touch::pressed)].at(speed));
    }
    panel.curves.push_back(curve);
  }
  Curve recorded{"recorded", {}, {}, "points pt 6 ps 0.8 lc rgb '#b05010'"};
  Curve predicted{"model", {}, {}, "points pt 7 ps 0.8 lc rgb '#1050a0'"};
  for (const RecordingRun& run : runs)
    for (const StrikePair& strike : run.strikes) {
      if (!std::isfinite(strike.predicted.mean_speed)) continue;
      recorded.x.push_back(strike.recorded.mean_speed);
      recorded.y.push_back(strike.recorded_delay() * 1e3);
      predicted.x.push_back(strike.predicted.mean_speed);
      predicted.y.push_back(strike.predicted_delay() * 1e3);
    }
  panel.curves.push_back(recorded);
  panel.curves.push_back(predicted);
  return panel;
}

std::string strike_table(const std::vector<RecordingRun>& runs, const SlowPress& slow, double blow) {
  std::vector<std::vector<std::string>> rows;
  for (const RecordingRun& run : runs)
    for (std::size_t i = 0; i < run.strikes.size(); ++i) {
      const StrikePair& s = run.strikes[i];
      rows.push_back({run.recording.substr(0, 2) + (run.strikes.size() > 1 ? fmt::format(", {}", i + 1) : ""),
                      fixed(s.recorded.time * 1e3, 1),
                      fmt::format("{}, {}", fixed(s.recorded.from, 2), fixed(s.predicted.from, 2)),
                      fmt::format("{}, {}", fixed(s.recorded.mean_speed, 2), fixed(s.predicted.mean_speed, 2)),
                      fixed(s.predicted.mean_speed / s.recorded.mean_speed, 2),
                      fmt::format("{}, {}", fixed(s.recorded.peak_speed, 2), fixed(s.predicted.peak_speed, 2)),
                      fixed(s.predicted.peak_speed / s.recorded.peak_speed, 2),
                      fmt::format("{}, {}", fixed(s.recorded_delay() * 1e3, 1), fixed(s.predicted_delay() * 1e3, 1)),
                      fixed((s.predicted_delay() - s.recorded_delay()) * 1e3, 1),
                      fixed(-slow.lead * blow / s.predicted.mean_speed * 1e3, 1)});
    }
  return table(
      {"strike", "hammer there [ms]", "lowest in the 60 ms before", "mean speed [m/s]", "ratio", "highest speed [m/s]",
       "ratio", "key bottom after hammer [ms]", "difference", "of the slow press's lead"},
      rows);
}

std::vector<RecordingRun> play_strikes(const ActionFile& action, double dip) {
  std::vector<RecordingRun> runs;
  for (const std::string& name : struck_recordings()) runs.push_back(play_recording(action, name, dip));
  return runs;
}

std::string range(const Spread& spread, int digits, double unit = 1) {
  return fmt::format("{:.{}f} to {:.{}f}", spread.low / unit, digits, spread.high / unit, digits);
}

/// What the scale of the key, which nobody knows to better than this, does to the strikes from rest.
std::string dip_table(const ActionFile& action, const std::vector<RecordingRun>& nominal) {
  std::vector<std::vector<std::string>> rows;
  for (const double dip : {0.0095, 0.0098, 0.0101}) {
    const Ratios ratios = ratios_of(dip == ImportSettings{}.dip ? nominal : play_strikes(action, dip), Which::first);
    rows.push_back({fmt::format("{:.1f}", dip * 1e3), range(ratios.mean_speed, 2), range(ratios.peak_speed, 2),
                    range(ratios.delay, 1, 1e-3)});
  }
  return table({"full scale becomes [mm]", "mean speed, ratio", "highest speed, ratio", "time difference [ms]"}, rows);
}

constexpr const char* kCaveats =
    "- It is another action, a Kawai KG-3C without damper, whose hammer met a stop rail; its blow distance is not "
    "known.\n"
    "  Ways are parts of the whole, and both hammers are given the blow of the model: speeds are good to +-20 %.\n"
    "- The hammer's sensor looks at the shank near the flange (3.77 mm for the whole way), through a polynomial of "
    "degree 6\n"
    "  through eleven ruler marks. It is taken as proportional to the angle. At the stop it clips.\n"
    "- The key's reading is flat near rest and clips at the bottom; 9.8 mm is the model's dip, not that piano's.\n"
    "- Nothing is fitted. With the key given, the time difference is that of the hammer alone.\n";

std::string describe(const std::vector<RecordingRun>& runs, const SlowPress& slow, double blow) {
  const Ratios first = ratios_of(runs, Which::first), later = ratios_of(runs, Which::later);
  return fmt::format(
             "Five recordings of a real grand hold its key and its hammer. The key is given to the model (drive\n"
             "`key`), and its hammer is held against the recorded one. In the four strikes from rest it passes from\n"
             "60 to 90 % of its way at {} of the recorded speed, its highest speed is {} of the\n"
             "recorded, and it arrives {} to {} ms later. In the repeated strikes, in which the two hammers do not\n"
             "start from the same place, the first ratio is {}.\n\n",
             range(first.mean_speed, 2), range(first.peak_speed, 2), fixed(-first.delay.high * 1e3, 1),
             fixed(-first.delay.low * 1e3, 1), range(later.mean_speed, 2)) +
         fmt::format(
             "Two of these differences need no dynamics. In the very slow press the recorded hammer leads the\n"
             "model's by {:.0f} % of the way at the same key, {:.1f} mm at the head; at the speed of each strike that\n"
             "lead is the time in the last column. And the recorded highest speed is {} times the mean in\n"
             "strikes medium and fast alike, the model's {} times: more likely the sensor's curve than the hammer.\n"
             "The mean depends on two readings only. The last plot puts the times among published ones (Goebl,\n"
             "Bresin & Galembo 2005, pressed keys).\n\n",
             slow.lead * 100, slow.lead * blow * 1e3, range(first.recorded_rise, 2),
             fixed(first.predicted_rise.middle, 2));
}

}  // namespace

Section recordings_section(const Pictures& pictures) {
  const ActionFile action = default_action();
  const double blow = measure_hammer_way(action).blow;
  const std::vector<RecordingRun> runs = play_strikes(action, ImportSettings{}.dip);
  const SlowPress slow = slow_press(play_recording(action, kSlowRecording));
  const auto at = [&](const char* name) -> const RecordingRun& {
    return *std::find_if(runs.begin(), runs.end(), [&](const RecordingRun& run) { return run.recording == name; });
  };
  draw(pictures.folder / "recordings_hammer.svg",
       {overlay(at("s2_medium_strike_hold"), 0.29, 0.55), overlay(at("s4_fast_strike_A"), 0.14, 0.24),
        overlay(at("s7_repeated_strikes_x9"), 0.18, 0.72), slow_panel(slow)},
       2, 560, 340);
  draw(pictures.folder / "recordings_strikes.svg", {speed_scatter(runs), delay_scatter(runs), delay_over_speed(runs)},
       3, 400, 380);
  const Ratios first = ratios_of(runs, Which::first);
  const std::string result =
      fmt::format("key given, four hammers from rest: {} of the recorded mean speed, there {} to {} ms later",
                  range(first.mean_speed, 2), fixed(-first.delay.high * 1e3, 1), fixed(-first.delay.low * 1e3, 1));
  return {"Recorded keystrokes: key in, hammer out",
          result,
          describe(runs, slow, blow) + kCaveats +
              fmt::format("\n![Hammers over time, and over the key in the very slow press]({0}/recordings_hammer.svg)\n"
                          "![Predicted against recorded, every strike]({0}/recordings_strikes.svg)\n\n",
                          pictures.link) +
              "Pairs are recorded, model. Ratio and difference: model over, model less recorded.\n\n" +
              strike_table(runs, slow, blow) + "\nThe four strikes from rest, with another scale of the key:\n\n" +
              dip_table(action, runs),
          {}};
}

}  // namespace erard::study
