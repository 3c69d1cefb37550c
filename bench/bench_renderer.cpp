// What the pipeline between position message and force costs and withstands. Writes the tables of docs/device.md:
//   build/release/bin/bench_renderer
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "erard/device/config_dir.hpp"
#include "erard/device/device_file.hpp"
#include "erard/device/action_file.hpp"
#include "erard/device/keystroke.hpp"

namespace {

using namespace erard;
using Clock = std::chrono::steady_clock;

/// config/device.yaml, without an actuator between the force and whoever looks at it.
RenderSettings settings_of_file() {
  static const DeviceSettings file = load_device(config_dir() / "device.yaml");
  RenderSettings settings = file.rendering;
  settings.actuator.kind = ActuatorKind::none;
  return settings;
}
const ActionFile& action() {
  static const ActionFile loaded = load_action(config_dir() / "grand_action.yaml");
  return loaded;
}
Keystroke keystroke(const std::string& name) { return read_keystroke(config_dir() / "keystrokes" / (name + ".csv")); }

RateEstimatorSettings difference(int order) { return {RateEstimatorKind::sliding_polynomial, order + 1, order, 0, 0}; }

/// A device that sends a position every period.
class Device {
 public:
  explicit Device(const RenderSettings& settings)
      : renderer_(action().model, action().roles, settings),
        period_(std::llround(settings.tick.period * 1e9)),
        positions_(static_cast<std::size_t>(settings.keys)) {}

