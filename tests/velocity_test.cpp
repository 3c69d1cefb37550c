// Causal velocity estimators: exact where they claim to be, delay and noise as stated, over a jump, without heap.
#include "erard/haptics/velocity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/heap_calls.hpp"

namespace erard {
namespace {

constexpr double kPeriod = 5e-4;    // [s] 2 kHz
constexpr double kRounding = 1e-9;  // [m/s] positions below 1 m, weights below 1e4 1/s, up to 64 of them, 1e-16 each

struct Window {
  int length, degree;
};
const std::vector<Window> kWindows{{2, 1}, {3, 1}, {8, 1}, {64, 1}, {3, 2}, {5, 2}, {16, 2}, {64, 2}, {4, 3}, {24, 3}};

struct Memory {
  double memory;
  int degree;
};
const std::vector<Memory> kMemories{{0, 1}, {0.5, 1}, {0.8, 1}, {0, 2}, {0.5, 2}, {0.8, 2}};

/// Samples until nothing is left of the start: a window's length; what a tracker of memory 0.8 forgets to 1e-20.
constexpr int kSettled = 256;

double polynomial(const std::vector<double>& coefficients, double t) {
  double value = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) value = value * t + coefficients[i];
  return value;
}

/// Estimate minus rate of a polynomial of time, at t = 0, after kSettled samples.
template <typename Estimator>
double error_on(Estimator estimator, const std::vector<double>& coefficients) {
  double estimate = 0;
  for (int i = -kSettled; i <= 0; ++i) estimate = estimator.update(polynomial(coefficients, i * kPeriod));
  return estimate - coefficients[1];
}

/// Delay [s] from the phase of a slow sine: rate = cos(w (t - delay)) w, by its products with sin and cos over a period.
template <typename Estimator>
double measured_delay(Estimator estimator, double frequency) {
  const double w = 2 * std::numbers::pi * frequency;
  const int samples = static_cast<int>(std::lround(1 / (frequency * kPeriod)));
  double in_phase = 0, behind = 0;
  for (int i = -samples; i < samples; ++i) {
    const double rate = estimator.update(std::sin(w * i * kPeriod));
    if (i < 0) continue;
    in_phase += rate * std::cos(w * i * kPeriod);
    behind += rate * std::sin(w * i * kPeriod);
  }
  return std::atan2(behind, in_phase) / w;
}

/// rms of the rate [1/s] for white Gaussian noise of 1 m.
template <typename Estimator>
double measured_noise_gain(Estimator estimator) {
  std::mt19937 random(20130607);
  std::normal_distribution<double> noise;
  constexpr int kSamples = 400000;
  double sum = 0;
  for (int i = -kSettled; i < kSamples; ++i) {
    const double rate = estimator.update(noise(random));
    if (i >= 0) sum += rate * rate;
  }
  return std::sqrt(sum / kSamples);
}
// four standard errors, sqrt(1 / 2n), of 400000 independent samples; with this seed 0.0012 is the most that is seen
constexpr double kNoiseTolerance = 0.0045;

TEST(SlidingPolynomial, IsExactOnPolynomialsOfItsDegree) {
  for (const Window& window : kWindows) {
    SCOPED_TRACE(window.length);
    std::vector<double> coefficients{0.003, 0.7, -12, 900};
    coefficients.resize(static_cast<std::size_t>(window.degree) + 1);
    EXPECT_NEAR(error_on(SlidingPolynomial(kPeriod, window.length, window.degree), coefficients), 0, kRounding);
  }
}

TEST(SlidingPolynomial, IsTheBackwardDifferencesAtItsShortest) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> position(0, 0.01);
  SlidingPolynomial first(kPeriod, 2, 1), second(kPeriod, 3, 2);
  double y2 = 0, y1 = 0;
  for (int i = 0; i < 100; ++i) {
    const double y = position(random);
    const double of_first = first.update(y), of_second = second.update(y);
    if (i >= 2) {
      EXPECT_NEAR(of_first, (y - y1) / kPeriod, kRounding);
      EXPECT_NEAR(of_second, (1.5 * y - 2 * y1 + 0.5 * y2) / kPeriod, kRounding);
    }
    y2 = y1;
    y1 = y;
  }
}

