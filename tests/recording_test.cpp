// From recorded keys to keystrokes: what may not get lost on the way, and what must.
#include "erard/device/recording.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "erard/device/error.hpp"

namespace erard {
namespace {

namespace fs = std::filesystem;

constexpr double kFingerDamping = 134;  // b [N s/m], thesis Table 3.1

struct Strike {
  const char* recording;
  const char* keystroke;
  double peak_speed;  // [m/s] measured when the recordings were selected; the highest of s7's
};
// s1 is a slow press: no peak was given for it
const std::vector<Strike> kStrikes{{"s1_very_slow_press_release.csv", "recorded_very_slow.csv", 0},
                                   {"s2_medium_strike_hold.csv", "recorded_medium.csv", 0.48},
                                   {"s3_fast_strike_free_release.csv", "recorded_fast_free_release.csv", 0.86},
                                   {"s4_fast_strike_A.csv", "recorded_fast.csv", 0.84},
                                   {"s7_repeated_strikes_x9.csv", "recorded_repeated.csv", 1.04}};

const fs::path kRecordings = ERARD_CONFIG_DIR "/recordings";
const fs::path kKeystrokes = ERARD_CONFIG_DIR "/keystrokes";

Import import_file(const char* name) {
  return import_recording(read_recording(kRecordings / name), ImportSettings{}, name);
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string bytes_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// ---- the recordings that come with erard

TEST(Recording, ImportsToTheKeystrokesThatAreKept) {
  const fs::path fresh = fs::temp_directory_path() / ("erard-recording-" + std::to_string(getpid()) + ".csv");
  for (const Strike& strike : kStrikes) {
    const Import result = import_file(strike.recording);
    std::vector<std::string> comments = lines_of(kRecordings / "credit.txt");
    const std::string command = std::string("erard-import ") + strike.recording +
                                " --credit credit.txt --out ../keystrokes/" + strike.keystroke;
    for (const std::string& line : describe_import(ImportSettings{}, result.figures, command)) comments.push_back(line);
    write_keystroke(fresh, result.keystroke, comments);
    // one string against another, not EXPECT_EQ: a difference would print both files
    EXPECT_TRUE(bytes_of(fresh) == bytes_of(kKeystrokes / strike.keystroke))
        << strike.keystroke << " is not what the import makes; see tools/import-recordings";
  }
  fs::remove(fresh);
}

TEST(Recording, KeepsTheTimesOfTheRecording) {
  for (const Strike& strike : kStrikes) {
    const Recording recording = read_recording(kRecordings / strike.recording);
    const Keystroke keystroke = import_recording(recording, ImportSettings{}, strike.recording).keystroke;
    EXPECT_TRUE(std::ranges::equal(keystroke.times(), recording.times)) << strike.recording;
    EXPECT_NEAR(recording.rate, 2000, 1e-6) << strike.recording;  // exactly 2 kHz, rounded times
  }
}

TEST(Recording, RestsExactlyBeforeTheFirstMovement) {
  for (const Strike& strike : kStrikes) {
    const Import result = import_file(strike.recording);
    const Keystroke& keystroke = result.keystroke;
    ASSERT_GT(result.figures.onset, 0.1) << strike.recording;
    for (std::size_t i = 0; keystroke.times()[i] <= result.figures.onset; ++i) EXPECT_EQ(keystroke.values()[i], 0) << i;
    // the spline rings into the rest, four times less at each sample: gone after 35 of them, 18 ms
    for (double t = 0; t < result.figures.onset - 0.018; t += 0.0003) {
      EXPECT_EQ(keystroke.at(t).value, 0) << strike.recording << " at " << t;
      EXPECT_EQ(keystroke.at(t).rate, 0) << strike.recording << " at " << t;
    }
  }
}

TEST(Recording, RingsIntoTheRestWithLessForceThanAnyoneFeels) {
  for (const Strike& strike : kStrikes) {
    const Import result = import_file(strike.recording);
    for (double t = 0; t < result.figures.onset - 0.001; t += 0.0001)  // 0.05 N: a tenth of the touch weight
      EXPECT_LT(std::abs(result.keystroke.at(t).rate) * kFingerDamping, 0.05) << strike.recording << " at " << t;
  }
}

TEST(Recording, StaysAtTheDipOrBeyondWhereTheSensorClips) {
  for (const Strike& strike : kStrikes) {
    const Recording recording = read_recording(kRecordings / strike.recording);
    const ImportSettings settings;
    const Import result = import_recording(recording, settings, strike.recording);
    int clipped = 0;
    for (std::size_t i = 0; i < recording.key_front.size(); ++i)
      if (recording.key_front[i] > settings.full_scale - 1e-9) {
        ++clipped;
        EXPECT_GT(result.keystroke.values()[i], settings.dip - 1e-6) << i;    // the resolution of the sensor
        EXPECT_LT(result.keystroke.values()[i], settings.dip + 0.5e-3) << i;  // what rails of other actions yield
      }
    EXPECT_EQ(result.figures.clipped_count, clipped);
    EXPECT_GT(clipped, 10) << strike.recording;
  }
}

TEST(Recording, NeverRisesAboveRest) {
  for (const Strike& strike : kStrikes) {
    const Import result = import_file(strike.recording);
    for (const double position : result.keystroke.values())
      EXPECT_GT(position, -1e-6) << strike.recording;  // the resolution of the sensor
  }
}

TEST(Recording, KeepsPeakSpeeds) {
  for (const Strike& strike : kStrikes) {
    if (strike.peak_speed == 0) continue;
    const ImportFigures figures = import_file(strike.recording).figures;
    EXPECT_NEAR(figures.kept_speed / strike.peak_speed, 1, 0.03) << strike.recording;
    EXPECT_NEAR(figures.kept_speed / figures.recorded_speed, 1, 0.03) << strike.recording;
  }
}

TEST(Recording, FollowsTheReadingsWithinTheirNoise) {
  for (const Strike& strike : kStrikes) {
    const ImportFigures figures = import_file(strike.recording).figures;
    EXPECT_LT(figures.residual_low, 80e-6) << strike.recording;   // noise there: 9 to 45 um, and 0.5 mm nobody knows
    EXPECT_LT(figures.residual_high, 12e-6) << strike.recording;  // noise there: 0.5 to 6 um
  }
}

// ---- made-up recordings, whose truth is known

// Noise of the sensor as docs/recordings.md has it [m].
double sensor_noise(double reading) { return 0.5e-6 + 45e-6 * std::exp(-reading / 2e-3); }

// A press to `depth` [m] of `duration` [s] from 0.2 s on, held to 1 s after it: y = depth (10 s^3 - 15 s^4 + 6 s^5).
struct Press {
  double depth, duration;
  double position(double t) const {
    const double s = std::clamp((t - 0.2) / duration, 0.0, 1.0);
    return depth * s * s * s * (10 - 15 * s + 6 * s * s);
  }
  double rate(double t) const {
    const double s = std::clamp((t - 0.2) / duration, 0.0, 1.0);
    return depth / duration * 30 * s * s * (1 - s) * (1 - s);
  }
  double end() const { return 0.2 + duration + 1; }
};

// What the sensor makes of a press: noise, clipped at both ends, micrometres.
Recording sense(const Press& press, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise;
  Recording recording{2000, {}, {}, {}};
  for (int i = 0; i * 0.0005 < press.end(); ++i) {
    const double position = press.position(i * 0.0005);
    const double reading = position + sensor_noise(position) * noise(generator);
    recording.times.push_back(i * 0.0005);
    recording.key_front.push_back(std::round(std::clamp(reading, 0.0, ImportSettings{}.full_scale) * 1e6) / 1e6);
  }
  return recording;
}

ImportSettings unscaled() {
  ImportSettings settings;
  settings.dip = settings.full_scale;
  return settings;
}

// rms of the rate's error [m/s] where the press runs from 1 mm to 0.2 mm before its end
double rate_error(const Press& press, unsigned seed) {
  const Keystroke keystroke = import_recording(sense(press, seed), unscaled(), "press").keystroke;
  double sum = 0;
  int count = 0;
  for (const double t : keystroke.times())
    if (press.position(t) > 1e-3 && press.position(t) < press.depth - 0.2e-3) {
      sum += std::pow(keystroke.at(t).rate - press.rate(t), 2);
      ++count;
    }
  return std::sqrt(sum / count);
}

TEST(Recording, SlowPressCostsLittleForceNoise) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const double error = rate_error({0.011, 2}, seed);
    EXPECT_LT(error * kFingerDamping, 0.05) << "seed " << seed;  // [N] a tenth of the touch weight
  }
}

TEST(Recording, FastStrikeKeepsItsRate) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Press strike{0.011, 0.03};  // peak rate 0.69 m/s; the recordings' own peak speeds are kept to 3 %
    EXPECT_LT(rate_error(strike, seed), 0.03 * strike.rate(0.215)) << "seed " << seed;
  }
}

