#include "study/causal_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "erard/device/keystroke_input.hpp"
#include "erard/haptics/events.hpp"
#include "erard/mechanics/rest.hpp"
#include "study/defaults.hpp"

namespace erard::study {
namespace {

constexpr double kPeriod = 5e-4;            // [s] 2 kHz
constexpr double kFinestResolution = 1e-6;  // [m] a band below it would follow the last digit

/// Plays an input from rest; `before` is called with the time before each tick, to let the input know its sample.
/// @return force of the finger at the end of each period [N]
template <typename Input, typename Before>
std::vector<double> play(const ActionFile& action, const Input& input, double from, double until, Before&& before,
                         double& hammer_speed) {
  const Mechanism mechanism = build_mechanism(action.model);
  TickSettings settings;
  settings.set_rate(1 / kPeriod);
  State state = rest_state(mechanism, settings.scheme.time_step);
  const auto work = std::make_unique<Workspace>();
  EventDetector detector(mechanism, action.roles);
  const auto observe = [&](const State& now, const StepReport&, double force) noexcept {
    detector.observe(now, force);
  };
  std::vector<double> force;
  const long periods = std::lround((until - from) / kPeriod);
  for (long i = 0; i < periods; ++i) {
    state.time = from + static_cast<double>(i) * kPeriod;
    before(state.time);
    force.push_back(tick(mechanism, settings, input, state, *work, observe).force);
  }
  hammer_speed = std::numeric_limits<double>::quiet_NaN();
  for (int i = detector.count(); i-- > 0;)
    if (detector[i].kind == EventKind::hammer_meets_string) hammer_speed = detector[i].hammer_speed;
  return force;
}

/// A curve at the ends of the periods.
ForceCurve curve_of(const std::vector<double>& force, double from) {
  ForceCurve curve;
  for (std::size_t i = 0; i < force.size(); ++i) {
    curve.time.push_back(from + static_cast<double>(i + 1) * kPeriod);
    curve.force.push_back(force[i]);
  }
  return curve;
}

/// rms of a[i + shift] - b[i].
double rms_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t shift) {
  double sum = 0;
  for (std::size_t i = 0; i + shift < a.size(); ++i) sum += std::pow(a[i + shift] - b[i], 2);
  return std::sqrt(sum / static_cast<double>(a.size() - shift));
}

}  // namespace

void CausalInput::push(double time, double position) noexcept {
  const double rate = std::visit([&](auto& estimator) noexcept { return estimator.update(position); }, estimator_);
  last_ = is_empty_ ? DriveSample{position, rate} : newest_;
  newest_ = {position, rate};
  time_ = time;
  is_empty_ = false;
}

DriveSample CausalInput::at(double time) const noexcept {
  const double since = time - time_;
  if (between_ == Between::extrapolated) return {newest_.value + since * newest_.rate, newest_.rate};
  const double part = since / period_;
  return {last_.value + part * (newest_.value - last_.value), last_.rate + part * (newest_.rate - last_.rate)};
}

const char* name_of(Between between) { return between == Between::extrapolated ? "extrapolated" : "interpolated"; }

std::string name_of(const Candidate& candidate) {
  const double s = candidate.setting;
  switch (candidate.family) {
    case Family::sliding_line: return s == 2 ? "backward difference" : fmt::format("line of {} samples", s);
    case Family::sliding_parabola: return s == 3 ? "second-order difference" : fmt::format("parabola of {} samples", s);
    case Family::fading_line: return fmt::format("alpha-beta, memory {}", s);
    case Family::fading_parabola: return fmt::format("alpha-beta-gamma, memory {}", s);
    case Family::adaptive_line: break;
  }
  return fmt::format("adaptive line, band {} sigma", s);
}

