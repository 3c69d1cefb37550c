// The spline through a keystroke, the files it comes from, and what is said about files that cannot be used.
#include "erard/device/keystroke.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "erard/device/error.hpp"

namespace erard {
namespace {

namespace fs = std::filesystem;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Keystroke positions(std::vector<double> times, std::vector<double> values) {
  return {KeystrokeQuantity::position, std::move(times), std::move(values)};
}

// Samples of a function, on times whose intervals differ up to threefold unless `unevenness` is zero.
template <typename Function>
Keystroke sampled(Function function, double start, double end, int count, double unevenness) {
  std::vector<double> times, values;
  for (int i = 0; i < count; ++i) {
    const double place = i + unevenness * 0.5 * std::sin(2.4 * i) * (i > 0 && i + 1 < count);
    times.push_back(start + (end - start) * place / (count - 1));
    values.push_back(function(times.back()));
  }
  return positions(times, values);
}

// Slope of the rate at the two ends of segment i: inside a segment the rate is a parabola, so three values give it.
struct Bend {
  double at_left, at_right;
};
Bend bend_of(const Keystroke& keystroke, std::size_t i) {
  const double a = keystroke.times()[i], b = keystroke.times()[i + 1], h = b - a;
  const double r0 = keystroke.at(a).rate, r1 = keystroke.at(0.5 * (a + b)).rate, r2 = keystroke.at(b).rate;
  return {(-3 * r0 + 4 * r1 - r2) / h, (r0 - 4 * r1 + 3 * r2) / h};
}

double wave(double t) { return 0.005 * std::sin(7 * t) + 0.002 * std::cos(3 * t); }  // [m] no natural ends

TEST(Keystroke, PassesThroughItsSamples) {
  const Keystroke keystroke = sampled(wave, 0.1, 1.3, 40, 1);
  for (std::size_t i = 0; i < keystroke.size(); ++i)  // 1e-17: rounding of 0.01 m
    EXPECT_NEAR(keystroke.at(keystroke.times()[i]).value, keystroke.values()[i], 1e-17) << i;
}

TEST(Keystroke, SecondDerivativeIsContinuous) {
  const Keystroke keystroke = sampled(wave, 0.1, 1.3, 40, 1);
  for (std::size_t i = 1; i + 1 < keystroke.size(); ++i)  // up to 0.3 m/s^2; rounding of the rates over 10 ms: 1e-14
    EXPECT_NEAR(bend_of(keystroke, i - 1).at_right, bend_of(keystroke, i).at_left, 1e-12) << i;
}

TEST(Keystroke, EndsAreNatural) {
  const Keystroke keystroke = sampled(wave, 0.1, 1.3, 40, 1);
  EXPECT_NEAR(bend_of(keystroke, 0).at_left, 0, 1e-12);
  EXPECT_NEAR(bend_of(keystroke, keystroke.size() - 2).at_right, 0, 1e-12);
}

TEST(Keystroke, ThreeSamplesAgreeWithTheSplineByHand) {
  // 0, 1, 0 one second apart: M = -3 in the middle, so y(1/2) = 1/2 + 3/8 * 3/6 and y'(0) = 1 + 3/6
  const Keystroke keystroke = positions({0, 1, 2}, {0, 1, 0});
  EXPECT_DOUBLE_EQ(keystroke.at(0.5).value, 0.6875);
  EXPECT_DOUBLE_EQ(keystroke.at(0).rate, 1.5);
  EXPECT_DOUBLE_EQ(keystroke.at(1).rate, 0);
  EXPECT_DOUBLE_EQ(keystroke.at(2).rate, -1.5);
}

TEST(Keystroke, ReproducesStraightLines) {
  const auto line = [](double t) { return 0.001 + 0.004 * t; };
  for (const int count : {2, 3, 17}) {
    const Keystroke keystroke = sampled(line, -0.5, 2, count, 1);
    for (double t = -0.5; t <= 2; t += 0.01) {
      EXPECT_NEAR(keystroke.at(t).value, line(t), 1e-16) << count << " samples, t = " << t;
      EXPECT_NEAR(keystroke.at(t).rate, 0.004, 1e-15) << count << " samples, t = " << t;
    }
  }
}

TEST(Keystroke, ConvergesAtFourthOrderInside) {
  // the natural ends are wrong for this wave, but their error dies by 3.7 at each sample: none is left in the middle
  const auto error_of = [](int count) {
    const Keystroke keystroke = sampled(wave, 0, 2, count, 0);
    double worst = 0;
    for (double t = 0.8; t < 1.2; t += 1e-4) worst = std::max(worst, std::abs(keystroke.at(t).value - wave(t)));
    return worst;
  };
  const double order = std::log2(error_of(101) / error_of(201));
  EXPECT_NEAR(order, 4, 0.1);
}

TEST(Keystroke, IsConstantOutsideItsSamples) {
  const Keystroke keystroke = positions({1, 2, 4}, {0.003, 0.001, 0.007});
  for (const double t : {-1e9, 0.0, 1 - 1e-12}) {
    EXPECT_EQ(keystroke.at(t).value, 0.003) << t;
    EXPECT_EQ(keystroke.at(t).rate, 0) << t;
  }
  for (const double t : {4 + 1e-12, 1e9, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(keystroke.at(t).value, 0.007) << t;
    EXPECT_EQ(keystroke.at(t).rate, 0) << t;
  }
  EXPECT_EQ(keystroke.at(kNan).value, 0.003);
  EXPECT_EQ(keystroke.at(kNan).rate, 0);
  EXPECT_EQ(keystroke.start(), 1);
  EXPECT_EQ(keystroke.end(), 4);
}

TEST(Keystroke, LongRestIsExactlyAtRest) {
  std::vector<double> times(400), values(400, 0.0);
  std::iota(times.begin(), times.end(), 0.0);
  for (double& t : times) t *= 0.0005;
  std::iota(values.begin() + 300, values.end(), 1.0);
  for (double& y : values) y *= 1e-4;
  const Keystroke keystroke = positions(times, values);
  for (double t = 0; t < 0.1; t += 0.00017) {
    EXPECT_EQ(keystroke.at(t).value, 0) << t;
    EXPECT_EQ(keystroke.at(t).rate, 0) << t;
  }
}

TEST(Keystroke, RefusesSamplesThatAreNoFunctionOfTime) {
  EXPECT_THROW(positions({0}, {0}), std::invalid_argument);
  EXPECT_THROW(positions({0, 1}, {0}), std::invalid_argument);
  EXPECT_THROW(positions({0, 0}, {0, 1}), std::invalid_argument);
  EXPECT_THROW(positions({1, 0}, {0, 1}), std::invalid_argument);
  EXPECT_THROW(positions({0, kNan}, {0, 1}), std::invalid_argument);
  EXPECT_THROW(positions({0, 1}, {0, kNan}), std::invalid_argument);
}

// ---- files

class KeystrokeFile : public testing::Test {
 protected:
  KeystrokeFile() : folder_(fs::temp_directory_path() / ("erard-keystroke-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~KeystrokeFile() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }

  fs::path file(const std::string& content) const {
    std::ofstream(path("k.csv"), std::ios::binary) << content;
    return path("k.csv");
  }

  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  // The complaint about a file is one line, starts with the place and contains every one of `parts`.
  static void expect_complaint(const fs::path& file, const std::string& place,
                               std::initializer_list<const char*> parts) {
    try {
      read_keystroke(file);
      FAIL() << "accepted, expected: " << *parts.begin();
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind(file.string() + place, 0), 0U) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    }
  }

  void expect_refused(const std::string& content, int line, std::initializer_list<const char*> parts) const {
    SCOPED_TRACE(content.substr(0, 80));
    expect_complaint(file(content), ":" + std::to_string(line) + ": ", parts);
  }

 private:
  fs::path folder_;
};

TEST_F(KeystrokeFile, ReadsPositionsAndForces) {
  const Keystroke position = read_keystroke(file("t_s,position_m\n0,0\n0.5,0.002\n2,-1e-3\n"));
  EXPECT_EQ(position.quantity(), KeystrokeQuantity::position);
  EXPECT_EQ(position.size(), 3U);
  EXPECT_EQ(position.times()[1], 0.5);
  EXPECT_EQ(position.values()[2], -0.001);

  const Keystroke force = read_keystroke(file("force_N,t_s\n+1.5,0\n20,0.01\n"));
  EXPECT_EQ(force.quantity(), KeystrokeQuantity::force);
  EXPECT_EQ(force.values()[0], 1.5);
  EXPECT_EQ(force.times()[1], 0.01);
}

TEST_F(KeystrokeFile, ReadsOverCommentsBlankLinesCrlfAndByteOrderMark) {
  const Keystroke keystroke = read_keystroke(
      file("\xEF\xBB\xBF# a comment, with a comma\r\n#\r\nt_s , position_m\r\n0, 0\r\n# between\r\n\r\n1,0.001"));
  ASSERT_EQ(keystroke.size(), 2U);
  EXPECT_EQ(keystroke.values()[1], 0.001);
}

TEST_F(KeystrokeFile, RefusesHeadersThatAreNot) {
  const char* rule = "must name t_s and one of position_m and force_N";
  expect_refused("0,0\n1,0.001\n", 1, {"\"0\" is not known", rule});
  expect_refused("# licence\nt_s;position_m\n0;0\n", 2, {"\"t_s;position_m\" is not known", rule});
  expect_refused("t_s,position_m,velocity\n0,0,0\n", 1, {"\"velocity\" is not known", rule});
  expect_refused("t_s,t_s,position_m\n0,0,0\n", 1, {"\"t_s\" stands twice", rule});
  expect_refused("t_s,position_m,force_N\n0,0,0\n", 1, {"both position_m and force_N", rule});
  expect_refused("t_s\n0\n1\n", 1, {"neither position_m nor force_N", rule});
  expect_refused("position_m\n0\n0.001\n", 1, {"no column t_s", rule});
  expect_refused("t_s,\x1b[31mred\n", 1, {"byte 0x1b is not text"});
}

TEST_F(KeystrokeFile, RefusesFilesWithoutTwoSamples) {
  expect_refused("", 1, {"ends without a header", "must name t_s"});
  expect_refused("# nothing\n#\n", 3, {"ends without a header"});
  expect_refused("t_s,position_m\n", 1, {"0 of its rows", "must have two or more"});
  expect_refused("t_s,position_m\n0,0\n", 2, {"1 of its rows", "must have two or more"});
}

TEST_F(KeystrokeFile, RefusesWhatIsNoFiniteNumber) {
  const auto refuse = [this](const std::string& cell, const char* shown) {
    expect_refused("t_s,position_m\n0,0\n1," + cell + "\n", 3, {"position_m = ", shown, "must be a finite number"});
  };
  refuse("nan", "\"nan\"");
  refuse("-inf", "\"-inf\"");
  refuse("1e999", "\"1e999\"");
  refuse("fast", "\"fast\"");
  refuse("", "\"\"");
  refuse("0.001m", "\"0.001m\"");
  refuse("0x1p-9", "\"0x1p-9\"");
  refuse("+-1", "\"+-1\"");
  refuse(std::string(100, '7') + "x", "777...");
  expect_refused("t_s,position_m\n0,0\nlater,0\n", 3, {"t_s = \"later\""});
}

TEST_F(KeystrokeFile, RefusesTimesThatDoNotRise) {
  expect_refused("t_s,position_m\n0,0\n0.002,0\n0.001,0\n", 4, {"t_s = 0.001 s after 0.002 s", "must rise"});
  expect_refused("t_s,position_m\n0,0\n0,0\n", 3, {"t_s = 0 s after 0 s", "must rise"});
  expect_refused("t_s,force_N\n0,0\n1e-300,5\n", 3, {"t_s = 1e-300 s", "must rise by 1e-06 s"});
  expect_refused("t_s,force_N\n0,0\n1e300,5\n", 3, {"t_s = 1e+300 s", "must be within +-86400 s"});
}

TEST_F(KeystrokeFile, RefusesRaggedRows) {
  expect_refused("t_s,position_m\n0,0\n1\n", 3, {"fewer values", "must have one for each"});
  expect_refused("t_s,position_m\n0,0\n1,0,0\n", 3, {"more values", "must have one for each"});
}

TEST_F(KeystrokeFile, TakesLargePositionsForMillimetres) {
  expect_refused("t_s,position_m\n0,0\n10,0.5\n20,9.8\n", 3,
                 {"position_m = 0.5 m", "must be within +-0.03 m", "positions are in metres", "millimetres"});
  expect_refused("t_s,position_m\n0,-0.031\n1,0\n", 2, {"position_m = -0.031 m", "must be within +-0.03 m"});
}

TEST_F(KeystrokeFile, RefusesPositionsFasterThanAnyKey) {
  expect_refused("t_s,position_m\n0,0\n0.001,0.0051\n", 3, {"position_m", "5.1 m/s", "must be within +-5 m/s"});
  expect_refused("t_s,position_m\n0,0.0051\n0.001,0\n", 3, {"-5.1 m/s", "must be within +-5 m/s"});
  EXPECT_NO_THROW(read_keystroke(file("t_s,position_m\n0,0\n0.001,0.0049\n")));
}

TEST_F(KeystrokeFile, RefusesForcesBeyondAnyFinger) {
  expect_refused("t_s,force_N\n0,0\n1,1000.5\n", 3, {"force_N = 1000.5 N", "must be within +-1000 N"});
}

TEST_F(KeystrokeFile, RefusesBinaryNoise) {
  std::string noise;
  std::uint32_t word = 1;  // seed 1 of a linear congruence: noise enough
  for (int i = 0; i < 4000; ++i) noise += static_cast<char>((word = word * 1664525U + 1013904223U) >> 24);
  expect_complaint(file(noise), ":", {"must"});
  expect_refused(std::string("t_s,position_m\n0,0\n\0,1\n", 22), 3, {"byte 0x00 is not text", "must be a CSV file"});
}

TEST_F(KeystrokeFile, RefusesLinesWithoutEnd) {
  expect_refused("t_s,position_m\n0,0\n" + std::string(5000, ' '), 3, {"the line does not end", "must have at most"});
}

TEST_F(KeystrokeFile, RefusesFilesThatAreNone) {
  expect_complaint(path("absent.csv"), ": ", {"cannot be read", "No such file"});
  expect_complaint(path(""), ": ", {"is a folder, must be a CSV file"});
}

TEST_F(KeystrokeFile, StopsReadingAnEndlessPipe) {
  signal(SIGPIPE, SIG_IGN);
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  std::thread writer([this] {
    std::ofstream pipe(path("pipe"), std::ios::binary);
    const std::string comment = "#" + std::string(900, '.') + "\n";
    while (pipe << comment) {
    }
  });
  expect_complaint(path("pipe"), ":", {"the file does not end", "must be at most 64 MiB"});
  writer.join();
  expect_complaint("/dev/zero", ":1: ", {"byte 0x00 is not text"});
}

// ---- writing

TEST_F(KeystrokeFile, ReadsBackWhatItWrote) {
  for (const KeystrokeQuantity quantity : {KeystrokeQuantity::position, KeystrokeQuantity::force}) {
    const Keystroke written(quantity, {-0.1, 1e-6, 1.0 / 3, 0.7}, {0, 1e-9, -0.01 / 3, 0.0098});
    write_keystroke(path("k.csv"), written, std::vector<std::string>{"source: nobody", "", "two\nlines"});
    const Keystroke read = read_keystroke(path("k.csv"));
    EXPECT_EQ(read.quantity(), quantity);
    EXPECT_TRUE(std::ranges::equal(read.times(), written.times()));  // exact, bit for bit
    EXPECT_TRUE(std::ranges::equal(read.values(), written.values()));
  }
}

TEST_F(KeystrokeFile, LeavesNothingBesideTheFile) {
  const Keystroke keystroke = positions({0, 1}, {0, 0.001});
  write_keystroke(path("k.csv"), keystroke);
  write_keystroke(path("k.csv"), keystroke);
  EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(KeystrokeFile, SaysWhenItCannotBeWritten) {
  const Keystroke keystroke = positions({0, 1}, {0, 0.001});
  fs::create_directories(path("folder/full"));
  EXPECT_THROW(write_keystroke(path("absent/k.csv"), keystroke), InputError);
  EXPECT_THROW(write_keystroke(path("folder"), keystroke), std::runtime_error);
  EXPECT_EQ(files_in_folder(), 1U) << "a half-written file was left";
}

TEST(Keystroke, EveryFileThatComesWithErardIsRead) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(ERARD_CONFIG_DIR "/keystrokes"))
    if (entry.path().extension() == ".csv") {
      ++count;
      const Keystroke keystroke = read_keystroke(entry.path());
      EXPECT_EQ(keystroke.at(keystroke.start()).value, 0) << entry.path();         // a stroke starts where y = 0
      EXPECT_NEAR(keystroke.at(keystroke.start()).rate, 0, 1e-6) << entry.path();  // [m/s] 0.1 mN through b
      EXPECT_GT(*std::ranges::max_element(keystroke.values()), 0.0097)
          << entry.path();  // [m] down to the rail: 9.75 mm
    }
  EXPECT_GE(count, 8);
}

}  // namespace
}  // namespace erard
