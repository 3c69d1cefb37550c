// A network of the test's own, loopback and nothing else: no multicast leaves the machine, and tests do not meet.
#pragma once

#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace erard::test {

/// What `ip route add 224.0.0.0/4 dev lo` does, or `del`. @return whether it was done
inline bool set_multicast_route(bool is_there) {
  rtentry route{};
  char device[] = "lo";
  route.rt_dev = device;
  route.rt_flags = RTF_UP;
  const auto address = [](sockaddr& place, std::uint32_t ip) {
    auto& inet = reinterpret_cast<sockaddr_in&>(place);
    inet.sin_family = AF_INET;
    inet.sin_addr.s_addr = htonl(ip);
  };
  address(route.rt_dst, 0xE0000000);
  address(route.rt_genmask, 0xF0000000);
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  const bool is_done = ioctl(probe, is_there ? SIOCADDRT : SIOCDELRT, &route) == 0;
  close(probe);
  return is_done;
}

/// Moves the calling process into a network namespace where loopback is up. Call it while there is one thread only.
/// @return what was refused; empty when all was granted
inline std::string enter_own_network(bool has_multicast_route = true) {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0)
    return std::string("no network namespace: ") + std::strerror(errno);
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq loopback{};
  std::strcpy(loopback.ifr_name, "lo");
  loopback.ifr_flags = IFF_UP;
  std::string refused;
  if (probe < 0 || ioctl(probe, SIOCSIFFLAGS, &loopback) != 0 || (has_multicast_route && !set_multicast_route(true)))
    refused = std::string("no loopback in the network namespace: ") + std::strerror(errno);
  close(probe);
  return refused;
}

}  // namespace erard::test
