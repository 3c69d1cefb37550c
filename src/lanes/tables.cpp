#include "tables.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

namespace erard::lanes {
namespace {

using Long = long double;

void split(Long value, double& first, double& rest) noexcept {
  first = static_cast<double>(value);
  rest = static_cast<double>(value - static_cast<Long>(first));
}

Tables make_tables() noexcept {
  constexpr int kShift = 52 - 7;
  Tables t;
  for (int i = 0; i < Tables::kPoints; ++i) {
    const std::uint64_t half = std::uint64_t{1} << (kShift - 1);
    const std::uint64_t bits = kLeastBits + (static_cast<std::uint64_t>(i) << kShift) + half;
    // an interval that reaches beyond 1 lies in the next octave as the bits count
    t.inverse[i] = 1 / std::bit_cast<double>(bits);
    const Long log = -std::log(static_cast<Long>(t.inverse[i]));
    t.log[i] = static_cast<double>(std::round(std::ldexp(log, 42))) * 0x1p-42;
    t.log_rest[i] = static_cast<double>(log - static_cast<Long>(t.log[i]));
    split(std::exp2(static_cast<Long>(i) / Tables::kPoints), t.exponential[i], t.exponential_rest[i]);
  }
  for (int i = 0; i < Tables::kTurns + 2; ++i) {
    const Long angle = static_cast<Long>(i) / Tables::kTurns;
    split(std::sin(angle), t.sine[i], t.sine_rest[i]);
    split(std::cos(angle), t.cosine[i], t.cosine_rest[i]);
  }
  return t;
}

}  // namespace

const Tables& tables() noexcept {
  static const Tables tables = make_tables();
  return tables;
}

}  // namespace erard::lanes
