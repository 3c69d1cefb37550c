#include "study/work_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "erard/mechanics/rest.hpp"
#include "study/played_stroke.hpp"

namespace erard::study {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Way of a smooth motion, 0 to 1, velocity and acceleration zero at both ends.
double quintic(double part) {
  const double s = std::clamp(part, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

/// Down by 13.5 mm in 34 ms, so hard that the key is at its bottom 24 ms after its start, and up again.
Keystroke very_fast_stroke() {
  return sampled_keystroke(KeystrokeQuantity::position, 0.2, 5e-4, [](double t) {
    return 0.0135 * (quintic((t - 0.005) / 0.034) - quintic((t - 0.1) / 0.06));
  });
}

StepReport take_step(Playing& playing, State& state, double length, double theta) {
  Scheme scheme;
  scheme.time_step = length;
  scheme.theta = theta;
  const Drive drive{DriveKind::piston, playing.input.at(state.time), playing.input.at(state.time + length)};
  return step(*playing.mechanism, scheme, drive, state, *playing.work);
}

double force_now(const Playing& playing) {
  return piston_force(playing.mechanism->model, playing.state, playing.input.at(playing.state.time));
}

void take_and_watch(Playing& playing, double length, double theta) {
  const StepReport report = take_step(playing, playing.state, length, theta);
  playing.watch(playing.state, report, force_now(playing));
}

bool have_same_contacts(const State& a, const State& b) {
  return ((a.impulse.array() > 0) == (b.impulse.array() > 0)).all();
}

/// The event of the same kind nearest to this one, within 20 ms (strikes of one key are 100 ms apart), or null.
const Event* nearest(const std::vector<Event>& events, const Event& to) {
  const Event* found = nullptr;
  double least = 0.020;  // [s]
  for (const Event& event : events) {
    const double apart = std::abs(event.time - to.time);
    if (event.kind == to.kind && apart < least) least = apart, found = &event;
  }
  return found;
}

/// Length of a step, as its tables name it.
std::string microseconds(double step) { return fmt::format("{:g} us", 1e6 * step); }

}  // namespace

std::vector<JudgedStroke> judged_strokes() {
  const auto recorded = [](const char* name, double end) {
    return JudgedStroke{name, default_keystroke(name), end, 0, end};
  };
  return {{"piano", default_keystroke("piano"), 0.220, 0.139, 0.30},
          {"forte", default_keystroke("forte"), 0.142, 0.088, 0.25},
          {"very fast", very_fast_stroke(), 0.1, 0.045, 0.2},
          {"repetition", default_keystroke("repetition"), 0.8, 0, 0.8},
          recorded("recorded_fast", 1.2),
          recorded("recorded_fast_free_release", 2.0),
          recorded("recorded_medium", 2.4),
          recorded("recorded_repeated", 2.1),
          recorded("recorded_very_slow", 10.8)};
}

JudgedStroke judged_stroke(const std::string& name) {
  for (const JudgedStroke& stroke : judged_strokes())
    if (stroke.name == name) return stroke;
  throw std::invalid_argument("no judged stroke " + name);
}

Candidate ticking(std::string family, std::string setting, const TickSettings& settings) {
  return {std::move(family), std::move(setting), settings.period, [settings](Playing& playing) {
            tick(*playing.mechanism, settings, playing.input, playing.state, *playing.work, playing.watch);
          }};
}

Candidate fixed_steps(double theta, double step) {
  TickSettings settings;
  const double period = std::max(step, kOutputPeriod);
  settings.set_rate(1 / period, static_cast<int>(std::lround(period / step)));
  settings.scheme.theta = theta;
  return ticking(fmt::format("theta {:g}, fixed", theta), microseconds(step), settings);
}

TickSettings surprised_steps(double calm, double surprise_limit, int refinement) {
  TickSettings settings;
  settings.set_rate(1 / kOutputPeriod, static_cast<int>(std::lround(kOutputPeriod / calm)));
  settings.refinement = refinement;
  settings.scheme.surprise_limit = surprise_limit;
  return settings;
}

Candidate fractional_steps(int count) {
  return {"fractional-step theta", microseconds(kOutputPeriod / (3 * count)), kOutputPeriod, [count](Playing& playing) {
            const double c = 1 - std::sqrt(0.5), alpha = (1 - 2 * c) / (1 - c);
            const double h = kOutputPeriod / count;
            for (int i = 0; i < count; ++i) {
              take_and_watch(playing, c * h, alpha);
              take_and_watch(playing, (1 - 2 * c) * h, 1 - alpha);
              take_and_watch(playing, c * h, alpha);
            }
          }};
}

Candidate extrapolated_steps(int count) {
  return {"Richardson", microseconds(kOutputPeriod / (2 * count)), kOutputPeriod, [count](Playing& playing) {
            const double h = kOutputPeriod / count;
            for (int i = 0; i < count; ++i) {
              State coarse = playing.state;
              take_step(playing, coarse, h, 0.5);
              take_and_watch(playing, h / 2, 0.5);
              const State middle = playing.state;
              take_and_watch(playing, h / 2, 0.5);
              State& fine = playing.state;
              if (!have_same_contacts(coarse, fine) || !have_same_contacts(middle, fine)) continue;
              fine.x += (fine.x - coarse.x) / 3;
              fine.v += (fine.v - coarse.v) / 3;
              fine.compression = (fine.compression + (fine.compression - coarse.compression) / 3).cwiseMax(0);
            }
          }};
}

Candidate converged_steps(int count) {
  TickSettings settings;
  settings.set_rate(1 / kOutputPeriod, count);
  settings.scheme.newton_limit = 40;
  settings.scheme.newton_tolerance = 1e-6;
  settings.scheme.placement_tolerance = 1e-3;
  settings.scheme.sweep_tolerance = 1e-9;
  return ticking("converged", fmt::format("{} steps", count), settings);
}

JudgedRun play_judged(const ActionFile& action, const JudgedStroke& stroke, const Candidate& candidate, int repeats) {
  using Clock = std::chrono::steady_clock;
  const Mechanism mechanism = build_mechanism(action.model);
  const auto periods = static_cast<std::size_t>(std::lround(stroke.played / candidate.period));
  const double ticks = stroke.played / kOutputPeriod;
  Playing playing{&mechanism, {&stroke.keystroke}, {}};
  JudgedRun run;
  run.period = candidate.period;
  std::vector<double> spent(periods, kNever);  // [us]
  for (int repeat = 0; repeat <= repeats; ++repeat) {
    const bool is_first = repeat == 0;
    EventDetector detector(mechanism, action.roles);
    playing.state = rest_state(mechanism, TickSettings{}.scheme.time_step);
    playing.watch = {is_first ? &detector : nullptr};
    const auto note = [&] {
      if (!is_first) return;
      run.force.push_back(force_now(playing));
      run.key.push_back(key_position(mechanism.model, playing.state));
    };
    note();
    for (std::size_t i = 0; i < periods; ++i) {
      const auto before = Clock::now();
      candidate.advance(playing);
      if (!is_first) spent[i] = std::min(spent[i], 1e6 * std::chrono::duration<double>(Clock::now() - before).count());
      playing.state.time = static_cast<double>(i + 1) * candidate.period;  // no drift by rounding
      note();
    }
    if (!is_first) continue;
    detector.finish();
    for (int i = 0; i < detector.count(); ++i) run.events.push_back(detector[i]);
    run.steps = static_cast<double>(playing.watch.steps) / ticks;
    run.unconverged = playing.watch.unconverged;
  }
  if (repeats == 0) return run;
  for (const double time : spent) {
    run.cost += time / ticks;
    run.worst = std::max(run.worst, time);
  }
  return run;
}

ForceError force_error(const JudgedRun& run, const JudgedRun& truth, double end) {
  const auto stride = static_cast<std::size_t>(std::lround(run.period / truth.period));
  ForceError error;
  double whole = 0, count = 0;
  for (std::size_t i = 0; i < run.force.size() && i * stride < truth.force.size(); ++i) {
    if (static_cast<double>(i) * run.period > end + 1e-9) break;
    const double expected = truth.force[i * stride];
    const double difference = std::abs(run.force[i] - expected);
    error.eta += difference;
    error.rms += difference * difference;
    error.largest = difference <= error.largest ? error.largest : difference;  // a NaN is the largest
    whole += std::abs(expected);
    ++count;
  }
  return {error.eta / whole, std::sqrt(error.rms / count), error.largest};
}

EventError event_error(const JudgedRun& run, const JudgedRun& truth) {
  EventError error;
  for (const Event& expected : truth.events) {
    const Event* found = nearest(run.events, expected);
    if (found != nullptr && nearest(truth.events, *found) != &expected) found = nullptr;
    if (found == nullptr) {
      ++error.missing;
      continue;
    }
    ++error.compared;
    const double late = found->time - expected.time;
    error.beyond += std::abs(late) > 2.5e-4;
    if (std::abs(late) > std::abs(error.time)) error.time = late, error.worst = expected.kind;
    if (expected.kind != EventKind::hammer_meets_string) continue;
    const double fast = found->hammer_speed / expected.hammer_speed - 1;
    if (std::abs(fast) > std::abs(error.speed)) error.speed = fast, error.speed_at = expected.hammer_speed;
  }
  return error;
}

RailRinging rail_ringing(const JudgedRun& run, double from, double until) {
  constexpr double kLeast = 5e-6;  // [m] above the ripple of hammer and backcheck
  const auto& y = run.key;
  const auto first = static_cast<std::size_t>(std::lround(from / run.period));
  const auto last = static_cast<std::size_t>(std::lround(until / run.period));
  std::vector<double> time, height;
  std::size_t turn = first;
  double sign = 1;
  for (std::size_t i = first; i <= last; ++i) {
    if (sign * (y[i] - y[turn]) > 0) turn = i;
    if (sign * (y[i] - y[turn]) > -kLeast) continue;
    if (turn > first) {
      const double slope = (y[turn + 1] - y[turn - 1]) / 2, bend = y[turn + 1] - 2 * y[turn] + y[turn - 1];
      time.push_back((static_cast<double>(turn) - slope / bend) * run.period);
      height.push_back(y[turn] - slope * slope / (2 * bend));
    }
    sign = -sign;
    turn = i;
  }
  RailRinging ringing{static_cast<int>(time.size()), 0, 0};
  if (time.size() < 2) return ringing;
  const auto intervals = static_cast<double>(time.size() - 1);
  ringing.frequency = intervals / (2 * (time.back() - time.front()));
  for (std::size_t i = 1; i < height.size(); ++i)
    ringing.amplitude += std::abs(height[i] - height[i - 1]) / 2 / intervals;
  return ringing;
}

}  // namespace erard::study
