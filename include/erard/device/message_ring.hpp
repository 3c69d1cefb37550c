// Messages from one thread to another.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace erard {

/// Up to N values on their way from one thread to another, in order; a power of two. Both sides are wait-free: neither
/// ever waits for the other, whatever priority it has. A value is written and read in its place.
template <typename T, std::uint32_t N>
class MessageRing {
  static_assert((N & (N - 1)) == 0, "counters wrap at 2^32");

 public:
  /// For the writing thread: room for the next value, or nullptr when all N wait to be read. commit() hands it over.
  T* room() noexcept {
    const std::uint32_t written = written_.load(std::memory_order_relaxed);
    return written - read_.load(std::memory_order_acquire) < N ? &values_[written % N] : nullptr;
  }
  void commit() noexcept { written_.store(written_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  /// For the reading thread: the oldest value, or nullptr when there is none. release() lets go of it.
  const T* oldest() const noexcept {
    const std::uint32_t read = read_.load(std::memory_order_relaxed);
    return written_.load(std::memory_order_acquire) != read ? &values_[read % N] : nullptr;
  }
  void release() noexcept { read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

 private:
  std::array<T, N> values_{};
  alignas(64) std::atomic<std::uint32_t> written_{0};  // so far; wraps
  alignas(64) std::atomic<std::uint32_t> read_{0};
};

}  // namespace erard
