// config/device.yaml: what a good file becomes, and what is said of a bad one.
#include "erard/device/device_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace erard {
namespace {

const std::filesystem::path kFile = std::filesystem::path(ERARD_CONFIG_DIR) / "device.yaml";

std::string text_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The file that comes with erard, with one passage replaced.
class Changed {
 public:
  Changed(const std::string& from, const std::string& to) {
    std::string text = text_of(kFile);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at == std::string::npos) return;
    text.replace(at, from.size(), to);
    line_ = 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) / (std::string("device_") + test->name() + ".yaml");
    std::ofstream(path_) << text;
  }
  ~Changed() { std::filesystem::remove(path_); }
  Changed(const Changed&) = delete;
  Changed& operator=(const Changed&) = delete;

  DeviceSettings load() const { return load_device(path_); }
  /// What is said of it, without the path; empty: it is taken.
  std::string complaint() const {
    try {
      load();
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_TRUE(what.starts_with(path_.string() + ":")) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      return what.substr(path_.string().size() + 1);
    }
    return "";
  }
  int line() const { return line_; }

 private:
  std::filesystem::path path_;
  int line_ = 0;
};

TEST(DeviceFile, GivesTheDefaultsOfTheStructs) {
  // one truth: a host that builds its settings in code begins where one that reads the file does
  const DeviceSettings file = load_device(kFile), code;
  const RenderSettings &a = file.rendering, &b = code.rendering;
  EXPECT_EQ(a.keys, b.keys);
  EXPECT_EQ(a.tick.period, b.tick.period);
  EXPECT_EQ(a.tick.drive, b.tick.drive);
  EXPECT_EQ(a.max_steps_per_s, b.max_steps_per_s);
  EXPECT_EQ(a.watch.lowest, b.watch.lowest);
  EXPECT_EQ(a.watch.highest, b.watch.highest);
  EXPECT_EQ(a.watch.max_speed, b.watch.max_speed);
  EXPECT_EQ(a.watch.timeout, b.watch.timeout);
  EXPECT_EQ(a.watch.recovery_samples, b.watch.recovery_samples);
  EXPECT_EQ(a.track.extrapolation, b.track.extrapolation);
  EXPECT_EQ(a.track.realign_speed, b.track.realign_speed);
  EXPECT_EQ(a.track.realign_time, b.track.realign_time);
  EXPECT_EQ(a.track.still_zone, b.track.still_zone);
  EXPECT_EQ(a.track.still_time, b.track.still_time);
  EXPECT_EQ(a.track.estimator.kind, b.track.estimator.kind);
  EXPECT_EQ(a.track.estimator.length, b.track.estimator.length);
  EXPECT_EQ(a.track.estimator.degree, b.track.estimator.degree);
  EXPECT_EQ(a.coupling.stiffness, b.coupling.stiffness);
  EXPECT_EQ(a.coupling.damping, b.coupling.damping);
  EXPECT_EQ(a.passivity.is_on, b.passivity.is_on);
  EXPECT_EQ(a.passivity.reserve, b.passivity.reserve);
  EXPECT_EQ(a.passivity.safe_coupling.stiffness, b.passivity.safe_coupling.stiffness);
  EXPECT_EQ(a.passivity.safe_coupling.damping, b.passivity.safe_coupling.damping);
  EXPECT_EQ(a.passivity.device_damping, b.passivity.device_damping);
  EXPECT_EQ(a.passivity.loop_delay, b.passivity.loop_delay);
  EXPECT_EQ(a.passivity.sensor_noise, b.passivity.sensor_noise);
  EXPECT_EQ(a.passivity.hold_time, b.passivity.hold_time);
  EXPECT_EQ(a.guard.max_force, b.guard.max_force);
  EXPECT_EQ(a.guard.max_slew, b.guard.max_slew);
  EXPECT_EQ(a.guard.fade_time, b.guard.fade_time);
  EXPECT_EQ(a.actuator.kind, b.actuator.kind);
  EXPECT_EQ(a.actuator.voice_coil.force_constant, b.actuator.voice_coil.force_constant);
  EXPECT_EQ(a.actuator.voice_coil.max_current, b.actuator.voice_coil.max_current);
  EXPECT_EQ(a.actuator.voice_coil.continuous_current, b.actuator.voice_coil.continuous_current);
  EXPECT_EQ(a.actuator.voice_coil.thermal_time, b.actuator.voice_coil.thermal_time);
  EXPECT_EQ(a.actuator.mr_brake.drag, b.actuator.mr_brake.drag);
  EXPECT_EQ(a.actuator.mr_brake.yield_force, b.actuator.mr_brake.yield_force);
  EXPECT_EQ(a.actuator.mr_brake.saturation_current, b.actuator.mr_brake.saturation_current);
  EXPECT_EQ(a.actuator.mr_brake.max_current, b.actuator.mr_brake.max_current);
  EXPECT_EQ(a.actuator.mr_brake.response_time, b.actuator.mr_brake.response_time);
  EXPECT_EQ(a.actuator.mr_brake.standstill_speed, b.actuator.mr_brake.standstill_speed);
  EXPECT_EQ(file.real_time.priority, code.real_time.priority);
  EXPECT_EQ(file.real_time.cpu, code.real_time.cpu);
  EXPECT_EQ(file.real_time.phase_us, code.real_time.phase_us);
  EXPECT_EQ(file.link.positions_url, code.link.positions_url);
  EXPECT_EQ(file.link.forces_url, code.link.forces_url);
  EXPECT_EQ(file.link.positions_channel, code.link.positions_channel);
  EXPECT_EQ(file.link.forces_channel, code.link.forces_channel);
}