  std::vector<double>& positions() { return positions_; }
  const PeriodOutput& send() {
    const PositionMessage message{1, ++sequence_, time_ += period_, positions_};
    return renderer_.period({time_ + 150'000, std::span(&message, 1)});
  }
  const PeriodOutput& play(double position) {
    positions_.assign(positions_.size(), position);
    return send();
  }
  const PeriodOutput& lose() {
    ++sequence_;
    time_ += period_;
    return renderer_.period({time_ + 150'000, {}});
  }

 private:
  Renderer renderer_;
  std::int64_t period_, time_ = 0, sequence_ = 0;  // [ns]
  std::vector<double> positions_;
};

void cost_at_rest() {
  fmt::print(
      "| 88 keys at rest | noise [um] | asleep | a period p50 [us] | p99 | a key p50 [ns] "
      "|\n|---|---|---|---|---|---|\n");
  for (const auto& [what, position] : {std::pair{"released", 0.0}, std::pair{"held down", 0.009}})
    for (const double noise : {0.0, 5e-5}) {
      RenderSettings settings = settings_of_file();
      settings.keys = 88;
      settings.actuator.kind = ActuatorKind::voice_coil;
      Device device(settings);
      std::mt19937 random(1);
      std::normal_distribution<double> normal(0, 1);
      std::vector<double> times;
      int asleep = 0;
      for (int i = 0; i < 12000; ++i) {
        for (double& p : device.positions()) p = position + noise * normal(random);
        const auto start = Clock::now();
        asleep = device.send().asleep;
        if (i >= 8000) times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
      }
      std::sort(times.begin(), times.end());
      const double median = times[times.size() / 2];
      fmt::print("| {} | {:.0f} | {} | {:.2f} | {:.2f} | {:.0f} |\n", what, 1e6 * noise, asleep, median,
                 times[times.size() * 99 / 100], 1e3 * median / 88);
    }
}

/// Reserve that a stroke takes when it is played as recorded, whatever the force: mJ, and whether 2 mJ were enough.
void reserve_of_strokes() {
  fmt::print("\n| stroke | drive | no delay | 0.5 ms | 1 ms | 1 ms, 50 um of noise |\n|---|---|---|---|---|---|\n");
  for (const char* name :
       {"piano", "forte", "repetition", "recorded_very_slow", "recorded_medium", "recorded_fast", "recorded_repeated"})
    for (const DriveKind drive : {DriveKind::piston, DriveKind::key}) {
      fmt::print("| {} | {}", name, drive == DriveKind::piston ? "piston" : "key");
      for (const auto& [delay, noise] : {std::pair{0.0, 0.0}, {5e-4, 0.0}, {1e-3, 0.0}, {1e-3, 5e-5}}) {
        RenderSettings settings = settings_of_file();
        settings.tick.drive = drive;
        if (noise == 0) settings.track.estimator = difference(2);
        settings.passivity.loop_delay = delay;
        settings.passivity.sensor_noise = noise;
        settings.passivity.reserve = 1;  // never used up
        settings.guard.max_force = settings.guard.max_slew = 1e9;
        const Keystroke stroke = keystroke(name);
        Device device(settings);
        std::mt19937 random(1);
        std::normal_distribution<double> normal(0, 1);
        double least = 1;
        for (int i = -200; i < (stroke.end() - stroke.start()) * 2000; ++i) {
          const double y = i < 0 ? 0 : stroke.at(stroke.start() + i * 5e-4).value;
          const double surplus = device.play(y + noise * normal(random)).key[0].surplus;
          if (i > -100) least = std::min(least, surplus);
        }
        fmt::print(" | {:.3f}", 1e3 * (1 - least));
      }
      fmt::print(" |\n");
    }
}

struct LeverCase {
  double mass, push;  // [kg], [N]
  bool is_quick;      // the actuator follows at once, else with 0.3 ms
  bool is_noisy;      // 50 um of noise and the file's estimator, else none and a backward difference
};

/// Fastest motion of the last 0.5 s of a lever without friction, pressed onto the key bottom by a constant force.
double fastest_at_the_end(const LeverCase& c, bool is_on) {
  constexpr double T = 5e-4, h = T / 20, kDepth = 0.014;
  RenderSettings settings = settings_of_file();
  if (!c.is_noisy) settings.track.estimator = difference(1);
  settings.passivity.is_on = is_on;
  settings.passivity.sensor_noise = c.is_noisy ? 5e-5 : 0;
  settings.passivity.loop_delay = c.is_quick ? T : T + 3e-4;
  settings.track.still_zone = 0;
  settings.guard.max_force = settings.guard.max_slew = 1e9;
  Device device(settings);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  double position = 0, rate = 0, asked = 0, force = 0, fastest = 0;
  for (int i = 0; i < 4000; ++i) {
    const double seen = position + settings.passivity.sensor_noise * normal(random);
    const double next = device.play(std::clamp(seen, -0.0029, 0.0159)).key[0].force;
    for (int j = 0; j < 20; ++j) {
      force = c.is_quick ? asked : force + h / 3e-4 * (asked - force);
      const double finger = c.push * std::clamp((i * T - 0.1) / 0.2, 0.0, 1.0);
      const double past = position < 0 ? position : std::max(0.0, position - kDepth);
      const double stop = past != 0 ? -2e4 * past - 20 * rate : 0.0;
      rate += h / c.mass * (finger + stop - force);
      position += h * rate;
      if (i >= 3000) fastest = std::max(fastest, std::abs(rate));
    }
    asked = next;  // acts a period later
  }
  return fastest;
}

void unstable_levers() {
  fmt::print(
      "\n| lever [g] | pressed by [N] | actuator | rate | passivity off [m/s] | on [m/s] "
      "|\n|---|---|---|---|---|---|\n");
  for (const double mass : {0.04, 0.06, 0.1})
    for (const double push : {3.0, 10.0})
      for (const auto& [is_quick, is_noisy] : {std::pair{true, false}, {false, false}, {false, true}}) {
        const LeverCase c{mass, push, is_quick, is_noisy};
        fmt::print("| {:.0f} | {:.0f} | {} | {} | {:.4f} | {:.4f} |\n", 1e3 * mass, push,
                   is_quick ? "at once" : "0.3 ms", is_noisy ? "of the file, 50 um" : "difference",
                   fastest_at_the_end(c, false), fastest_at_the_end(c, true));
      }
}

/// Force of every period of a stroke of which every fiftieth message, on average, is lost.
std::vector<double> forces_of(const Keystroke& stroke, double extrapolation, bool loses) {
  RenderSettings settings = settings_of_file();
  settings.track.estimator = difference(2);
  settings.track.extrapolation = extrapolation;
  Device device(settings);
  std::mt19937 random(7);
  std::vector<double> forces;
  for (int i = -200; i < stroke.end() * 2000; ++i) {
    const bool is_lost = i > 0 && random() % 50 == 0 && loses;
    const double y = i < 0 ? 0 : stroke.at(i * 5e-4).value;
    forces.push_back((is_lost ? device.lose() : device.play(y)).key[0].simulated_force);
  }
  return forces;
}

void lost_messages() {
  fmt::print("\n| stroke | lost samples guessed: rms, largest [N] | held |\n|---|---|---|\n");
  for (const char* name : {"piano", "forte"}) {
    const Keystroke stroke = keystroke(name);
    const std::vector<double> all = forces_of(stroke, 1e-3, false);
    fmt::print("| {}", name);
    for (const double extrapolation : {1e-3, 0.0}) {
      const std::vector<double> some = forces_of(stroke, extrapolation, true);
      double sum = 0, largest = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        sum += (some[i] - all[i]) * (some[i] - all[i]);
        largest = std::max(largest, std::abs(some[i] - all[i]));
      }
      fmt::print(" | {:.2f}, {:.1f}", std::sqrt(sum / static_cast<double>(all.size())), largest);
    }
    fmt::print(" |\n");
  }
}

void realigned_keys() {
  fmt::print("\n| realign speed [m/s] | hammer at the string [m/s] |\n|---|---|\n");
  for (const double speed : {0.01, 0.02, 0.03, 0.05, 0.1}) {
    RenderSettings settings = settings_of_file();
    settings.track.realign_speed = speed;
    Device device(settings);
    double blow = 0;
    for (int i = 0; i < 6000; ++i)
      for (const HammerEvent& event : device.play(i < 500 ? 0.0 : 0.010).blow) blow = std::max(blow, event.speed);
    fmt::print("| {} | {} |\n", speed, blow == 0 ? "does not reach it" : fmt::format("{:.2f}", blow));
  }
}

}  // namespace

int main() {
  cost_at_rest();
  reserve_of_strokes();
  unstable_levers();
  lost_messages();
  realigned_keys();
}
