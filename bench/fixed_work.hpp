// The same work over and over, for the noise of the machine.
#pragma once

#include <cstdint>

namespace erard::bench {

inline volatile std::uint64_t fixed_work_result;  // nobody reads it; without it the compiler would leave the work out

/// A chain of shifts in registers, each waiting for the one before: the same instructions every time, no memory, no
/// branch that could be guessed wrong. Some microseconds (5 to 6 on a core of 3 to 4 GHz). What its time varies by is
/// the machine: interrupts, other jobs, clock frequency.
inline void fixed_work() noexcept {
  std::uint64_t x = 88172645463325252U;
  for (int i = 0; i < 3000; ++i) {  // Marsaglia's xorshift64
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
  }
  fixed_work_result = x;
}

}  // namespace erard::bench
