// A filter in the kernel that lets only one LCM channel through.
#pragma once

#include <linux/filter.h>

#include <string_view>
#include <vector>

#include "erard/device/lcm_datagram.hpp"

namespace erard {

/// Classic BPF program for a UDP socket: passes datagrams for which lcm_payload() finds a payload, drops all others; a
/// load beyond the end of a datagram drops it too. The datagram starts with the 8 bytes of the UDP header.
inline std::vector<sock_filter> build_channel_filter(std::string_view channel) {
  constexpr std::uint32_t kUdpHeaderSize = 8;  // [byte]
  std::vector<sock_filter> program;
  const auto demand = [&program](std::uint16_t width, std::uint32_t offset, std::uint32_t value) {
    program.push_back({static_cast<std::uint16_t>(BPF_LD | BPF_ABS | width), 0, 0, kUdpHeaderSize + offset});
    program.push_back({BPF_JMP | BPF_JEQ | BPF_K, 1, 0, value});  // equal: past the next one
    program.push_back({BPF_RET | BPF_K, 0, 0, 0});                // drop
  };
  demand(BPF_W, 0, kLcmMagic);
  std::uint32_t offset = kLcmHeaderSize;
  for (const char letter : channel) demand(BPF_B, offset++, static_cast<std::uint8_t>(letter));
  demand(BPF_B, offset, 0);
  program.push_back({BPF_RET | BPF_K, 0, 0, 0xFFFFFFFF});  // pass it whole
  return program;
}

}  // namespace erard
