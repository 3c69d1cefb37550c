#include "erard/device/lcm_address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "erard/device/error.hpp"
#include "erard/device/lcm_datagram.hpp"
#include "udp_socket.hpp"

namespace erard {
namespace {

/// Cuts `text` at the first `mark`: returns what stands before it and leaves what stands behind.
std::string_view cut(std::string_view& text, char mark) {
  const std::size_t end = std::min(text.find(mark), text.size());
  const std::string_view head = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return head;
}

int read_number(std::string_view url, std::string_view name, std::string_view text, int most) {
  int value = -1;
  const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || stop != text.data() + text.size() || value < 0 || value > most)
    throw InputError(fmt::format("{}: {} = {}, must be a whole number from 0 to {}", url, name, text, most));
  return value;
}

}  // namespace

std::string LcmAddress::to_string() const {
  return fmt::format("{}.{}.{}.{}:{}", ip >> 24, ip >> 16 & 255, ip >> 8 & 255, ip & 255, port);
}

LcmAddress parse_lcm_address(std::string_view url) {
  constexpr std::string_view kScheme = "udpm://";
  constexpr int kMostBuffer = 1 << 30;  // [byte]
  if (!url.starts_with(kScheme))
    throw InputError(
        fmt::format("{}: must be an LCM address udpm://IP:PORT, for instance {}239.255.76.67:7667", url, kScheme));
  LcmAddress address;
  std::string_view options = url.substr(kScheme.size());
  std::string_view place = cut(options, '?');
  if (const std::string ip(cut(place, ':')); !ip.empty()) {
    in_addr parsed{};
    if (inet_pton(AF_INET, ip.c_str(), &parsed) != 1)
      throw InputError(fmt::format("{}: {} is not an IP address, must be like 239.255.76.67", url, ip));
    address.ip = ntohl(parsed.s_addr);
  }
  if (!place.empty()) address.port = static_cast<std::uint16_t>(read_number(url, "port", place, 65535));
  while (!options.empty()) {
    std::string_view value = cut(options, '&');
    const std::string_view name = cut(value, '=');
    if (name == "ttl")
      address.ttl = read_number(url, name, value, 255);
    else if (name == "recv_buf_size")
      address.receive_buffer_size = read_number(url, name, value, kMostBuffer);
    else
      throw InputError(fmt::format("{}: {}: unknown option, must be ttl or recv_buf_size", url, name));
  }
  return address;
}

void check_lcm_channel(std::string_view channel) {
  const bool is_printable = std::all_of(channel.begin(), channel.end(), [](char c) { return c > ' ' && c <= '~'; });
  if (channel.empty() || channel.size() > kLcmLongestName || !is_printable)
    throw InputError(
        fmt::format("LCM channel {}: must be 1 to {} printable characters without space", channel, kLcmLongestName));
}

void check_lcm_route(const LcmAddress& address) {
  const UdpSocket probe;
  const sockaddr_in to = socket_address(address);
  if (connect(probe.descriptor(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    throw std::runtime_error(no_route(address, errno));
}

}  // namespace erard
