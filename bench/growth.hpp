// How a time grows with a size, and from which size on one method is faster than another.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace erard::bench {

struct Growth {
  std::vector<double> size, time;  // sizes ascending
};

/// Exponent p of time = c size^p by least squares of the logarithms, from `smallest` on; NaN with less than 3 points.
inline double exponent(const Growth& growth, double smallest) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < growth.size.size(); ++i) {
    if (growth.size[i] < smallest) continue;
    const double a = std::log(growth.size[i]), b = std::log(growth.time[i]);
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return n < 3 ? std::numeric_limits<double>::quiet_NaN() : (n * xy - x * y) / (n * xx - x * x);
}

/// Size from which `one` stays faster than `other`, measured at the same sizes as far as both go: where the straight lines between the
/// logarithms cross for the last time; the smallest size when it always is, NaN when it is not at the largest.
inline double crossover(const Growth& one, const Growth& other) {
  const auto lead = [&](std::size_t i) { return std::log(other.time[i] / one.time[i]); };
  std::size_t i = std::min(one.size.size(), other.size.size()) - 1;
  if (!(lead(i) > 0)) return std::numeric_limits<double>::quiet_NaN();
  while (i > 0 && lead(i - 1) > 0) --i;
  if (i == 0) return one.size.front();
  const double part = lead(i - 1) / (lead(i - 1) - lead(i));
  return one.size[i - 1] * std::pow(one.size[i] / one.size[i - 1], part);
}

}  // namespace erard::bench