TEST(DeviceFile, EveryValueSaysWhereItComesFrom) {
  std::istringstream text(text_of(kFile));
  std::string line;
  int values = 0;
  while (std::getline(text, line)) {
    const std::size_t colon = line.find(": "), begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || line[begin] == '#' || colon == std::string::npos) continue;
    ++values;
    bool has_source = false;
    for (const char* word : {"# measured", "# derived: ", "# choice", "# assumed: ", "# thesis "})
      has_source |= line.find(word) != std::string::npos;
    EXPECT_TRUE(has_source) << line;
  }
  EXPECT_GT(values, 40);
}

TEST(DeviceFile, EveryNumberArrives) {
  const DeviceSettings s = Changed("rate_Hz: 2000", "rate_Hz: 4000").load();
  EXPECT_EQ(s.rendering.tick.period, 1 / 4000.0);
  EXPECT_EQ(Changed("keys: 1 ", "keys: 88 ").load().rendering.keys, 88);
  EXPECT_EQ(Changed("max_force_N: 20", "max_force_N: 7.5").load().rendering.guard.max_force, 7.5);
  EXPECT_EQ(Changed("cpu: -1", "cpu: 3").load().real_time.cpu, 3);
  EXPECT_FALSE(Changed("on: yes", "on: no").load().rendering.passivity.is_on);
}

TEST(DeviceFile, OtherKindsBringTheirOwnKeys) {
  const std::string text = text_of(kFile);
  const std::size_t rate_from = text.find("  kind: sliding_polynomial"), rate_to = text.find("\n# of the drive");
  const std::string rate = text.substr(rate_from, rate_to - rate_from);
  const RateEstimatorSettings line = Changed(rate, "  kind: adaptive_line\n  longest_samples: 32\n  band_m: 2.0e-5\n")
                                         .load()
                                         .rendering.track.estimator;
  EXPECT_EQ(line.kind, RateEstimatorKind::adaptive_line);
  EXPECT_EQ(line.length, 32);
  EXPECT_EQ(line.band, 2e-5);
  const RateEstimatorSettings fading =
      Changed(rate, "  kind: fading_polynomial\n  degree: 1\n  memory: 0.5\n").load().rendering.track.estimator;
  EXPECT_EQ(fading.kind, RateEstimatorKind::fading_polynomial);
  EXPECT_EQ(fading.degree, 1);
  EXPECT_EQ(fading.memory, 0.5);
}