TEST(Recording, GoesOnBelowTheClipWhereTheKeyDid) {
  for (const double depth : {0.0121, 0.0123, 0.0125}) {  // [m] 0.2 to 0.6 mm beyond what the sensor sees
    const Press press{depth, 0.05};
    const Import result = import_recording(sense(press, 1), unscaled(), "press");
    for (std::size_t i = 0; i < result.keystroke.size(); ++i)  // 0.6 mm deep, 0.2 mm expected
      EXPECT_NEAR(result.keystroke.values()[i], press.position(result.keystroke.times()[i]), 0.45e-3) << depth;
    EXPECT_GT(result.figures.deepest_press, 0.1e-3) << depth;
  }
}

TEST(Recording, NoiseOfARestBecomesNothing) {
  const Press press{0.011, 0.1};
  const Keystroke keystroke = import_recording(sense(press, 1), unscaled(), "press").keystroke;
  for (std::size_t i = 0; keystroke.times()[i] < 0.2; ++i) EXPECT_EQ(keystroke.values()[i], 0) << i;
}

TEST(Recording, TouchesBelowTheRestLimitAreNoMovement) {
  Recording recording = sense({0.011, 0.1}, 1);
  for (std::size_t i = 100; i < 200; ++i) recording.key_front[i] += 0.3e-3;  // 50 ms at 0.3 mm, limit 0.5 mm
  const Import result = import_recording(recording, unscaled(), "press");
  EXPECT_EQ(result.figures.movement_count, 1);
  EXPECT_GT(result.figures.onset, 0.19);
}

