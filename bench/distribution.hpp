// What is told of many timings: their distribution, never a mean alone.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace erard::bench {

/// Quantile q of values in rising order, by nearest rank: the smallest of them that at least a share q of all do not
/// exceed. Exact, one of the values; NaN when there are none.
double quantile(std::span<const double> rising, double q);

/// A quantile says nothing when no more than a handful of values lie beyond it: with ten, their number has a standard
/// error of a third. So p99 takes 1000 values, p99.9 ten thousand, p99.99 a hundred thousand.
inline constexpr double kValuesBeyond = 10;
bool is_stated(std::size_t count, double q);

/// In the unit of the values. Quantiles that are not stated, and all of an empty set, are NaN.
struct Distribution {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::size_t count = 0;
  double total = 0;
  double min = kNone, median = kNone, p99 = kNone, p999 = kNone, p9999 = kNone, max = kNone;

  /// p99.9, or the largest value where that is not stated: never less than what it stands for.
  double tail() const;
};

/// @param values  in any order; sorted by this
Distribution describe(std::span<double> values);

/// Of something that is the same every time it is played: each of its ticks at its fastest. What other jobs and
/// interrupts did to one pass they did not do to all of them, so this is the engine's own, dear ticks included.
/// @param times  pass after pass, each of `length` ticks
/// @return `length` times; empty with less than kPasses passes
std::vector<double> fastest_of_passes(std::span<const double> times, std::size_t length);
inline constexpr std::size_t kPasses = 5;

}  // namespace erard::bench
