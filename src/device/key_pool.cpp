#include "erard/device/key_pool.hpp"

#include <chrono>
#include <system_error>

#ifdef __linux__
#include <pthread.h>
#include <sched.h>
#endif
#if defined(__x86_64__) || defined(__i386__)
#include <immintrin.h>
#endif

namespace erard {
namespace {

const auto kIgnore = [](int, const State&, const StepReport&, double) noexcept {};

/// Tells the CPU that this thread only waits.
void pause_briefly() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Waits until a value is another one: spins first, then sleeps until notified. @return the new value
int await_change(const std::atomic<int>& value, int old, double spin_time) noexcept {
  using Clock = std::chrono::steady_clock;
  constexpr int kLooks = 32;  // between two looks at the clock, which cost as much
  const auto begin = Clock::now();
  do {
    for (int i = 0; i < kLooks; ++i) {
      const int now = value.load(std::memory_order_acquire);
      if (now != old) return now;
      pause_briefly();
    }
  } while (std::chrono::duration<double>(Clock::now() - begin).count() < spin_time);
  value.wait(old, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

void bind(std::thread& thread, int cpu) {
#ifdef __linux__
  if (cpu < 0 || cpu >= CPU_SETSIZE) throw std::system_error(EINVAL, std::generic_category(), "no such CPU");
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  const int error = pthread_setaffinity_np(thread.native_handle(), sizeof set, &set);
  if (error != 0)
    throw std::system_error(error, std::generic_category(), "a worker cannot be bound to CPU " + std::to_string(cpu));
#else
  static_cast<void>(thread);
  static_cast<void>(cpu);
  throw std::system_error(ENOTSUP, std::generic_category(), "threads are bound to CPUs on Linux alone");
#endif
}

}  // namespace

KeyPool::KeyPool(Keyboard& keyboard, const std::vector<int>& worker_cpus, double spin_time)
    : keyboard_(keyboard), spin_time_(spin_time), share_count_(static_cast<int>(worker_cpus.size()) + 1) {
  for (int i = 0; i < share_count_; ++i) scratch_.push_back(std::make_unique<Workspace>());
  workers_.reserve(worker_cpus.size());
  try {
    for (int i = 1; i < share_count_; ++i) {
      const auto place = static_cast<std::size_t>(i);
      workers_.emplace_back([this, i, &scratch = *scratch_[place]] { work(i, scratch); });
      if (worker_cpus[place - 1] != kAnyCpu) bind(workers_.back(), worker_cpus[place - 1]);
    }
  } catch (...) {
    stop();
    throw;
  }
}

KeyPool::~KeyPool() { stop(); }

std::span<const double> KeyPool::tick(std::span<const DriveSample> inputs) noexcept {
  inputs_ = inputs;
  keyboard_.begin_tick(inputs);
  busy_.store(share_count_ - 1, std::memory_order_relaxed);  // seen by the workers with period_
  period_.fetch_add(1, std::memory_order_release);
  period_.notify_all();
  keyboard_.tick_share(0, share_count_, inputs, *scratch_.front(), kIgnore);
  int busy = busy_.load(std::memory_order_acquire);
  while (busy > 0) busy = await_change(busy_, busy, spin_time_);
  keyboard_.end_tick();
  return keyboard_.forces();
}

void KeyPool::work(int share, Workspace& scratch) noexcept {
  for (int period = 0;;) {
    period = await_change(period_, period, spin_time_);
    if (is_over_) return;
    keyboard_.tick_share(share, share_count_, inputs_, scratch, kIgnore);
    busy_.fetch_sub(1, std::memory_order_acq_rel);
    busy_.notify_one();
  }
}

void KeyPool::stop() noexcept {
  is_over_ = true;
  period_.fetch_add(1, std::memory_order_release);
  period_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

}  // namespace erard
