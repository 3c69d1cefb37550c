// Rate of a position that comes in samples, from the samples up to now: what a real device has in place of a spline.
//
// Each estimator fits a polynomial to the past and takes its slope at the newest sample. They differ in how they forget:
//   SlidingPolynomial  the last N samples count alike. N = 2, degree 1 is the backward difference, N = 3, degree 2 the
//                      backward difference of second order; longer ones are Savitzky and Golay's at the end point.
//   FadingPolynomial   every older sample counts less: the alpha-beta (degree 1) and alpha-beta-gamma (degree 2) tracker.
//   AdaptiveLine       the line through as many samples as it fits: long where the key is slow, short in a strike.
//
// All have
//   double update(double position)  takes the sample of now [m], returns the rate of now [m/s]. The first sample of all
//                                   counts as one that has always been there.
//   void reset(double position)     has always been at rest there
//   double delay() const            [s] at low frequency: an acceleration A is answered with the rate Y' - delay A
//   double noise_gain() const       [1/s] rms of the rate for white noise of 1 m rms on the position
// The two are what there is to choose between: b = 134 N s/m of the finger (thesis Table 3.1) makes a force of both.
// Degree 2 and more has no delay at low frequency and pays with noise; its error begins with the third derivative.
//
// The caller guarantees one finite sample each period. No heap, no exception, no memory beyond the object.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace erard {

/// The newest samples, at most N of them.
template <int N>
class LatestSamples {
 public:
  bool is_empty() const noexcept { return is_empty_; }
  void fill(double sample) noexcept {
    sample_.fill(sample);
    is_empty_ = false;
  }
  void push(double sample) noexcept {
    newest_ = (newest_ + 1) % N;
    sample_[newest_] = sample;
  }
  /// The sample of k periods ago, 0 <= k < N.
  double operator[](int k) const noexcept { return sample_[(newest_ - k + N) % N]; }

 private:
  std::array<double, N> sample_{};
  int newest_ = 0;
  bool is_empty_ = true;
};

/// Least squares over the last N samples, all with the same weight. Savitzky & Golay, Analytical Chemistry 36 (1964).
///   rate = sum_k w_k Y(t - k T)      delay = -T^2/2 sum_k k^2 w_k      noise gain = sqrt(sum_k w_k^2)
///   degree 1: delay (N - 1) T / 2,   noise gain sqrt(12 / (N (N^2 - 1))) / T
///   degree 2: delay 0,               noise gain sqrt(12 (2 N - 1) (8 N - 11) / (N (N^2 - 1) (N^2 - 4))) / T
/// Exact on polynomials of its degree. Cost: N products.
class SlidingPolynomial {
 public:
  static constexpr int kMaxLength = 64;
  static constexpr int kMaxDegree = 3;

  /// @param period  T [s] > 0
  /// @param length  N, taken into degree + 1 .. kMaxLength
  /// @param degree  taken into 1 .. kMaxDegree
  SlidingPolynomial(double period, int length, int degree) noexcept
      : period_(period),
        degree_(std::clamp(degree, 1, kMaxDegree)),
        length_(std::clamp(length, degree_ + 1, kMaxLength)) {
    // polynomials p_j in s = -k, orthogonal over the window by their three-term recurrence, and p_j, p_j' at s = 0;
    // the slope of the fit is sum_j p_j'(0) sum_k p_j(-k) Y_k / sum_k p_j(-k)^2
    std::array<double, kMaxLength> before{}, p{};
    p.fill(1);
    double end_before = 0, end = 1, slope_before = 0, slope = 0, square_before = 1;
    for (int j = 0; j <= degree_; ++j) {
      double square = 0, moment = 0;
      for (int k = 0; k < length_; ++k) {
        square += p[k] * p[k];
        moment -= k * p[k] * p[k];
      }
      const double a = moment / square, b = square / square_before;
      for (int k = 0; k < length_; ++k) {
        weight_[k] += slope * p[k] / (square * period);
        before[k] = (-k - a) * p[k] - b * before[k];  // p_j+1 = (s - a) p_j - b p_j-1
      }
      before.swap(p);
      slope_before = std::exchange(slope, end - a * slope - b * slope_before);
      end_before = std::exchange(end, -a * end - b * end_before);
      square_before = square;
    }
  }

  void reset(double position) noexcept { sample_.fill(position); }

  double update(double position) noexcept {
    if (sample_.is_empty()) reset(position);
    sample_.push(position);
    double rate = 0;
    for (int k = 1; k < length_; ++k) rate += weight_[k] * (sample_[k] - position);  // the weights' sum is 0
    return rate;
  }

  double delay() const noexcept {
    double moment = 0;
    for (int k = 0; k < length_; ++k) moment += weight_[k] * k * k;
    return -period_ * period_ / 2 * moment;
  }

  double noise_gain() const noexcept {
    double square = 0;
    for (int k = 0; k < length_; ++k) square += weight_[k] * weight_[k];
    return std::sqrt(square);
  }

 private:
  double period_;
  int degree_, length_;
  std::array<double, kMaxLength> weight_{};  // of the sample k periods ago [1/s]
  LatestSamples<kMaxLength> sample_;
};