TEST(Recording, DipScalesTheKeystroke) {
  const Recording recording = sense({0.011, 0.1}, 1);
  ImportSettings half = unscaled();
  half.dip /= 2;
  const Keystroke whole = import_recording(recording, unscaled(), "press").keystroke;
  const Keystroke halved = import_recording(recording, half, "press").keystroke;
  for (std::size_t i = 0; i < whole.size(); ++i)
    EXPECT_NEAR(halved.values()[i], whole.values()[i] / 2, 0.8e-9) << i;  // both to the nanometre
}

TEST(Recording, PeakSpeedIsExactOnCubics) {
  std::vector<double> line, cubic;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.0005 * i;
    line.push_back(0.7 * t);
    cubic.push_back(0.3 * t + 20 * t * t - 800 * t * t * t);  // fastest at 8.33 ms; sample 17 is 8.5 ms
  }
  const auto rate = [](double t) { return 0.3 + 40 * t - 2400 * t * t; };
  EXPECT_NEAR(peak_speed(line, 2000), 0.7, 1e-12);
  EXPECT_NEAR(peak_speed(cubic, 2000), rate(0.0085), 1e-12);
}

// ---- what cannot be used

class RecordingFile : public testing::Test {
 protected:
  RecordingFile() : file_(fs::temp_directory_path() / ("erard-recording-" + std::to_string(getpid()) + ".csv")) {}
  ~RecordingFile() override { fs::remove(file_); }

