// What the input of a real device costs: it knows the piston in samples up to now, and has to estimate its rate.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/force_curve.hpp"
#include "erard/device/keystroke.hpp"
#include "erard/haptics/tick.hpp"
#include "erard/haptics/velocity.hpp"
#include "study/section.hpp"

namespace erard::study {

using VelocityEstimator = std::variant<SlidingPolynomial, FadingPolynomial, AdaptiveLine>;

/// Where the piston is in the period that begins with the newest sample Y_n, at t_n, of estimated rate V_n.
enum class Between {
  extrapolated,  // Y_n + (t - t_n) V_n, rate V_n: no delay; at the end of the period the rate is a period old
  interpolated,  // on straight lines from Y_n-1 and V_n-1 to Y_n and V_n: what it was a period ago
};
const char* name_of(Between between);

/// Input of tick() from the samples known so far: push() the sample of now, then tick().
class CausalInput {
 public:
  /// @param period  T of the samples and of the ticks [s]
  CausalInput(double period, Between between, const VelocityEstimator& estimator) noexcept
      : period_(period), between_(between), estimator_(estimator) {}

  /// @param time      of the sample [s], one period after the one before
  /// @param position  [m]
  void push(double time, double position) noexcept;

  /// For `time` in the period that begins with the newest sample; position 0 at rest before the first.
  DriveSample at(double time) const noexcept;

  /// Of the position [s]; the rate has that of its estimator besides.
  double delay() const noexcept { return between_ == Between::interpolated ? period_ : 0; }

 private:
  double period_;
  Between between_;
  VelocityEstimator estimator_;
  double time_ = 0;            // of the newest sample [s]
  DriveSample newest_, last_;  // and the one before
  bool is_empty_ = true;
};

/// The estimators that are compared, each with one setting.
enum class Family { sliding_line, sliding_parabola, fading_line, fading_parabola, adaptive_line };
struct Candidate {
  Family family = Family::sliding_line;
  double setting = 0;  // samples; memory; band, in rms of the noise (of 1 um where there is less)
};
std::string name_of(const Candidate& candidate);
VelocityEstimator make_estimator(const Candidate& candidate, double noise);
const std::vector<Candidate>& all_candidates();

/// A keystroke as it is played offline, its samples joined by a spline: the truth of this study.
struct OfflineRun {
  std::string name;
  Keystroke keystroke;
  double from = 0, until = 0;  // [s]
  std::vector<double> force;   // of the finger at the end of each period [N]
  double hammer_speed = 0;     // at the first string impact [m/s]; NaN without
};
OfflineRun play_offline(const ActionFile& action, const std::string& name, double from, double until);

/// The same from samples with white Gaussian noise.
struct InputCost {
  double eta = 0;           // [-] thesis (6.3)
  double rms = 0;           // of the force, at the same instant [N]
  double largest = 0;       // [N]
  double rms_in_step = 0;   // with the delay of the position taken out [N]
  double hammer_speed = 0;  // magnitude of the difference [m/s]; NaN when either run has no impact
};
/// @param noise  rms [m]
/// @param seeds  noises drawn, 1 .. seeds: eta and rms in the root mean square, largest and hammer_speed the largest of them
InputCost causal_cost(const ActionFile& action, const OfflineRun& truth, const Candidate& candidate, Between between,
                      double noise, int seeds);
/// One of them, for a plot.
ForceCurve play_causal(const ActionFile& action, const OfflineRun& truth, const Candidate& candidate, Between between,
                       double noise, unsigned seed, double* hammer_speed = nullptr);

/// rms of estimated less spline rate at the samples, without noise [m/s]; times b it is the force on a held key.
double rate_error(const OfflineRun& truth, const Candidate& candidate);

Section causal_input_section(const Pictures& pictures);

}  // namespace erard::study
