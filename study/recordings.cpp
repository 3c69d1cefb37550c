#include "study/recordings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "erard/device/config_dir.hpp"
#include "erard/device/error.hpp"
#include "erard/device/simulation.hpp"
#include "erard/mechanics/rest.hpp"

namespace erard::study {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

constexpr double kArrival = 0.98;    // of the way: with it the times published with the recordings come out to a sample
constexpr double kSpeedFrom = 0.6;   // where the mean speed begins: above what a check leaves of the way
constexpr double kSpeedTo = 0.9;     // and ends: the last tenth of the sensor's scale was not calibrated in whole steps
constexpr double kApproach = 0.060;  // [s] before an arrival in which a hammer starts; a forte takes 20, a piano 90
constexpr double kLastPart = 0.020;  // [s] before an arrival in which it is fastest
constexpr double kMatch = 0.020;     // [s] between arrivals that belong together; strikes are 200 ms apart
constexpr double kKeyBottom = 0.999;

std::size_t index_of(const std::vector<double>& time, double t) {
  return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
}

}  // namespace

double rise_time(const std::vector<double>& time, const std::vector<double>& values, double level, double from,
                 double until) {
  for (std::size_t i = std::max<std::size_t>(index_of(time, from), 1); i < time.size() && time[i] <= until; ++i)
    if (values[i - 1] < level && values[i] >= level)
      return time[i - 1] + (level - values[i - 1]) / (values[i] - values[i - 1]) * (time[i] - time[i - 1]);
  return kNone;
}

std::vector<Arrival> find_arrivals(const std::vector<double>& time, const std::vector<double>& way, double blow) {
  std::vector<Arrival> arrivals;
  bool is_due = false;
  for (std::size_t i = 0; i < time.size(); ++i) {
    is_due = is_due || way[i] < kSpeedFrom;
    if (!is_due || way[i] < kArrival) continue;
    is_due = false;
    Arrival arrival;
    const std::size_t begin = index_of(time, time[i] - kApproach);
    arrival.time = rise_time(time, way, kArrival, time[i], time[i]);
    arrival.from = *std::min_element(way.begin() + static_cast<std::ptrdiff_t>(begin),
                                     way.begin() + static_cast<std::ptrdiff_t>(i));
    // the last passages before the arrival: a hammer may have been there before, and fallen back
    double at_from = kNone, at_to = kNone;
    for (std::size_t j = begin + 1; j <= i; ++j) {
      const double t0 = rise_time(time, way, kSpeedFrom, time[j], time[j]);
      const double t1 = rise_time(time, way, kSpeedTo, time[j], time[j]);
      if (!std::isnan(t0)) at_from = t0;
      if (!std::isnan(t1)) at_to = t1;
    }
    arrival.mean_speed = (kSpeedTo - kSpeedFrom) * blow / (at_to - at_from);
    const std::size_t last = index_of(time, time[i] - kLastPart);
    const std::vector<double> part(way.begin() + static_cast<std::ptrdiff_t>(last),
                                   way.begin() + static_cast<std::ptrdiff_t>(i));  // nothing of the rebound
    arrival.peak_speed = blow * peak_speed(part, 1 / (time[1] - time[0]));
    arrivals.push_back(arrival);
  }
  return arrivals;
}

HammerWay measure_hammer_way(const ActionFile& action) {
  const Mechanism mechanism = build_mechanism(action.model);
  TickSettings tick;
  tick.set_rate(2000);
  State state = rest_state(mechanism, tick.scheme.time_step);
  const int hammer = action.roles.hammer;
  const double at_rest = state.x[hammer];
  const auto look = [&](double coordinate) {
    state.x[hammer] = coordinate;
    return take_snapshot(mechanism, state, {}, 0);
  };
  const auto angle = [&](double coordinate) { return look(coordinate).angle[static_cast<std::size_t>(hammer)]; };
  const auto gap = [&](double coordinate) {
    return -look(coordinate).compression[static_cast<std::size_t>(action.roles.string)];
  };
  // Newton's method on the gap, which is all but linear in the angle
  double x = at_rest;
  for (int i = 0; i < 20; ++i) x -= gap(x) / ((gap(x + 1e-6) - gap(x - 1e-6)) / 2e-6);
  const Contact& contact = action.model.contacts[static_cast<std::size_t>(action.roles.string)];
  const Shape& head = contact.body_a == hammer ? contact.shape_a : contact.shape_b;
  return {angle(at_rest), angle(x), head.centre.norm() * std::abs(x - at_rest)};
}

RecordingRun play_recording(const ActionFile& action, const std::string& name, double dip) {
  const std::filesystem::path file = config_dir() / "recordings" / (name + ".csv");
  const Recording recording = read_recording(file);
  if (recording.hammer.empty())
    throw InputError(file.string() + ": has no hammer_sensor_mm, which this study compares");
  ImportSettings import;
  import.dip = dip;
  const Keystroke keystroke = import_recording(recording, import, file).keystroke;
  const HammerWay way = measure_hammer_way(action);

  RecordingRun played;
  played.recording = name;
  played.time = recording.times;
  for (const double reading : recording.key_front) played.recorded_key.push_back(reading / import.full_scale);
  for (const double reading : recording.hammer) played.recorded_hammer.push_back(reading / kHammerFullScale);
  RunSettings settings;
  settings.tick.drive = DriveKind::key;
  settings.tick.set_rate(recording.rate);
  settings.start = keystroke.start();
  settings.duration = keystroke.end() - keystroke.start();
  settings.on_row = [&](const Snapshot& row) {
    played.predicted_key.push_back(row.key_position / dip);
    played.predicted_hammer.push_back(way.fraction(row.angle[static_cast<std::size_t>(action.roles.hammer)]));
  };
  run(action, keystroke, settings);

  const std::vector<Arrival> predicted = find_arrivals(played.time, played.predicted_hammer, way.blow);
  for (const Arrival& arrival : find_arrivals(played.time, played.recorded_hammer, way.blow)) {
    StrikePair pair{arrival, {kNone, kNone, kNone, kNone}, kNone, kNone};
    for (const Arrival& candidate : predicted)
      if (std::abs(candidate.time - arrival.time) < kMatch) pair.predicted = candidate;
    const double from = arrival.time - kMatch, until = arrival.time + kMatch;
    pair.recorded_bottom = rise_time(played.time, played.recorded_key, kKeyBottom, from, until);
    pair.predicted_bottom = rise_time(played.time, played.predicted_key, kKeyBottom, from, until);
    played.strikes.push_back(pair);
  }
  return played;
}

const std::vector<std::string>& struck_recordings() {
  static const std::vector<std::string> names{"s2_medium_strike_hold", "s3_fast_strike_free_release",
                                              "s4_fast_strike_A", "s7_repeated_strikes_x9"};
  return names;
}

}  // namespace erard::study
