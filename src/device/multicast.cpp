#include "erard/device/multicast.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "erard/device/monotonic_clock.hpp"
#include "erard/device/periodic_loop.hpp"

namespace erard {
namespace {

constexpr const char* kQuestions = "239.255.76.77";  // the groups of LCM's default and of ours are others
constexpr const char* kAnswers = "239.255.76.78";

class Socket {
 public:
  Socket(int family, int type, int protocol) : file_(socket(family, type | SOCK_CLOEXEC, protocol)) {
    if (file_ < 0) throw std::runtime_error(fmt::format("no socket was given ({})", std::strerror(errno)));
  }
  ~Socket() { close(file_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int file() const noexcept { return file_; }

 private:
  int file_;
};

/// A datagram: the number alone counts, the rest makes it as long as a small LCM message.
struct Datagram {
  std::int64_t number = 0;
  std::array<char, 64> rest{};
};

template <class Value>
void set(const Socket& socket, int level, int option, const Value& value) {
  if (setsockopt(socket.file(), level, option, &value, sizeof value) != 0)
    throw std::runtime_error(
        fmt::format("loopback takes no multicast ({}); allow it with `sudo ip link set lo up`", std::strerror(errno)));
}

ip_mreqn membership(const char* group) {
  ip_mreqn membership{};
  inet_pton(AF_INET, group, &membership.imr_multiaddr);
  membership.imr_ifindex = static_cast<int>(if_nametoindex("lo"));
  return membership;
}

/// Receives what is sent to one group and sends to another, both on loopback.
class Endpoint {
 public:
  Endpoint(const char* listens, double patience) : socket_(AF_INET, SOCK_DGRAM, 0) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    inet_pton(AF_INET, listens, &here.sin_addr);
    if (bind(socket_.file(), reinterpret_cast<const sockaddr*>(&here), sizeof here) != 0)
      throw std::runtime_error(fmt::format("{}: cannot be bound ({})", listens, std::strerror(errno)));
    socklen_t length = sizeof here;
    getsockname(socket_.file(), reinterpret_cast<sockaddr*>(&here), &length);
    here_ = here;
    set(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership(listens));
    set(socket_, IPPROTO_IP, IP_MULTICAST_IF, membership(listens));
    set(socket_, IPPROTO_IP, IP_MULTICAST_TTL, 0);
    const auto us = static_cast<suseconds_t>(1e6 * patience);
    set(socket_, SOL_SOCKET, SO_RCVTIMEO, timeval{us / 1'000'000, us % 1'000'000});
  }

  const sockaddr_in& here() const noexcept { return here_; }
  bool send(const Datagram& datagram, const sockaddr_in& to) noexcept {
    return sendto(socket_.file(), &datagram, sizeof datagram, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) ==
           sizeof datagram;
  }
  bool receive(Datagram& datagram) noexcept {  // false when none came in time
    return recv(socket_.file(), &datagram, sizeof datagram, 0) == sizeof datagram;
  }

 private:
  Socket socket_;
  sockaddr_in here_{};
};

/// Sends the questions, one a period, and waits for each answer.
void ask(const RoundTripRequest& request, Endpoint& endpoint, const sockaddr_in& to, RoundTrips& result,
         const std::atomic<bool>& is_stopped) {
  const RealTime real_time(request.real_time);
  const auto loop = std::make_unique<PeriodicLoop<>>(LoopSettings{.period_ns = std::llround(1e9 / request.rate)});
  const auto periods = static_cast<std::int64_t>(request.rate * request.duration);
  const MonotonicClock clock;
  loop->run([&](const Period& period) noexcept {
    const std::int64_t begin = clock.now();
    Datagram answer;
    bool is_answered = endpoint.send({period.number, {}}, to) && endpoint.receive(answer);
    while (is_answered && answer.number != period.number) is_answered = endpoint.receive(answer);  // an old one
    ++result.sent;
    if (is_answered)
      result.time.add(1e-9 * static_cast<double>(clock.now() - begin));
    else
      ++result.lost;
    return period.number + 1 < periods && !is_stopped.load(std::memory_order_relaxed);
  });
}

}  // namespace

std::string interface_towards(const std::string& address) {
  struct {
    nlmsghdr head{};
    rtmsg route{};
    rtattr attribute{};
    in_addr destination{};
  } question;
  if (inet_pton(AF_INET, address.c_str(), &question.destination) != 1)
    throw std::runtime_error(fmt::format("{}: must be an IPv4 address", address));
  question.head.nlmsg_len = sizeof question;
  question.head.nlmsg_type = RTM_GETROUTE;
  question.head.nlmsg_flags = NLM_F_REQUEST;
  question.route.rtm_family = AF_INET;
  question.route.rtm_dst_len = 32;
  question.attribute.rta_type = RTA_DST;
  question.attribute.rta_len = RTA_LENGTH(sizeof(in_addr));
  const Socket socket(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE);
  alignas(nlmsghdr) std::array<char, 8192> bytes{};
  if (send(socket.file(), &question, sizeof question, 0) < 0 ||
      recv(socket.file(), bytes.data(), bytes.size(), 0) < static_cast<ssize_t>(sizeof(nlmsghdr) + sizeof(rtmsg)))
    throw std::runtime_error(fmt::format("the kernel does not tell its routes ({})", std::strerror(errno)));
  const auto* answer = reinterpret_cast<const nlmsghdr*>(bytes.data());
  if (answer->nlmsg_type != RTM_NEWROUTE) return {};  // "network is unreachable"
  const auto* attribute = reinterpret_cast<const rtattr*>(bytes.data() + NLMSG_LENGTH(sizeof(rtmsg)));
  std::size_t left = answer->nlmsg_len - NLMSG_LENGTH(sizeof(rtmsg));
  for (; RTA_OK(attribute, left); attribute = RTA_NEXT(attribute, left)) {
    if (attribute->rta_type != RTA_OIF) continue;
    unsigned index = 0;
    std::memcpy(&index, RTA_DATA(attribute), sizeof index);
    std::array<char, IF_NAMESIZE> name{};
    return if_indextoname(index, name.data()) != nullptr ? name.data() : "";
  }
  return {};
}

RoundTrips measure_round_trips(const RoundTripRequest& request, const std::atomic<bool>& is_stopped) {
  const double patience = std::max(10 / request.rate, 0.02);  // [s]
  Endpoint asker(kAnswers, patience), answerer(kQuestions, patience);
  RoundTrips result;
  std::atomic<bool> is_over{false};
  std::thread answers([&] {
    request_fifo(std::max(1, request.real_time.priority - 10));
    for (Datagram datagram; !is_over;)
      if (answerer.receive(datagram)) answerer.send(datagram, asker.here());
  });
  std::thread questions([&] { ask(request, asker, answerer.here(), result, is_stopped); });
  questions.join();
  is_over = true;
  answers.join();
  return result;
}

}  // namespace erard
