// Messages to LCM channels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

struct _lcm_t;  // of LCM

namespace erard {

/// Publishes messages of the types in messages/*.lcm. Only one thread may publish on one Sender: then nobody holds a
/// lock that publish() needs.
class Sender {
 public:
  static constexpr std::size_t kLongest = 4096;  // message [byte]

  /// @param url  an LCM address, or a log to write: file:///tmp/session.lcm?mode=w
  /// Throws InputError when it cannot be read, std::runtime_error with the remedy when LCM cannot send there.
  explicit Sender(const std::string& url);

  /// Publishes a message: no allocation but in the first call. A real-time thread should make that one before its loop
  /// (2 heap calls and 33 page faults), with a message that asks for nothing.
  /// @param channel  that check_lcm_channel() takes
  /// @return false when it was not sent
  /// Cost: one system call, 5 to 20 us.
  template <typename Message>
  bool publish(const char* channel, const Message& message) noexcept {
    const int size = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    return size > 0 && send(channel, static_cast<unsigned>(size));
  }

 private:
  struct Destroy {
    void operator()(_lcm_t* lcm) const noexcept;
  };

  bool send(const char* channel, unsigned size) noexcept;

  std::unique_ptr<_lcm_t, Destroy> lcm_;
  std::array<std::uint8_t, kLongest> buffer_{};
};

/// A number for messages' publisher_id: random, positive.
std::int64_t draw_publisher_id();

/// CLOCK_MONOTONIC, which the messages carry [ns].
std::int64_t monotonic_time_ns() noexcept;

}  // namespace erard
