// Messages of one type from an LCM channel to the real-time thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "erard/device/datagram_listener.hpp"
#include "erard/device/doorbell.hpp"
#include "erard/device/message_ring.hpp"
#include "erard/device/monotonic_clock.hpp"

namespace erard {

/// A message and when it came.
template <typename Message>
struct Arrival {
  Message message{};
  std::int64_t time_ns = 0;  // CLOCK_MONOTONIC [ns]
};

/// What a receiver did with what came in; counts since it was built.
struct ReceiverCounts {
  std::int64_t accepted = 0;    // handed on, or waiting to be
  std::int64_t wrong_type = 0;  // another type on the channel, by its fingerprint
  std::int64_t wrong_size = 0;
  std::int64_t overflow = 0;  // good, but there was no room: the reader did not come for kRoom messages

  friend ReceiverCounts operator-(const ReceiverCounts& a, const ReceiverCounts& b) noexcept {
    return {a.accepted - b.accepted, a.wrong_type - b.wrong_type, a.wrong_size - b.wrong_size, a.overflow - b.overflow};
  }
};

/// Receives messages of one type, all of them, in order of arrival; what they say is not judged here.
/// @tparam Message  a type that lcm-gen made of messages/*.lcm, of fixed size
///
/// Two threads: a listening one, started here, checks and decodes into a ring; the caller's takes from it. take() neither
/// waits, nor calls the kernel, nor allocates; and nothing does so for a message once this is built.
template <typename Message>
class Receiver {
 public:
  static constexpr int kRoom = 64;  // messages: 32 ms at 2 kHz

  /// Throws as DatagramListener, which see; the thread inherits the CPUs of the caller.
  Receiver(const LcmAddress& address, const std::string& channel, ListenerSettings settings = {})
      : listener_(
            address, channel, [this](Bytes payload) { accept(payload); }, settings) {}
  Receiver(const std::string& url, const std::string& channel, ListenerSettings settings = {})
      : Receiver(parse_lcm_address(url), channel, settings) {}

  /// Takes the oldest message that waits. Call it until it says no: the last one is the newest. At most kRoom times when
  /// the caller must be bounded, whoever floods the channel.
  /// @return false when none waits; `arrival` is as it was
  bool take(Arrival<Message>& arrival) noexcept {
    const Arrival<Message>* const oldest = ring_.oldest();
    if (oldest == nullptr) return false;
    arrival = *oldest;
    ring_.release();
    return true;
  }
  bool take(Message& message) noexcept {
    const Arrival<Message>* const oldest = ring_.oldest();
    if (oldest == nullptr) return false;
    message = oldest->message;
    ring_.release();
    return true;
  }

  /// Sleeps until a message waits to be taken, or to an instant of CLOCK_MONOTONIC [ns]. From one thread at a time.
  void wait(std::int64_t until_ns) noexcept {
    is_awaited_ = true;
    if (ring_.oldest() == nullptr) doorbell_.wait(until_ns);
    is_awaited_ = false;
  }

  ReceiverCounts counts() const noexcept { return {accepted_, wrong_type_, wrong_size_, overflow_}; }
  const DatagramListener& listener() const noexcept { return listener_; }

 private:
  void accept(Bytes payload) noexcept {
    constexpr std::size_t kFingerprintSize = 8;
    if (payload.size() < kFingerprintSize) {
      ++wrong_size_;
    } else if (read_big_endian(payload.first(kFingerprintSize)) != static_cast<std::uint64_t>(Message::getHash())) {
      ++wrong_type_;
    } else if (payload.size() != size_) {
      ++wrong_size_;
    } else if (Arrival<Message>* const room = ring_.room()) {
      room->message.decode(payload.data(), 0,
                           static_cast<int>(payload.size()));  // cannot fail: type and size are right
      room->time_ns = MonotonicClock{}.now();
      ring_.commit();
      ++accepted_;
      if (is_awaited_) doorbell_.ring();
    } else {
      ++overflow_;
    }
  }

  const std::size_t size_ = static_cast<std::size_t>(Message{}.getEncodedSize());
  MessageRing<Arrival<Message>, kRoom> ring_;
  Doorbell doorbell_;
  std::atomic<bool> is_awaited_{false};
  std::atomic<std::int64_t> accepted_{0}, wrong_type_{0}, wrong_size_{0}, overflow_{0};
  DatagramListener listener_;  // last: its thread uses the others
};

}  // namespace erard
