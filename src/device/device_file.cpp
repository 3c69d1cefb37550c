#include "erard/device/device_file.hpp"

#include <charconv>
#include <cmath>

#include "yaml_file.hpp"
#include "yaml_section.hpp"

namespace erard {
namespace {

/// Bounds of a number, both included unless `above` stands in for the lower one.
struct Range {
  double lowest = -HUGE_VAL, highest = HUGE_VAL;
  double above = -HUGE_VAL;  // not included

  bool holds(double value) const { return value >= lowest && value <= highest && value > above; }
  std::string rule() const {
    if (std::isfinite(lowest) && std::isfinite(highest)) return fmt::format("must be {} to {}", lowest, highest);
    if (std::isfinite(above) && std::isfinite(highest))
      return fmt::format("must be > {} and at most {}", above, highest);
    return std::isfinite(above) ? fmt::format("must be > {}", above) : fmt::format("must be >= {}", lowest);
  }
};
constexpr Range kPositive{-HUGE_VAL, HUGE_VAL, 0};
constexpr Range kNotNegative{0, HUGE_VAL};
constexpr Range from_to(double lowest, double highest) { return {lowest, highest}; }
constexpr Range up_to(double highest) { return {-HUGE_VAL, highest, 0}; }

[[noreturn]] void reject(const YamlSection& section, const std::string& key, const std::string& value,
                         std::string_view rule) {
  section.reject(section.line(key), fmt::format("{} = {}{}, {}", key, printable(value), section.where(), rule));
}

double number(YamlSection& section, const std::string& key, const Range& range) {
  const std::string text = section.word(key);
  double value = 0;
  const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || stop != text.data() + text.size() || !std::isfinite(value))
    reject(section, key, text, "must be a finite number");
  if (!range.holds(value)) reject(section, key, text, range.rule());
  return value;
}

int whole_number(YamlSection& section, const std::string& key, const Range& range) {
  const double value = number(section, key, range);
  if (value != std::floor(value)) reject(section, key, section.word(key), "must be a whole number");
  return static_cast<int>(value);
}

bool yes_or_no(YamlSection& section, const std::string& key) { return section.choice(key, {"yes", "no"}) == "yes"; }

TickSettings read_tick(YamlSection& device) {
  TickSettings tick;
  tick.drive = device.choice("drive", {"piston", "key"}) == "piston" ? DriveKind::piston : DriveKind::key;
  tick.set_rate(number(device, "rate_Hz", from_to(kSlowestRate, kFastestRate)));
  return tick;
}

void read_input(YamlSection section, double period, RenderSettings& r) {
  r.watch.lowest = number(section, "lowest_position_m", from_to(-0.1, 0.1));
  r.watch.highest = number(section, "highest_position_m", from_to(-0.1, 0.1));
  if (!(r.watch.highest > r.watch.lowest))
    reject(section, "highest_position_m", section.word("highest_position_m"),
           fmt::format("must be > lowest_position_m = {}", r.watch.lowest));
  r.watch.max_speed = number(section, "max_speed_m_per_s", kPositive);
  r.watch.timeout = number(section, "timeout_s", from_to(2 * period, 1));
  r.watch.recovery_samples = whole_number(section, "recovery_samples", from_to(1, 10000));
  r.track.extrapolation = number(section, "extrapolation_s", from_to(0, r.watch.timeout));
  r.track.realign_speed = number(section, "realign_speed_m_per_s", kPositive);
  r.track.realign_time = number(section, "realign_time_s", kPositive);
  r.passivity.sensor_noise = number(section, "sensor_noise_m", from_to(0, 1e-3));
  r.track.still_zone = number(section, "still_zone_m", from_to(0, 1e-3));
  r.track.still_time = number(section, "still_time_s", kPositive);
  section.finish();
}

void read_velocity(YamlSection section, RateEstimatorSettings& e) {
  const std::string kind = section.choice("kind", {"adaptive_line", "sliding_polynomial", "fading_polynomial"});
  if (kind == "adaptive_line") {
    e.kind = RateEstimatorKind::adaptive_line;
    e.length = whole_number(section, "longest_samples", from_to(2, AdaptiveLine::kMaxLength));
    e.band = number(section, "band_m", kPositive);
  } else if (kind == "sliding_polynomial") {
    e.kind = RateEstimatorKind::sliding_polynomial;
    e.degree = whole_number(section, "degree", from_to(1, SlidingPolynomial::kMaxDegree));
    e.length = whole_number(section, "length_samples", from_to(e.degree + 1, SlidingPolynomial::kMaxLength));
  } else {
    e.kind = RateEstimatorKind::fading_polynomial;
    e.degree = whole_number(section, "degree", from_to(1, 2));
    e.memory = number(section, "memory", from_to(0, 0.99));
  }
  section.finish();
}

Coupling read_coupling(YamlSection section) {
  Coupling coupling;
  coupling.stiffness = number(section, "stiffness_N_per_m", kPositive);
  coupling.damping = number(section, "damping_N_s_per_m", kNotNegative);
  section.finish();
  return coupling;
}

void read_passivity(YamlSection section, PassivitySettings& p) {
  p.is_on = yes_or_no(section, "on");
  p.reserve = number(section, "reserve_J", kPositive);
  p.safe_coupling = read_coupling(section.section("safe_coupling"));
  p.device_damping = number(section, "device_damping_N_s_per_m", kNotNegative);
  p.loop_delay = number(section, "loop_delay_s", from_to(0, Passivity::kLongestDelay));
  p.hold_time = number(section, "hold_s", kNotNegative);
  section.finish();
}

void read_limits(YamlSection section, GuardSettings& guard) {
  guard.max_force = number(section, "max_force_N", kPositive);
  guard.max_slew = number(section, "max_slew_N_per_s", kPositive);
  guard.fade_time = number(section, "fade_s", kPositive);
  section.finish();
}

void read_voice_coil(YamlSection section, VoiceCoilSettings& coil) {
  coil.force_constant = number(section, "force_constant_N_per_A", kPositive);
  coil.max_current = number(section, "max_current_A", kPositive);
  coil.continuous_current = number(section, "continuous_current_A", up_to(coil.max_current));
  coil.thermal_time = number(section, "thermal_time_s", kPositive);
  section.finish();
}

void read_mr_brake(YamlSection section, MrBrakeSettings& brake) {
  brake.drag = number(section, "drag_N", kNotNegative);
  brake.yield_force = number(section, "yield_force_N", kPositive);
  brake.saturation_current = number(section, "saturation_current_A", kPositive);
  brake.max_current = number(section, "max_current_A", kPositive);
  brake.response_time = number(section, "response_s", kPositive);
  brake.standstill_speed = number(section, "standstill_speed_m_per_s", kNotNegative);
  section.finish();
}

/// Both kinds are read whichever is in use, so that a program's option may choose the other one.
void read_actuator(YamlSection section, ActuatorSettings& actuator) {
  const std::string kind = section.choice("kind", {"none", "voice_coil", "mr_brake"});
  actuator.kind = kind == "none"         ? ActuatorKind::none
                  : kind == "voice_coil" ? ActuatorKind::voice_coil
                                         : ActuatorKind::mr_brake;
  read_voice_coil(section.section("voice_coil"), actuator.voice_coil);
  read_mr_brake(section.section("mr_brake"), actuator.mr_brake);
  section.finish();
}

RealTimeSettings read_real_time(YamlSection section, double period) {
  RealTimeSettings r;
  r.priority = whole_number(section, "priority", from_to(0, 99));
  r.cpu = whole_number(section, "cpu", from_to(-1, 1023));
  r.phase_us = whole_number(section, "phase_us", from_to(0, std::floor(period * 1e6)));
  section.finish();
  return r;
}

std::string channel(YamlSection& section, const std::string& key) {
  constexpr std::size_t kLongest = 63;  // LCM drops longer ones without a word
  const std::string name = section.word(key);
  if (name.size() > kLongest) reject(section, key, name, fmt::format("must have at most {} letters", kLongest));
  return name;
}

LinkSettings read_link(YamlSection section) {
  LinkSettings link;
  link.positions_url = section.word("positions_url");
  link.forces_url = section.word("forces_url");
  link.positions_channel = channel(section, "positions_channel");
  link.forces_channel = channel(section, "forces_channel");
  if (link.forces_channel == link.positions_channel)
    reject(section, "forces_channel", link.forces_channel, "must differ from positions_channel");
  section.finish();
  return link;
}

}  // namespace

