// Nothing that the real-time thread calls here touches the heap.
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "erard/device/event_ring.hpp"
#include "erard/device/periodic_loop.hpp"
#include "erard/device/phase_lock.hpp"
#include "support/heap_calls.hpp"

namespace erard {
namespace {

TEST(PeriodicLoopHeap, IsNotTouchedByLoopStatusAndRecording) {
  const auto loop = std::make_unique<PeriodicLoop<>>(LoopSettings{.period_ns = 200'000});
  const PhaseLock lock({.period_ns = 200'000, .delay_ns = 50'000});
  EventRing ring(16, 760);
  const std::array<std::byte, 760> record{};
  const long before = heap_calls;
  const LoopSummary summary = loop->run([&](const Period& period) noexcept {
    ring.push(0, period.woke_ns, record);
    loop->shift(lock.shift(period.due_ns, period.woke_ns));
    return period.number < 100;
  });
  EXPECT_EQ(heap_calls, before);
  EXPECT_GT(summary.status.periods, 0);
  EXPECT_EQ(ring.written(), static_cast<std::uint64_t>(summary.status.periods));
}

}  // namespace
}  // namespace erard