TEST(SlidingPolynomial, TakesItsLengthAndDegreeIntoTheirBounds) {
  // a line needs two samples, a cubic four; the ring holds 64
  EXPECT_EQ(SlidingPolynomial(kPeriod, 0, 1).noise_gain(), SlidingPolynomial(kPeriod, 2, 1).noise_gain());
  EXPECT_EQ(SlidingPolynomial(kPeriod, 2, 9).noise_gain(), SlidingPolynomial(kPeriod, 4, 3).noise_gain());
  EXPECT_EQ(SlidingPolynomial(kPeriod, 1000, 2).noise_gain(), SlidingPolynomial(kPeriod, 64, 2).noise_gain());
}

TEST(SlidingPolynomial, HasTheStatedDelay) {
  for (const Window& window : kWindows) {
    SCOPED_TRACE(window.length);
    const SlidingPolynomial estimator(kPeriod, window.length, window.degree);
    const double stated = window.degree == 1 ? (window.length - 1) * kPeriod / 2 : 0;
    EXPECT_NEAR(estimator.delay(), stated, 1e-12);
    // on a parabola of 20 m/s^2 the delay is all the error there is
    EXPECT_NEAR(error_on(estimator, {0, 0.1, 10}), -20 * stated, kRounding);
    // phase of a sine of 0.5 Hz: the next order is (w N T)^2 = 0.01 of N T at 64 samples
    EXPECT_NEAR(measured_delay(estimator, 0.5), stated, 0.01 * window.length * kPeriod);
  }
}

TEST(SlidingPolynomial, HasTheStatedNoiseGain) {
  for (const Window& window : kWindows) {
    SCOPED_TRACE(window.length);
    const SlidingPolynomial estimator(kPeriod, window.length, window.degree);
    const double N = window.length;
    const double line = std::sqrt(12 / (N * (N * N - 1))) / kPeriod;
    const double parabola = std::sqrt(12 * (2 * N - 1) * (8 * N - 11) / (N * (N * N - 1) * (N * N - 4))) / kPeriod;
    if (window.degree < 3) {
      EXPECT_NEAR(estimator.noise_gain() / (window.degree == 1 ? line : parabola), 1, 1e-10);  // rounding
    }
    EXPECT_NEAR(measured_noise_gain(estimator) / estimator.noise_gain(), 1, kNoiseTolerance);
  }
}

TEST(SlidingPolynomial, ForgetsAJumpAfterItsLength) {
  for (const Window& window : kWindows) {
    SCOPED_TRACE(window.length);
    SlidingPolynomial estimator(kPeriod, window.length, window.degree);
    for (int i = 0; i < kSettled; ++i) estimator.update(0.001);
    EXPECT_GT(estimator.update(0.004), 0.005);  // it does see the jump
    for (int i = 1; i + 1 < window.length; ++i) estimator.update(0.004);
    EXPECT_NEAR(estimator.update(0.004), 0, kRounding);
  }
}

TEST(FadingPolynomial, IsExactOnPolynomialsOfItsDegree) {
  for (const Memory& memory : kMemories) {
    SCOPED_TRACE(memory.memory);
    std::vector<double> coefficients{0.003, 0.7, -12};
    coefficients.resize(static_cast<std::size_t>(memory.degree) + 1);
    EXPECT_NEAR(error_on(FadingPolynomial(kPeriod, memory.memory, memory.degree), coefficients), 0, kRounding);
  }
}