DeviceSettings load_device(const std::filesystem::path& file) {
  return load_device(read_config(file, "a device file"));
}

DeviceSettings load_device(const ConfigText& config) {
  YamlSection device(config.name, "", parse_yaml(config), 1);
  DeviceSettings settings;
  RenderSettings& rendering = settings.rendering;
  rendering.keys = whole_number(device, "keys", from_to(1, Renderer::kMaxKeys));
  rendering.tick = read_tick(device);
  rendering.max_steps_per_s = number(device, "max_steps_per_s", kPositive);
  const double period = rendering.tick.period;
  read_input(device.section("input"), period, rendering);
  read_velocity(device.section("velocity"), rendering.track.estimator);
  if (rendering.tick.drive == DriveKind::piston) {
    rendering.coupling = read_coupling(device.section("coupling"));
  } else if (device.optional("coupling")) {
    device.reject(device.line("coupling"), "coupling has no effect with drive = key, remove it or set drive: piston");
  }
  read_passivity(device.section("passivity"), rendering.passivity);
  read_limits(device.section("limits"), rendering.guard);
  read_actuator(device.section("actuator"), rendering.actuator);
  settings.real_time = read_real_time(device.section("real_time"), period);
  settings.link = read_link(device.section("link"));
  device.finish();
  return settings;
}

}  // namespace erard
