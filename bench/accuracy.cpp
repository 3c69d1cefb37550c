#include "bench/accuracy.hpp"

#include <algorithm>
#include <cmath>

namespace erard::bench {
namespace {

/// By straight lines, constant outside.
double value_at(const ForceCurve& curve, double time) {
  const auto after = std::lower_bound(curve.time.begin(), curve.time.end(), time);
  const auto i = static_cast<std::size_t>(after - curve.time.begin());
  if (i == 0) return curve.force.front();
  if (i == curve.time.size()) return curve.force.back();
  const double share = (time - curve.time[i - 1]) / (curve.time[i] - curve.time[i - 1]);
  return curve.force[i - 1] + share * (curve.force[i] - curve.force[i - 1]);
}

}  // namespace

ForceCurve force_of(Contender& contender, double rate_Hz, double end, const std::function<bool()>& goes_on) {
  ForceCurve curve;
  const long ticks = std::lround(end * rate_Hz);
  contender.start();
  for (long i = 1; i <= ticks && goes_on(); ++i) {
    contender.prepare();
    contender.tick({});
    curve.time.push_back(static_cast<double>(i) / rate_Hz);
    curve.force.push_back(contender.force());
  }
  return curve;
}

ForceCurve converged_force(const Maker& make, const Stage& stage, const Scene& scene, FeltModel felts,
                           const std::function<bool()>& goes_on) {
  Job job{&scene, 1, kConvergedRate_Hz, kConvergedSubsteps};
  job.felts = felts;
  const auto contender = make(stage, job);
  return force_of(*contender, kConvergedRate_Hz, scene.release, goes_on);
}

Error error_of(const ForceCurve& truth, const ForceCurve& force, double end) {
  Error error;
  if (truth.time.size() < 2) return error;
  ForceCurve there{force.time, {}};  // the truth at the instants of `force`
  for (const double time : force.time) there.force.push_back(value_at(truth, time));
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < force.time.size() && force.time[i] <= end; ++i, ++count) {
    const double e = force.force[i] - there.force[i];
    sum += e * e;
  }
  if (count < 2) return error;
  error.eta = relative_error(there, force, end);
  error.rms_N = std::sqrt(sum / count);
  return error;
}

}  // namespace erard::bench
