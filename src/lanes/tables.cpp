#include "tables.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

namespace erard::lanes {
namespace {

using Long = long double;

void split(Long value, double* sum) noexcept {
  sum[0] = static_cast<double>(value);
  sum[1] = static_cast<double>(value - static_cast<Long>(sum[0]));
}

Tables make_tables() noexcept {
  constexpr int kShift = 52 - 7;
  Tables t{};
  for (int i = 0; i < Tables::kPoints; ++i) {
    const std::uint64_t half = std::uint64_t{1} << (kShift - 1);
    const std::uint64_t bits = kLeastBits + (static_cast<std::uint64_t>(i) << kShift) + half;
    // an interval that reaches beyond 1 lies in the next octave as the bits count
    auto& [log, log_rest, inverse, unused] = t.logarithm[i];
    inverse = 1 / std::bit_cast<double>(bits);
    const Long exact = -std::log(static_cast<Long>(inverse));
    log = static_cast<double>(std::round(std::ldexp(exact, 42))) * 0x1p-42;
    log_rest = static_cast<double>(exact - static_cast<Long>(log));
    split(std::exp2(static_cast<Long>(i) / Tables::kPoints), t.exponential[i]);
  }
  for (int i = 0; i < Tables::kTurns + 2; ++i) {
    const Long angle = static_cast<Long>(i) / Tables::kTurns;
    split(std::sin(angle), t.turn[i]);
    split(std::cos(angle), t.turn[i] + 2);
  }
  return t;
}

}  // namespace

const Tables& tables() noexcept {
  static const Tables tables = make_tables();
  return tables;
}

}  // namespace erard::lanes
