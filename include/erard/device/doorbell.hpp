// Wakes one thread from another.
#pragma once

#include <cstdint>

namespace erard {

/// An event counter of the kernel: ringing costs a system call and never waits. Linux.
class Doorbell {
 public:
  /// Throws std::system_error when the kernel has none left.
  Doorbell();
  ~Doorbell();
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  void ring() noexcept;

  /// Sleeps until it has been rung since the last time, or to an instant of CLOCK_MONOTONIC [ns].
  void wait(std::int64_t until_ns) noexcept;

 private:
  int file_;
};

}  // namespace erard