  fs::path file(const std::string& content) const {
    std::ofstream(file_, std::ios::binary) << content;
    return file_;
  }

  // The complaint is one line, begins with `start` and contains every one of `parts`.
  template <typename Action>
  static void expect_complaint(Action action, const std::string& start, std::initializer_list<const char*> parts) {
    try {
      action();
      FAIL() << "accepted, expected: " << *parts.begin();
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind(start, 0), 0U) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    }
  }

  void expect_refused(const std::string& content, int line, std::initializer_list<const char*> parts) const {
    SCOPED_TRACE(content.substr(0, 80));
    const fs::path path = file(content);
    expect_complaint([&] { read_recording(path); }, path.string() + ":" + std::to_string(line) + ": ", parts);
  }

 private:
  fs::path file_;
};

TEST_F(RecordingFile, IsRefusedWithItsPlace) {
  const std::string header = "t_s,key_front_mm,hammer_sensor_mm\n";
  expect_refused("", 1, {"without a header", "must name t_s, key_front_mm"});
  expect_refused("t_s,position_m\n", 1, {"\"position_m\" is not known", "must name t_s, key_front_mm"});
  expect_refused("t_s,hammer_sensor_mm\n", 1, {"no column key_front_mm"});
  expect_refused("key_front_mm\n", 1, {"no column t_s"});
  expect_refused(header + "0,0,0\n0.0005,nan,0\n", 3, {"key_front_mm = \"nan\"", "must be a finite number"});
  expect_refused(header + "0,0,0\n0.0005,31,0\n", 3, {"key_front_mm = 31 mm", "must be within +-30 mm"});
  expect_refused(header + "0,0,0\n0.0005,0,31\n", 3, {"hammer_sensor_mm = 31 mm", "must be within +-30 mm"});
  expect_refused(header + "0,0,0\n0.0005,0\n", 3, {"fewer values"});
  expect_refused(header + "0,0,0\n0,0,0\n", 3, {"t_s = 0 s after 0 s", "must rise by"});
  expect_refused(header + "0,0,0\n0.5,0,0\n", 3, {"t_s = 0.5 s", "400 to 50000 Hz"});
  expect_refused(header + "0,0,0\n0.0005,0,0\n0.0015,0,0\n", 4, {"t_s = 0.0015 s", "must rise by 0.0005 s"});
  expect_refused(header + "0,0,0\n0.0005,0,0\n", 3, {"2 rows of data", "must have 20 or more"});
}

TEST_F(RecordingFile, GivesTheHammerWhereItWasRecorded) {
  std::string with = "t_s,key_front_mm,hammer_sensor_mm\n", without = "t_s,key_front_mm\n";
  for (int i = 0; i < 20; ++i) {
    const std::string row = std::to_string(i * 0.0005) + "," + std::to_string(0.5 * i);
    with += row + "," + std::to_string(0.125 * i) + "\n";
    without += row + "\n";
  }
  const Recording both = read_recording(file(with)), key = read_recording(file(without));
  ASSERT_EQ(both.hammer.size(), 20U);
  EXPECT_DOUBLE_EQ(both.hammer[19], 0.125e-3 * 19);
  EXPECT_TRUE(key.hammer.empty());
  EXPECT_TRUE(both.key_front == key.key_front);
}

