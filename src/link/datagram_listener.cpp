#include "erard/device/datagram_listener.hpp"

#include <linux/sock_diag.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>

#include <array>
#include <chrono>
#include <latch>

#include "channel_filter.hpp"
#include "udp_socket.hpp"

namespace erard {
namespace {

constexpr int kLongestStop = 50;  // how long a silent thread may take to notice that it is over [ms]

/// Binds as LCM does: to the group and port, beside others; to a machine's address alone.
/// The filter is there before the socket has a port: nothing ever passes it by.
void open(UdpSocket& socket, LcmAddress& address, const std::string& channel) {
  std::vector<sock_filter> program = build_channel_filter(channel);
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  socket.set(SOL_SOCKET, SO_ATTACH_FILTER, filter, "SO_ATTACH_FILTER");
  if (address.receive_buffer_size > 0) socket.set(SOL_SOCKET, SO_RCVBUF, address.receive_buffer_size, "SO_RCVBUF");
  socket.set(SOL_SOCKET, SO_RCVTIMEO, timeval{0, kLongestStop * 1000}, "SO_RCVTIMEO");
  if (address.is_group()) socket.set(SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");

  sockaddr_in place = socket_address(address);
  socklen_t size = sizeof place;
  if (bind(socket.descriptor(), reinterpret_cast<const sockaddr*>(&place), size) != 0)
    throw std::runtime_error(fmt::format("LCM address {}: {}; is somebody else listening there?", address.to_string(),
                                         std::strerror(errno)));
  getsockname(socket.descriptor(), reinterpret_cast<sockaddr*>(&place), &size);
  address.port = ntohs(place.sin_port);
  if (!address.is_group()) return;
  const ip_mreq membership{place.sin_addr, {INADDR_ANY}};
  if (setsockopt(socket.descriptor(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0)
    throw std::runtime_error(no_route(address, errno));
}

/// @return the priority granted, 0 for none
int ask_for_priority(int priority) noexcept {
  const sched_param wanted{priority};
  return priority > 0 && pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) == 0 ? priority : 0;
}

/// Ctrl-C is for the threads of the program.
void leave_signals_to_others() noexcept {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

DatagramListener::DatagramListener(const LcmAddress& address, const std::string& channel, Handler handler,
                                   ListenerSettings settings)
    : address_(address), channel_(channel), handler_(std::move(handler)) {
  check_lcm_channel(channel_);
  UdpSocket socket;
  open(socket, address_, channel_);
  socket_ = socket.descriptor();
  std::latch has_begun(1);
  thread_ = std::thread([this, &has_begun, settings] {
    leave_signals_to_others();
    granted_priority_ = ask_for_priority(settings.priority);
    has_begun.count_down();
    listen();
  });
  socket.release();
  has_begun.wait();
}

DatagramListener::~DatagramListener() {
  is_over_ = true;
  thread_.join();
  close(socket_);
}

void DatagramListener::listen() noexcept {
  std::array<std::uint8_t, kLcmHeaderSize + kLcmLongestName + 1 + kLongest + 1> buffer;
  while (!is_over_) {
    const ssize_t size = recv(socket_, buffer.data(), buffer.size(), 0);
    if (size < 0 && errno != EAGAIN && errno != EINTR)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a socket in trouble must not spin at this priority
    if (size <= 0) continue;
    const auto payload = lcm_payload({buffer.data(), static_cast<std::size_t>(size)}, channel_);
    if (payload) handler_(payload->first(std::min(payload->size(), kLongest + 1)));
  }
}

std::int64_t DatagramListener::dropped_by_kernel() const noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof info;
  getsockopt(socket_, SOL_SOCKET, SO_MEMINFO, info.data(), &size);
  return info[SK_MEMINFO_DROPS];
}

}  // namespace erard