VelocityEstimator make_estimator(const Candidate& candidate, double noise) {
  const int samples = static_cast<int>(candidate.setting);
  switch (candidate.family) {
    case Family::sliding_line: return SlidingPolynomial(kPeriod, samples, 1);
    case Family::sliding_parabola: return SlidingPolynomial(kPeriod, samples, 2);
    case Family::fading_line: return FadingPolynomial(kPeriod, candidate.setting, 1);
    case Family::fading_parabola: return FadingPolynomial(kPeriod, candidate.setting, 2);
    case Family::adaptive_line: break;
  }
  return AdaptiveLine(kPeriod, candidate.setting * std::max(noise, kFinestResolution));
}

const std::vector<Candidate>& all_candidates() {
  static const std::vector<Candidate> candidates = [] {
    std::vector<Candidate> all;
    for (const double s : {2, 3, 4, 5, 6, 8, 10, 12, 16, 24}) all.push_back({Family::sliding_line, s});
    for (const double s : {3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32}) all.push_back({Family::sliding_parabola, s});
    for (const double s : {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85}) {
      all.push_back({Family::fading_line, s});
      all.push_back({Family::fading_parabola, s});
    }
    for (const double s : {2, 3, 4, 5, 6}) all.push_back({Family::adaptive_line, s});
    return all;
  }();
  return candidates;
}

OfflineRun play_offline(const ActionFile& action, const std::string& name, double from, double until) {
  OfflineRun run{name, default_keystroke(name), from, until, {}, 0};
  run.force = play(
      action, KeystrokeInput{&run.keystroke}, from, until, [](double) {}, run.hammer_speed);
  return run;
}

ForceCurve play_causal(const ActionFile& action, const OfflineRun& truth, const Candidate& candidate, Between between,
                       double noise, unsigned seed, double* hammer_speed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> error;
  CausalInput input(kPeriod, between, make_estimator(candidate, noise));
  const auto sample = [&](double time) { input.push(time, truth.keystroke.at(time).value + noise * error(random)); };
  double speed = 0;
  const ForceCurve curve = curve_of(play(action, input, truth.from, truth.until, sample, speed), truth.from);
  if (hammer_speed != nullptr) *hammer_speed = speed;
  return curve;
}

InputCost causal_cost(const ActionFile& action, const OfflineRun& truth, const Candidate& candidate, Between between,
                      double noise, int seeds) {
  const std::size_t delay = between == Between::interpolated ? 1 : 0;  // periods
  const ForceCurve reference = curve_of(truth.force, truth.from);
  InputCost cost;
  for (int seed = 1; seed <= seeds; ++seed) {
    double speed = 0;
    const ForceCurve curve = play_causal(action, truth, candidate, between, noise, static_cast<unsigned>(seed), &speed);
    cost.eta += std::pow(relative_error(reference, curve, truth.until), 2) / seeds;
    cost.rms += std::pow(rms_difference(curve.force, truth.force, 0), 2) / seeds;
    cost.rms_in_step += std::pow(rms_difference(curve.force, truth.force, delay), 2) / seeds;
    for (std::size_t i = 0; i < curve.force.size(); ++i)
      cost.largest = std::max(cost.largest, std::abs(curve.force[i] - truth.force[i]));
    const double difference = std::abs(speed - truth.hammer_speed);
    cost.hammer_speed = std::isnan(difference) ? difference : std::max(cost.hammer_speed, difference);
  }
  for (double* mean_square : {&cost.eta, &cost.rms, &cost.rms_in_step}) *mean_square = std::sqrt(*mean_square);
  return cost;
}

double rate_error(const OfflineRun& truth, const Candidate& candidate) {
  VelocityEstimator estimator = make_estimator(candidate, 0);
  double sum = 0;
  const long samples = std::lround((truth.until - truth.from) / kPeriod) + 1;
  for (long i = 0; i < samples; ++i) {
    const Sample at = truth.keystroke.at(truth.from + static_cast<double>(i) * kPeriod);
    sum += std::pow(std::visit([&](auto& e) { return e.update(at.value); }, estimator) - at.rate, 2);
  }
  return std::sqrt(sum / static_cast<double>(samples));
}

}  // namespace erard::study
