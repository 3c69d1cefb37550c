// The velocity estimators of velocity.hpp by a setting.
#pragma once

#include <algorithm>
#include <variant>

#include "erard/haptics/velocity.hpp"

namespace erard {

enum class RateEstimatorKind { sliding_polynomial, fading_polynomial, adaptive_line };

/// Which of them, and how; what a kind does not name it does not look at.
struct RateEstimatorSettings {
  RateEstimatorKind kind = RateEstimatorKind::sliding_polynomial;
  int length = 6;       // window of sliding_polynomial, longest window of adaptive_line [samples]
  int degree = 2;       // of the polynomials
  double memory = 0.4;  // of fading_polynomial, 0 <= memory < 1
  double band = 2e-4;   // of adaptive_line: four times the rms noise of the sensor [m]
};

/// One of the three, in place: 1.1 kB.
class RateEstimator {
 public:
  /// @param period  of the samples [s] > 0
  RateEstimator(const RateEstimatorSettings& settings, double period) noexcept : estimator_(make(settings, period)) {}

  double update(double position) noexcept {
    return std::visit([position](auto& e) noexcept { return e.update(position); }, estimator_);
  }
  void reset(double position) noexcept {
    std::visit([position](auto& e) noexcept { e.reset(position); }, estimator_);
  }
  double delay() const noexcept {
    return std::visit([](const auto& e) noexcept { return e.delay(); }, estimator_);
  }

 private:
  using Any = std::variant<SlidingPolynomial, FadingPolynomial, AdaptiveLine>;

  static Any make(const RateEstimatorSettings& s, double period) noexcept {
    switch (s.kind) {
      case RateEstimatorKind::sliding_polynomial: return SlidingPolynomial(period, s.length, s.degree);
      case RateEstimatorKind::fading_polynomial: return FadingPolynomial(period, s.memory, s.degree);
      case RateEstimatorKind::adaptive_line: break;
    }
    return AdaptiveLine(period, s.band, s.length);
  }

  Any estimator_;
};

}  // namespace erard
