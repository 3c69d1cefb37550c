// Multicast within this machine, which LCM needs.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "erard/device/duration_histogram.hpp"
#include "erard/device/real_time.hpp"

namespace erard {

/// Interface over which the kernel would send to an IPv4 address, for instance "lo"; nothing is sent. Linux (rtnetlink).
/// @param address  "239.255.76.67"
/// @return its name; empty when there is no route. Throws std::runtime_error when the kernel does not answer.
std::string interface_towards(const std::string& address);

struct RoundTripRequest {
  double rate = 2000;         // [Hz]
  double duration = 2;        // [s]
  RealTimeRequest real_time;  // of who asks; who answers has 10 less
};

struct RoundTrips {
  DurationHistogram time;  // from sending to receiving the answer
  std::int64_t sent = 0;
  std::int64_t lost = 0;  // not answered within 10 periods, or 20 ms
};

/// Sends datagrams to a multicast group on the loopback interface, to another thread of this process that answers on a
/// second group: the way of LCM's messages without LCM's own work. Bound to loopback and to a time to live of 0: nothing
/// leaves the machine. Ports are taken as the kernel gives them, so that nobody's messages are met.
/// Throws std::runtime_error with the remedy where loopback takes no multicast.
RoundTrips measure_round_trips(const RoundTripRequest& request, const std::atomic<bool>& is_stopped);

}  // namespace erard
