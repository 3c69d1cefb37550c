// Where LCM messages go.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace erard {

/// An LCM address udpm://IP:PORT?ttl=N&recv_buf_size=BYTES. What is left out is LCM's default.
/// IP is a multicast group. To listen it may also be an address of this machine, for one listener:
/// udpm://127.0.0.1:7667 needs no route; LCM's library cannot send there.
struct LcmAddress {
  std::uint32_t ip = 0xEFFF4C43;  // 239.255.76.67, most significant byte first
  std::uint16_t port = 7667;
  int ttl = 0;                  // 0: messages stay on this machine
  int receive_buffer_size = 0;  // of the kernel; 0: the system's default [byte]

  bool is_group() const noexcept { return ip >> 28 == 0xE; }
  std::string to_string() const;  // "239.255.76.67:7667"
};

/// Reads an address. Throws InputError.
LcmAddress parse_lcm_address(std::string_view url);

/// A channel's name must have 1 to 63 characters, printable and no space, as LCM sends it. Throws InputError.
void check_lcm_channel(std::string_view channel);

/// A message can be sent there. Throws std::runtime_error with the remedy when this machine has no route.
void check_lcm_route(const LcmAddress& address);

}  // namespace erard
