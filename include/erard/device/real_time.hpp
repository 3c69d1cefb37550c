// What a thread asks of the kernel to be real-time, and what it was granted. Linux.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace erard {

/// One request and its answer, read back from the kernel where it can be.
struct Grant {
  std::string what;
  std::string asked;
  std::string granted;
  bool is_granted = false;
  std::string remedy;  // one sentence with the command; empty when granted
};

/// SCHED_FIFO for the calling thread; threads that it starts later inherit it. @param priority  1 to 99
Grant request_fifo(int priority);

/// Binds the calling thread to one CPU; threads that it starts later inherit that too. @param cpu  from 0
Grant request_cpu(int cpu);

/// Keeps all memory of the process in RAM, what it takes later included, and touches the stack of the calling thread so
/// that it is there (256 KiB): no page faults from then on, but for what a thread's first heap calls map.
Grant request_memory_lock();

/// How much later than asked for the kernel may wake the calling thread, to save wake-ups [ns]. It is 0 under
/// SCHED_FIFO anyway; this is for who is refused that.
Grant request_timer_slack(std::int64_t slack_ns);

/// Keeps all CPUs out of sleep states that take time to leave, for as long as it lives (/dev/cpu_dma_latency).
class CpuLatencyHold {
 public:
  CpuLatencyHold();
  ~CpuLatencyHold();
  CpuLatencyHold(const CpuLatencyHold&) = delete;
  CpuLatencyHold& operator=(const CpuLatencyHold&) = delete;

  const Grant& grant() const noexcept { return grant_; }

 private:
  int file_ = -1;
  Grant grant_;
};

struct RealTimeRequest {
  static constexpr int kAnyCpu = -1;

  int priority = 80;  // above threaded interrupts (50), below the kernel's watchdogs (99)
  int cpu = kAnyCpu;  // to be bound to
};

/// Everything above for the calling thread, and nothing is refused silently. The CPU latency is held while this lives.
class RealTime {
 public:
  explicit RealTime(const RealTimeRequest& request);

  const std::vector<Grant>& grants() const noexcept { return grants_; }
  bool is_granted() const noexcept;  // all of it

 private:
  CpuLatencyHold latency_;
  std::vector<Grant> grants_;
};

/// Lines for a person: one a request, and below each refusal its remedy.
std::string grant_table(const std::vector<Grant>& grants);

}  // namespace erard
