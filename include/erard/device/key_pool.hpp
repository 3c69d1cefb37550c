// The keys of a keyboard on several CPUs.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "erard/haptics/keyboard.hpp"

namespace erard {

/// Threads that advance a Keyboard together, one period a call, with the bits of a single thread.
///
/// Thread i of m owns the keys i, i + m, i + 2 m .. for good: neighbours, which are played together, go to different
/// threads. The calling thread is number 0 and works too. A period begins with one atomic counter and ends with another;
/// nobody takes a lock. Who waits spins for a while, then sleeps in the kernel (std::atomic::wait, on Linux a
/// futex): spinning alone would hang where a caller of real-time priority shares a CPU with a worker of less. The caller
/// waits for the slowest worker, so no worker should have less priority than the caller; threads
/// inherit it: set your own first, then build the pool.
///
/// Linux alone binds threads to CPUs. Once built: no heap, no exceptions, no locks.
class KeyPool {
 public:
  static constexpr int kAnyCpu = -1;

  /// @param worker_cpus  one worker each, bound to that CPU unless kAnyCpu; the caller binds itself
  /// @param spin_time    of who waits, before it sleeps [s]. Waking from sleep costs the kernel's 5 to 50 us; on CPUs of
  ///                     one's own let it be longer than a period.
  /// Throws std::system_error when a thread cannot be had or bound. The keyboard must outlive the pool and be advanced by
  /// nobody else meanwhile.
  KeyPool(Keyboard& keyboard, const std::vector<int>& worker_cpus, double spin_time = 5e-5);
  ~KeyPool();
  KeyPool(const KeyPool&) = delete;
  KeyPool& operator=(const KeyPool&) = delete;

  /// As Keyboard::tick(), which see. Call it from one thread at a time.
  std::span<const double> tick(std::span<const DriveSample> inputs) noexcept;

  int thread_count() const noexcept { return static_cast<int>(workers_.size()) + 1; }

 private:
  void work(int share, Workspace& scratch) noexcept;
  void stop() noexcept;

  Keyboard& keyboard_;
  double spin_time_;                        // [s]
  int share_count_;                         // threads, the caller's included
  std::span<const DriveSample> inputs_;     // of this period; written before it begins
  bool is_over_ = false;                    // likewise
  alignas(64) std::atomic<int> period_{0};  // begun so far; wraps
  alignas(64) std::atomic<int> busy_{0};    // workers that have not finished this one
  std::vector<std::unique_ptr<Workspace>> scratch_;
  std::vector<std::thread> workers_;
};

}  // namespace erard