/// Least squares over all samples, each counting by memory^age: the critically damped tracker
///   predicted = Y + T Y' + T^2/2 Y''        miss = sample - predicted
///   Y = predicted + alpha miss      Y' += T Y'' + beta/T miss      Y'' += 2 gamma/T^2 miss
///   degree 1: alpha = 1 - q^2, beta = (1 - q)^2, gamma = 0
///             delay T ((1 + q) / (1 - q) - 1/2),   noise gain sqrt(2 (1 - q)^3 / (1 + q)^3) / T
///   degree 2: alpha = 1 - q^3, beta = 3/2 (1 - q)^2 (1 + q), gamma = (1 - q)^3 / 2
///             delay 0,   noise gain sqrt((1 - q)^3 (13 + 50 q + 49 q^2) / (2 (1 + q)^5)) / T
/// with q = memory. Morrison, Introduction to Sequential Smoothing and Prediction (1969); the steady Kalman filter of
/// constant velocity or acceleration has the same form with other gains. What is left of a disturbance after n samples
/// falls like n^degree q^n. Cost: a dozen operations.
class FadingPolynomial {
 public:
  /// @param period  T [s] > 0
  /// @param memory  q, 0 <= q < 1; 0 is the backward difference, of first (degree 1) or second order (2)
  /// @param degree  1 or 2
  FadingPolynomial(double period, double memory, int degree) noexcept
      : period_(period),
        memory_(memory),
        is_parabola_(degree > 1),
        alpha_(is_parabola_ ? 1 - memory * memory * memory : 1 - memory * memory),
        beta_((1 - memory) * (1 - memory) * (is_parabola_ ? 1.5 * (1 + memory) : 1)),
        gamma_(is_parabola_ ? (1 - memory) * (1 - memory) * (1 - memory) / 2 : 0) {}

  void reset(double position) noexcept {
    position_ = position;
    rate_ = acceleration_ = 0;
    is_empty_ = false;
  }

  double update(double position) noexcept {
    if (is_empty_) reset(position);
    const double T = period_;
    const double predicted = position_ + T * rate_ + T * T / 2 * acceleration_;
    const double miss = position - predicted;
    position_ = predicted + alpha_ * miss;
    rate_ += T * acceleration_ + beta_ / T * miss;
    acceleration_ += 2 * gamma_ / (T * T) * miss;
    return rate_;
  }

  double delay() const noexcept { return is_parabola_ ? 0 : period_ * ((1 + memory_) / (1 - memory_) - 0.5); }

  double noise_gain() const noexcept {
    const double q = memory_;
    const double square = is_parabola_ ? (13 + 50 * q + 49 * q * q) / (2 * (1 + q) * (1 + q)) : 2;
    return std::sqrt(square * std::pow((1 - q) / (1 + q), 3)) / period_;
  }

 private:
  double period_, memory_;
  bool is_parabola_;
  double alpha_, beta_, gamma_;
  double position_ = 0, rate_ = 0, acceleration_ = 0;  // of the fit, now [m], [m/s], [m/s^2]
  bool is_empty_ = true;
};

/// The line of least squares through as many of the newest samples as it passes within `band` of each: lengths are tried
/// from 2 upwards until one fails. Janabi-Sharifi, Hayward & Chen, IEEE Trans. Control Systems Technology 8 (2000).
/// Where the key is slow the window is long and noise small; in a strike it is short, and so is the delay. A band of four
/// times the rms noise is left by noise alone once in 16000 samples (Gaussian). Where it is, the window shrinks to those
/// since then: narrower bands let single backward differences, with all their noise, into the middle of a stroke.
/// Exact on lines. Cost: at most longest^2 / 2 comparisons.
class AdaptiveLine {
 public:
  static constexpr int kMaxLength = 64;

  /// @param period   T [s] > 0
  /// @param band     [m] > 0
  /// @param longest  window [samples], taken into 2 .. kMaxLength
  AdaptiveLine(double period, double band, int longest = kMaxLength) noexcept
      : period_(period), band_(band), longest_(std::clamp(longest, 2, kMaxLength)) {}

  void reset(double position) noexcept {
    sample_.fill(position);
    length_ = longest_;
  }

  double update(double position) noexcept {
    if (sample_.is_empty()) reset(position);
    sample_.push(position);
    double sum = 0, moment = 0;  // of Y_k and k Y_k; Y_k counted from the newest, which keeps their digits
    double slope = 0;            // [m] a sample
    for (int n = 1; n <= longest_; ++n) {
      sum += sample_[n - 1] - position;
      moment += (n - 1) * (sample_[n - 1] - position);
      if (n == 1) continue;
      const double middle = (n - 1) / 2.0, mean = sum / n;
      const double candidate = -(moment - middle * sum) * 12 / (n * (n * n - 1.0));
      if (n > 2 && !is_within_band(n, position + mean + candidate * middle, candidate)) break;
      slope = candidate;
      length_ = n;
    }
    return slope / period_;
  }

  /// Samples in the window of the last update.
  int length() const noexcept { return length_; }
  /// Of a window of that length [s].
  double delay() const noexcept { return (length_ - 1) * period_ / 2; }
  /// Of a window of that length [1/s].
  double noise_gain() const noexcept { return std::sqrt(12 / (length_ * (length_ * length_ - 1.0))) / period_; }

 private:
  bool is_within_band(int length, double now, double slope) const noexcept {
    for (int k = 0; k < length; ++k)
      if (std::abs(sample_[k] - (now - k * slope)) > band_) return false;
    return true;
  }

  double period_, band_;
  int longest_;
  int length_ = 2;
  LatestSamples<kMaxLength> sample_;
};

}  // namespace erard
