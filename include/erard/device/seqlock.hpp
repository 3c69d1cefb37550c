// A value that one thread writes, and never waits, while others read.
#pragma once

#include <array>
#include <atomic>
#include <optional>
#include <span>
#include <thread>
#include <type_traits>

#include "erard/device/atomic_words.hpp"

namespace erard {

/// The newest value of T, whole. One thread stores: wait-free, some nanoseconds, no matter who reads. Any number of
/// threads load: they look at a counter before and after copying, and copy again when it has moved.
template <class T>
class Seqlock {
  static_assert(std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T>);

 public:
  Seqlock() noexcept { store(T{}); }
  Seqlock(const Seqlock&) = delete;
  Seqlock& operator=(const Seqlock&) = delete;

  /// From one thread at a time.
  void store(const T& value) noexcept {
    const std::uint64_t count = count_.load(std::memory_order_relaxed);
    count_.store(count + 1, std::memory_order_relaxed);  // odd: being written
    store_words(words_.data(), std::as_bytes(std::span(&value, 1)));
    count_.store(count + 2, std::memory_order_release);
  }

  /// One attempt. @return nothing when a store came in between
  std::optional<T> try_load() const noexcept {
    const std::uint64_t before = count_.load(std::memory_order_acquire);
    if (before % 2 != 0) return {};
    T value{};
    load_words(std::as_writable_bytes(std::span(&value, 1)), words_.data());
    if (count_.load(std::memory_order_relaxed) != before) return {};
    return value;
  }

  /// Until it is whole. For threads of less priority than the writer: one of more would wait forever on its CPU.
  T load() const noexcept {
    for (;;) {
      if (const std::optional<T> value = try_load()) return *value;
      std::this_thread::yield();
    }
  }

 private:
  std::atomic<std::uint64_t> count_{0};  // twice the number of stores; odd while one is under way
  std::array<AtomicWord, words_for(sizeof(T))> words_{};
};

}  // namespace erard