TEST(FadingPolynomial, WithoutMemoryIsTheBackwardDifferences) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> position(0, 0.01);
  FadingPolynomial first(kPeriod, 0, 1), second(kPeriod, 0, 2);
  SlidingPolynomial same_first(kPeriod, 2, 1), same_second(kPeriod, 3, 2);
  for (int i = 0; i < 100; ++i) {
    const double y = position(random);
    EXPECT_NEAR(first.update(y), same_first.update(y), kRounding);
    EXPECT_NEAR(second.update(y), same_second.update(y), kRounding);
  }
}

TEST(FadingPolynomial, HasTheStatedDelay) {
  for (const Memory& memory : kMemories) {
    SCOPED_TRACE(memory.memory);
    const FadingPolynomial estimator(kPeriod, memory.memory, memory.degree);
    EXPECT_NEAR(error_on(estimator, {0, 0.1, 10}), -20 * estimator.delay(), kRounding);
    // phase of a sine of 0.5 Hz: memory 0.8 reaches back 10 samples, the next order is below 1e-3 of its 4 ms
    EXPECT_NEAR(measured_delay(estimator, 0.5), estimator.delay(), 5e-6);
  }
  EXPECT_NEAR(FadingPolynomial(kPeriod, 0.8, 1).delay(), 8.5 * kPeriod, 1e-12);  // (1.8 / 0.2 - 0.5) T
}

TEST(FadingPolynomial, HasTheStatedNoiseGain) {
  for (const Memory& memory : kMemories) {
    SCOPED_TRACE(memory.memory);
    const FadingPolynomial estimator(kPeriod, memory.memory, memory.degree);
    EXPECT_NEAR(measured_noise_gain(estimator) / estimator.noise_gain(), 1, kNoiseTolerance);
  }
}

TEST(FadingPolynomial, ForgetsAJumpAsFastAsItsMemoryFades) {
  for (const Memory& memory : kMemories) {
    SCOPED_TRACE(memory.memory);
    FadingPolynomial estimator(kPeriod, memory.memory, memory.degree);
    for (int i = 0; i < 10; ++i) estimator.update(0.001);
    EXPECT_GT(estimator.update(0.004), 0.005);
    for (int i = 0; i < 100; ++i) estimator.update(0.004);
    // beta + gamma < 3, a jump of 6 samples' rate, n^degree q^n at n = 100
    const double left = 3 * 0.003 / kPeriod * std::pow(100.0, memory.degree) * std::pow(memory.memory, 100);
    EXPECT_NEAR(estimator.update(0.004), 0, left + kRounding);
  }
}

TEST(AdaptiveLine, IsExactOnLinesWithItsLongestWindow) {
  AdaptiveLine estimator(kPeriod, 1e-9, 20);
  for (int i = 0; i < kSettled; ++i)
    EXPECT_NEAR(estimator.update(0.3 * i * kPeriod), i == 0 ? 0 : 0.3, i < 20 ? 0.3 : kRounding);
  EXPECT_EQ(estimator.length(), 20);
}

TEST(AdaptiveLine, KeepsToTheBandWhereTheKeyAccelerates) {
  // a parabola is A (N - 1)^2 T^2 / 12 off its line at the ends of a long window: the window ends where that is the band
  constexpr double kBand = 20e-6, kAcceleration = 20;
  AdaptiveLine estimator(kPeriod, kBand);
  double rate = 0;
  for (int i = -kSettled; i <= 0; ++i) rate = estimator.update(0.5 * kAcceleration * std::pow(i * kPeriod, 2));
  const double longest = 1 + std::sqrt(12 * kBand / kAcceleration) / kPeriod;  // 7.9
  EXPECT_NEAR(estimator.length(), longest, 1);                                 // to a sample
  EXPECT_NEAR(rate, -kAcceleration * estimator.delay(), kRounding);
}