TEST(DeviceFile, ReadsEveryActuatorWhicheverIsInUse) {
  EXPECT_EQ(Changed("kind: voice_coil", "kind: none").load().rendering.actuator.kind, ActuatorKind::none);
  EXPECT_EQ(Changed("kind: voice_coil", "kind: mr_brake").load().rendering.actuator.kind, ActuatorKind::mr_brake);
  EXPECT_EQ(Changed("drag_N: 0.3", "drag_N: 0.4").load().rendering.actuator.mr_brake.drag, 0.4);
  EXPECT_EQ(Changed("thermal_time_s: 30", "thermal_time_s: 3").load().rendering.actuator.voice_coil.thermal_time, 3);
}

TEST(DeviceFile, BadValuesAreRefusedInOneSentenceWithTheirPlace) {
  struct Case {
    const char *from, *to, *complaint;
  };
  for (const Case& c : {
           Case{"rate_Hz: 2000", "rate_Hz: 200", "rate_Hz = 200, must be 400 to 50000"},
           Case{"rate_Hz: 2000", "rate_Hz: nan", "rate_Hz = nan, must be a finite number"},
           Case{"rate_Hz: 2000", "rate_Hz: 2 kHz", "rate_Hz = 2 kHz, must be a finite number"},
           Case{"keys: 1 ", "keys: 0 ", "keys = 0, must be 1 to 88"},
           Case{"keys: 1 ", "keys: 1.5 ", "keys = 1.5, must be a whole number"},
           Case{"drive: piston", "drive: force", "drive = force, must be one of piston, key"},
           Case{"drive: piston", "drive: key",
                "coupling has no effect with drive = key, remove it or set drive: piston"},
           Case{"highest_position_m: 0.016", "highest_position_m: -0.01",
                "highest_position_m = -0.01 in input, must be > lowest_position_m = -0.003"},
           Case{"timeout_s: 0.010", "timeout_s: 0.0005", "timeout_s = 0.0005 in input, must be 0.001 to 1"},
           Case{"max_force_N: 20", "max_force_N: -3", "max_force_N = -3 in limits, must be > 0"},
           Case{"max_force_N: 20", "max_force_n: 20",
                "key max_force_n is not known in limits, did you mean max_force_N?"},
           Case{"fade_s: 0.020", "fade_s: 1e999", "fade_s = 1e999 in limits, must be a finite number"},
           Case{"degree: 2 ", "memory: 0.5 ", "key degree is missing in velocity"},
           Case{"continuous_current_A: 1 ", "continuous_current_A: 4 ",
                "continuous_current_A = 4 in actuator voice_coil, must be > 0 and at most 3"},
           Case{"loop_delay_s: 8.0e-4", "loop_delay_s: 0.02", "loop_delay_s = 0.02 in passivity, must be 0 to 0.003"},
           Case{"on: yes", "on: perhaps", "on = perhaps in passivity, must be one of yes, no"},
           Case{"priority: 80", "priority: 100", "priority = 100 in real_time, must be 0 to 99"},
           Case{"phase_us: 150", "phase_us: 600", "phase_us = 600 in real_time, must be 0 to 500"},
           Case{"forces_channel: ERARD_FORCES", "forces_channel: ERARD_POSITIONS",
                "forces_channel = ERARD_POSITIONS in link, must differ from positions_channel"},
           Case{"stiffness_N_per_m: 500 ", "stiffness_N_per_m: 0 ",
                "stiffness_N_per_m = 0 in passivity safe_coupling, must be > 0"},
       }) {
    const Changed file(c.from, c.to);
    const std::string complaint = file.complaint();
    EXPECT_TRUE(complaint.ends_with(std::string(": ") + c.complaint)) << complaint << " of " << c.to;
  }
}

TEST(DeviceFile, ComplaintsNameTheLine) {
  const Changed file("max_slew_N_per_s: 2.0e4", "max_slew_N_per_s: 0");
  EXPECT_EQ(file.complaint(), std::to_string(file.line()) + ": max_slew_N_per_s = 0 in limits, must be > 0");
}

TEST(DeviceFile, UnknownSectionIsRefused) {
  EXPECT_NE(Changed("limits:", "colour: red\nlimits:").complaint().find("key colour is not known"), std::string::npos);
}

}  // namespace
}  // namespace erard
