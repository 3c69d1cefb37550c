// Bytes that one thread writes while others look: copied word by word through atomics.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace erard {

using AtomicWord = std::atomic<std::uint64_t>;
static_assert(AtomicWord::is_always_lock_free);

constexpr std::size_t words_for(std::size_t bytes) {
  return (bytes + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
}

/// Writes bytes over words_for(from.size()) words. Each store releases: who has seen one of these words also sees what
/// the writer stored before, namely that the words are being written. A fence would do the same, but the thread sanitizer
/// does not know fences; on x86 both are plain stores.
inline void store_words(AtomicWord* to, std::span<const std::byte> from) noexcept {
  for (std::size_t done = 0; done < from.size(); done += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, from.data() + done, std::min(sizeof word, from.size() - done));
    (to++)->store(word, std::memory_order_release);
  }
}

/// The counterpart: each load acquires, so that what is loaded afterwards is at least as new.
inline void load_words(std::span<std::byte> to, const AtomicWord* from) noexcept {
  for (std::size_t done = 0; done < to.size(); done += sizeof(std::uint64_t)) {
    const std::uint64_t word = (from++)->load(std::memory_order_acquire);
    std::memcpy(to.data() + done, &word, std::min(sizeof word, to.size() - done));
  }
}

}  // namespace erard