TEST(AdaptiveLine, HasTheStatedNoiseGainWhereTheBandHoldsAllNoise) {
  // six times the rms noise is left once in 5e8 samples
  const AdaptiveLine estimator(kPeriod, 6, 16);
  const double stated = SlidingPolynomial(kPeriod, 16, 1).noise_gain();
  EXPECT_NEAR(measured_noise_gain(estimator) / stated, 1, kNoiseTolerance);
  AdaptiveLine used = estimator;
  used.update(0);
  EXPECT_NEAR(used.noise_gain() / stated, 1, 1e-12);
  EXPECT_NEAR(used.delay(), 7.5 * kPeriod, 1e-12);
}

TEST(AdaptiveLine, StopsAtTheFirstWindowThatFails) {
  // +, -, + by 0.9 of the band is 1.2 bands off the line of three, while all 64 would be within the band of theirs
  constexpr double kBand = 100e-6;
  AdaptiveLine estimator(kPeriod, kBand);
  double rate = 0;
  for (int i = 0; i < kSettled; ++i) rate = estimator.update(i % 2 == 0 ? 0.9 * kBand : -0.9 * kBand);
  EXPECT_EQ(estimator.length(), 2);
  EXPECT_NEAR(rate, -1.8 * kBand / kPeriod, kRounding);
}

TEST(AdaptiveLine, LeavesAJumpBehindWithTheSecondSample) {
  AdaptiveLine estimator(kPeriod, 100e-6);
  for (int i = 0; i < 100; ++i) estimator.update(0.001);
  EXPECT_NEAR(estimator.update(0.004), 0.003 / kPeriod, kRounding);
  EXPECT_NEAR(estimator.update(0.004), 0, kRounding);
}

template <typename Estimator>
void expect_reset_to_rest(Estimator used, Estimator fresh) {
  for (int i = 0; i < 100; ++i) used.update(std::sin(0.1 * i));
  used.reset(0.002);
  for (int i = 0; i < 100; ++i) {
    const double y = 0.002 + 0.001 * std::sin(0.05 * i);  // starts where the reset was
    EXPECT_EQ(used.update(y), fresh.update(y)) << i;
  }
}

TEST(VelocityEstimators, StartAtRestAtTheFirstSampleAndAfterAReset) {
  EXPECT_EQ(SlidingPolynomial(kPeriod, 8, 2).update(0.005), 0) << "at rest";
  EXPECT_EQ(FadingPolynomial(kPeriod, 0.5, 2).update(0.005), 0);
  EXPECT_EQ(AdaptiveLine(kPeriod, 1e-6).update(0.005), 0);
  expect_reset_to_rest(SlidingPolynomial(kPeriod, 8, 1), SlidingPolynomial(kPeriod, 8, 1));
  expect_reset_to_rest(FadingPolynomial(kPeriod, 0.5, 2), FadingPolynomial(kPeriod, 0.5, 2));
  expect_reset_to_rest(AdaptiveLine(kPeriod, 1e-5), AdaptiveLine(kPeriod, 1e-5));
}

template <typename Estimator>
constexpr bool kIsFitForRealTime = std::is_trivially_copyable_v<Estimator>&& noexcept(
    std::declval<Estimator&>().update(0.0)) && noexcept(std::declval<Estimator&>().reset(0.0));

TEST(VelocityEstimators, MakeNoHeapCall) {
  static_assert(kIsFitForRealTime<SlidingPolynomial> && kIsFitForRealTime<FadingPolynomial> &&
                kIsFitForRealTime<AdaptiveLine>);
  const long before = heap_calls;
  SlidingPolynomial sliding(kPeriod, 64, 3);
  FadingPolynomial fading(kPeriod, 0.8, 2);
  AdaptiveLine adaptive(kPeriod, 1e-4);
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += sliding.update(i) + fading.update(i) + adaptive.update(i);
  EXPECT_EQ(heap_calls, before);
  EXPECT_GT(sum, 0);
  const std::vector<double> some(100);
  EXPECT_GT(heap_calls, before) << some.size();  // the counter counts
}

}  // namespace
}  // namespace erard
