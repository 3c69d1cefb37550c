// A UDP socket that closes itself.
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "erard/device/lcm_address.hpp"

namespace erard {

class UdpSocket {
 public:
  /// Throws std::runtime_error.
  UdpSocket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (descriptor_ < 0) throw std::runtime_error(fmt::format("no UDP socket: {}", std::strerror(errno)));
  }
  ~UdpSocket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  int descriptor() const noexcept { return descriptor_; }
  int release() noexcept { return std::exchange(descriptor_, -1); }

  template <typename Value>
  void set(int level, int option, const Value& value, const char* name) const {
    if (setsockopt(descriptor_, level, option, &value, sizeof value) != 0)
      throw std::runtime_error(fmt::format("UDP socket refuses {}: {}", name, std::strerror(errno)));
  }

 private:
  int descriptor_;
};

inline sockaddr_in socket_address(const LcmAddress& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_addr.s_addr = htonl(address.ip);
  result.sin_port = htons(address.port);
  return result;
}

inline std::string no_route(const LcmAddress& address, int error) {
  return fmt::format("LCM address {}: {}; {}", address.to_string(), std::strerror(error),
                     address.is_group() ? "let multicast stay on this machine: sudo ip route add 224.0.0.0/4 dev lo"
                                        : "look at the network");
}

}  // namespace erard
