#include "erard/device/sender.hpp"

#include <fmt/format.h>
#include <lcm/lcm.h>

#include <ctime>
#include <random>
#include <stdexcept>

#include "erard/device/error.hpp"
#include "erard/device/lcm_address.hpp"

namespace erard {

void Sender::Destroy::operator()(_lcm_t* lcm) const noexcept { lcm_destroy(lcm); }

Sender::Sender(const std::string& url) {
  std::string whole = url;
  if (!url.starts_with("file://")) {
    const LcmAddress address = parse_lcm_address(url);
    if (!address.is_group())
      throw InputError(fmt::format("{}: is no multicast group, must be 224.0.0.0 to 239.255.255.255 to send to", url));
    check_lcm_route(address);  // LCM would name a random address and recommend a route over the network
    whole =
        fmt::format("udpm://{}?ttl={}", address.to_string(), address.ttl);  // LCM takes no default for the port alone
  }
  lcm_.reset(lcm_create(whole.c_str()));
  if (!lcm_) throw std::runtime_error(fmt::format("LCM cannot send to {}", url));
}

bool Sender::send(const char* channel, unsigned size) noexcept {
  return lcm_publish(lcm_.get(), channel, buffer_.data(), size) == 0;
}

std::int64_t draw_publisher_id() {
  std::random_device device;
  return std::uniform_int_distribution<std::int64_t>(1)(device);
}

std::int64_t monotonic_time_ns() noexcept {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

}  // namespace erard
