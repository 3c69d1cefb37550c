#include "bench/distribution.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace erard::bench {

double quantile(std::span<const double> rising, double q) {
  if (rising.empty()) return Distribution::kNone;
  const auto count = static_cast<double>(rising.size());
  const double rank = std::ceil(q * count - 1e-9 * count);  // q n = 999.0000000001 is 999
  return rising[static_cast<std::size_t>(std::clamp(rank - 1, 0.0, count - 1))];
}

bool is_stated(std::size_t count, double q) { return static_cast<double>(count) * (1 - q) >= kValuesBeyond - 1e-6; }

double Distribution::tail() const { return std::isnan(p999) ? max : p999; }

Distribution describe(std::span<double> values) {
  std::sort(values.begin(), values.end());
  Distribution d;
  d.count = values.size();
  if (values.empty()) return d;
  const auto stated = [&](double q) { return is_stated(d.count, q) ? quantile(values, q) : Distribution::kNone; };
  d.total = std::accumulate(values.begin(), values.end(), 0.0);
  d.min = values.front();
  d.median = quantile(values, 0.5);
  d.p99 = stated(0.99);
  d.p999 = stated(0.999);
  d.p9999 = stated(0.9999);
  d.max = values.back();
  return d;
}

std::vector<double> fastest_of_passes(std::span<const double> times, std::size_t length) {
  if (times.size() < kPasses * length) return {};
  std::vector<double> fastest(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(length));
  for (std::size_t i = 0; i < times.size() / length * length; ++i)
    fastest[i % length] = std::min(fastest[i % length], times[i]);
  return fastest;
}

}  // namespace erard::bench
