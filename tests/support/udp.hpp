// Datagrams as nobody should send them.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "erard/device/lcm_address.hpp"

namespace erard::test {

/// Most significant byte first.
inline std::string big_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text.push_back(static_cast<char>(value >> (8 * i)));
  return text;
}

/// An LCM datagram.
inline std::string lcm_datagram(const std::string& channel, const std::string& payload) {
  return "LC02" + big_endian(1, 4) + channel + std::string(1, '\0') + payload;
}

template <typename Message>
std::string encoded(const Message& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// A fragment of a large LCM message.
inline std::string lcm_fragment(std::uint32_t size, std::uint32_t offset, int number, int count,
                                const std::string& rest) {
  return "LC03" + big_endian(7, 4) + big_endian(size, 4) + big_endian(offset, 4) +
         big_endian(static_cast<std::uint64_t>(number), 2) + big_endian(static_cast<std::uint64_t>(count), 2) + rest;
}

/// Sends anything to an address.
class RawSender {
 public:
  explicit RawSender(const LcmAddress& address) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(address.ip);
    to_.sin_port = htons(address.port);
  }
  ~RawSender() { close(socket_); }
  RawSender(const RawSender&) = delete;
  RawSender& operator=(const RawSender&) = delete;

  void send(const std::string& datagram) const {
    const ssize_t sent =
        sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    EXPECT_EQ(sent, static_cast<ssize_t>(datagram.size()));
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

/// Waits until something is so, half a minute at most: a machine under load is slow, not wrong.
template <typename Claim>
bool eventually(const Claim& claim) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!claim()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace erard::test
