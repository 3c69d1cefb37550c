// A thread that listens to one LCM channel.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "erard/device/lcm_address.hpp"
#include "erard/device/lcm_datagram.hpp"

namespace erard {

struct ListenerSettings {
  /// SCHED_FIFO of the listening thread; 0: that of the thread which builds it. Less than the real-time loop's, so that
  /// no flood can stop the loop, and more than any ordinary thread: behind those a message waits for milliseconds.
  int priority = 70;
};

/// Listens to one channel of an LCM address on a socket of its own and hands on every payload.
///
/// LCM's library is not asked: up to 1.3.1 a single pair of datagrams kills every process that subscribes with it, it
/// keeps memory for every channel name it ever met, and a thread and a pipe more stand in the way of a message
/// (docs/lcm.md).
/// Here a datagram of anything but this channel is dropped by a filter in the kernel, before it wakes anybody.
class DatagramListener {
 public:
  /// Called by the listening thread for each payload of the channel. A payload longer than kLongest comes cut to that
  /// length plus one.
  using Handler = std::function<void(Bytes)>;
  static constexpr std::size_t kLongest = 4096;  // [byte], several times our largest message

  /// The thread inherits the CPUs of the caller.
  /// Throws InputError for an address or a channel that cannot be, std::runtime_error when the machine refuses the
  /// socket.
  DatagramListener(const LcmAddress& address, const std::string& channel, Handler handler, ListenerSettings settings);
  ~DatagramListener();  // waits for the thread, at most 0.1 s
  DatagramListener(const DatagramListener&) = delete;
  DatagramListener& operator=(const DatagramListener&) = delete;

  /// SCHED_FIFO that the kernel granted to the thread; 0: none.
  int granted_priority() const noexcept { return granted_priority_; }
  /// Where it listens: the port the kernel gave when port 0 was asked for.
  const LcmAddress& address() const noexcept { return address_; }
  /// Datagrams the kernel dropped here: of other channels, of other kinds, or because nobody fetched them in time.
  /// A system call: not for the real-time thread.
  std::int64_t dropped_by_kernel() const noexcept;

 private:
  void listen() noexcept;

  LcmAddress address_;
  std::string channel_;
  Handler handler_;
  int socket_;
  int granted_priority_ = 0;
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

}  // namespace erard
