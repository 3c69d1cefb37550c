// The newest events of a real-time thread, for slower threads to read.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "erard/device/atomic_words.hpp"

namespace erard {

/// An event as it lies in the ring: bytes on a channel.
struct RingEvent {
  std::int64_t time_ns = 0;
  std::int32_t channel = 0;
  std::vector<std::byte> data;
};

/// A ring that its writer overwrites without asking: one thread pushes, wait-free, whoever reads or does not. Readers
/// ask for an event by its number and learn whether it is there, not yet or no longer: one ring holds the history that
/// is saved on a fault and feeds the recording of a session. All memory is taken, and touched, at the start.
class EventRing {
 public:
  enum class Found { whole, not_yet, overwritten };

  /// @param least_events  the newest that are always there; rounded up to a power of two
  /// @param largest       bytes of an event
  EventRing(std::size_t least_events, std::size_t largest)
      : capacity_(power_of_two(least_events)), largest_(largest), words_(capacity_ * stride()) {}

  /// @return false when the event is larger than the ring's largest; it is then left out
  bool push(std::int32_t channel, std::int64_t time_ns, std::span<const std::byte> data) noexcept {
    if (data.size() > largest_) return false;
    const std::uint64_t number = written_.load(std::memory_order_relaxed);
    AtomicWord* slot = slot_of(number);
    slot[0].store(2 * number + 1, std::memory_order_relaxed);  // odd: being written
    slot[1].store(static_cast<std::uint64_t>(time_ns), std::memory_order_release);
    slot[2].store(static_cast<std::uint64_t>(channel) << 32 | data.size(), std::memory_order_release);
    store_words(slot + kHead, data);
    slot[0].store(2 * number + 2, std::memory_order_release);
    written_.store(number + 1, std::memory_order_release);
    return true;
  }

  /// Copies event `number`, counted from 0. @param event  to be used when it is whole
  Found read(std::uint64_t number, RingEvent& event) const {
    const AtomicWord* slot = slot_of(number);
    const std::uint64_t before = slot[0].load(std::memory_order_acquire);
    if (before < 2 * number + 2) return Found::not_yet;
    if (before > 2 * number + 2) return Found::overwritten;
    const auto time_ns = static_cast<std::int64_t>(slot[1].load(std::memory_order_acquire));
    const std::uint64_t label = slot[2].load(std::memory_order_acquire);
    // a label torn by the writer is found out below, but must not lead outside the slot before
    event.data.resize(std::min<std::size_t>(label & 0xffffffff, largest_));
    load_words(event.data, slot + kHead);
    if (slot[0].load(std::memory_order_relaxed) != before) return Found::overwritten;
    event.time_ns = time_ns;
    event.channel = static_cast<std::int32_t>(label >> 32);
    return Found::whole;
  }

  std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }
  std::uint64_t capacity() const noexcept { return capacity_; }

  /// Number of the oldest event that is surely there while none is pushed.
  std::uint64_t oldest() const noexcept { return written() > capacity_ ? written() - capacity_ : 0; }

 private:
  static constexpr std::size_t kHead = 3;  // words: state, time, channel and size

  static std::size_t power_of_two(std::size_t least) {
    std::size_t power = 1;
    while (power < least) power *= 2;
    return power;
  }
  std::size_t stride() const noexcept { return kHead + words_for(largest_); }
  AtomicWord* slot_of(std::uint64_t number) noexcept { return &words_[(number & (capacity_ - 1)) * stride()]; }
  const AtomicWord* slot_of(std::uint64_t number) const noexcept {
    return &words_[(number & (capacity_ - 1)) * stride()];
  }

  std::uint64_t capacity_;
  std::size_t largest_;
  std::vector<AtomicWord> words_;
  alignas(64) std::atomic<std::uint64_t> written_{0};
};

}  // namespace erard
