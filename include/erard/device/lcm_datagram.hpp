// LCM on the wire, as far as it is used here: one message, one datagram.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace erard {

using Bytes = std::span<const std::uint8_t>;

/// 'L' 'C' '0' '2', then four bytes of a counter that is not looked at, the channel's name, a zero, the payload.
///                                          LCM UDP Multicast Protocol Description, "Small messages"
inline constexpr std::uint32_t kLcmMagic = 0x4C433032;
inline constexpr std::size_t kLcmHeaderSize = 8;    // [byte]
inline constexpr std::size_t kLcmLongestName = 63;  // of a channel [byte]

inline std::uint64_t read_big_endian(Bytes bytes) noexcept {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Payload of a datagram on this channel; nothing when it is on another one or no whole LCM message. Fragments of large
/// messages have another magic number: ours never need them, and every way to break LCM's library leads through them.
/// Looks at nothing outside the datagram. No allocation.
inline std::optional<Bytes> lcm_payload(Bytes datagram, std::string_view channel) noexcept {
  const std::size_t start = kLcmHeaderSize + channel.size() + 1;
  if (datagram.size() < start || read_big_endian(datagram.first(4)) != kLcmMagic) return std::nullopt;
  const Bytes name = datagram.subspan(kLcmHeaderSize, channel.size() + 1);
  if (name.back() != 0 || !std::equal(channel.begin(), channel.end(), name.begin(),
                                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; }))
    return std::nullopt;
  return datagram.subspan(start);
}

}  // namespace erard
