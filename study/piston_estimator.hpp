// From the samples of a device to position and rate of the piston: the ways that the closed loop is tried with.
#pragma once

#include <string>
#include <variant>

#include "study/causal_input.hpp"
#include "study/lever_observer.hpp"

namespace erard::study {

/// The sample as it is, its rate by one of the estimators of velocity.hpp; or position and rate by the observer, which
/// is told the commands.
class PistonEstimator {
 public:
  template <typename Estimator>
  PistonEstimator(const Estimator& estimator) : estimator_(estimator) {}

  DriveSample update(double position) {
    return std::visit(
        [&](auto& e) -> DriveSample {
          if constexpr (requires { e.sent(0.0); })
            return e.update(position);
          else
            return {position, e.update(position)};
        },
        estimator_);
  }
  void sent(double command) {
    if (auto* observer = std::get_if<LeverObserver>(&estimator_)) observer->sent(command);
  }
  void reset(double position) {
    std::visit([&](auto& e) { e.reset(position); }, estimator_);
  }

 private:
  std::variant<SlidingPolynomial, FadingPolynomial, AdaptiveLine, LeverObserver> estimator_;
};

}  // namespace erard::study