TEST_F(RecordingFile, CannotBeImportedWithoutRestAndMovement) {
  const auto complain = [](const Recording& recording, std::initializer_list<const char*> parts) {
    expect_complaint([&] { import_recording(recording, unscaled(), "r.csv"); }, "r.csv: ", parts);
  };
  Recording recording = sense({0.011, 0.1}, 1);
  recording.key_front.erase(recording.key_front.begin(), recording.key_front.begin() + 500);
  recording.times.resize(recording.key_front.size());
  complain(recording, {"starts at ", "must start at rest, below 0.5 mm"});
  complain(sense({0.0003, 0.1}, 1), {"never leaves its rest, must exceed 0.5 mm", "in millimetres"});
  recording = sense({0.011, 0.1}, 1);
  recording.key_front[700] = 0.0125;
  complain(recording, {"key_front_mm = 12.5 mm at 0.35 s", "must be within --full-scale = 11.906 mm"});
}

TEST_F(RecordingFile, CannotBeImportedWithImpossibleSettings) {
  const Recording recording = sense({0.011, 0.1}, 1);
  const auto complain = [&](auto member, double value, const char* start, const char* rule) {
    ImportSettings settings;
    settings.*member = value;
    expect_complaint([&] { import_recording(recording, settings, "r.csv"); }, start, {rule});
  };
  complain(&ImportSettings::dip, 9.8, "--dip = 9.8 m, ", "must be within 0.001 and 0.03 m");
  complain(&ImportSettings::dip, std::nan(""), "--dip = nan m, ", "must be within");
  complain(&ImportSettings::full_scale, 11.906, "--full-scale = 11906 mm, ", "must be within 1 and 30 mm");
  complain(&ImportSettings::rest, -1e-3, "--rest = -1 mm, ", "must be within");
  complain(&ImportSettings::press, 0, "--press = 0 mm, ", "must be within");
  complain(&ImportSettings::fast_cutoff, 1001, "--fast-cutoff = 1001 Hz, ", "must be within 1 and 1000 Hz");
  complain(&ImportSettings::slow_cutoff, 400, "--slow-cutoff = 400 Hz, ", "must be within 1 and 350 Hz");
  complain(&ImportSettings::fast_speed, 0, "--fast-speed = 0 m/s, ", "must be within 0.001 and 10 m/s");
}

#ifdef ERARD_PROGRAM_DIR
// Exit code of erard-import in the folder of the recordings.
int exit_code(const std::string& arguments) {
  const std::string program = ERARD_PROGRAM_DIR "/erard-import ";
  const int status =
      std::system(("cd " + kRecordings.string() + " && " + program + arguments + " >/dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(RecordingProgram, MakesTheDefaultKeystrokeAgain) {
  const std::string out = (fs::temp_directory_path() / ("erard-import-" + std::to_string(getpid()) + ".csv")).string();
  ASSERT_EQ(exit_code("s4_fast_strike_A.csv --credit credit.txt --out " + out), 0);
  std::vector<std::string> made = lines_of(out), kept = lines_of(kKeystrokes / "recorded_fast.csv");
  fs::remove(out);
  ASSERT_EQ(made.size(), kept.size());
  made[3] = kept[3];  // the command: another --out
  EXPECT_TRUE(made == kept);
}

TEST(RecordingProgram, LeavesWithTheCodesItPromises) {
  EXPECT_EQ(exit_code("--help"), 0);
  EXPECT_EQ(exit_code("--version"), 0);
  EXPECT_EQ(exit_code(""), 2);
  EXPECT_EQ(exit_code("absent.csv --out x.csv"), 2);
  EXPECT_EQ(exit_code("s4_fast_strike_A.csv --out s4_fast_strike_A.csv"), 2);
  EXPECT_EQ(exit_code("s4_fast_strike_A.csv --dip 9.8 --out x.csv"), 2);
  EXPECT_EQ(exit_code("s4_fast_strike_A.csv --out /tmp/no/such/folder/x.csv"), 2);
}
#endif

}  // namespace
}  // namespace erard
