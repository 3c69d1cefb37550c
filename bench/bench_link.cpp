// bench_link: how long a message takes from the publisher's call to the thread that takes it, by the receiver of this
// project and by that of LCM's library. Both in one process, in a network of its own:
//   unshare -n -r sh -c 'ip link set lo up; ip route add 224.0.0.0/4 dev lo; exec build/release/bin/bench_link'
// One CSV row for each; times in us.
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>

#include "erard/device/duration_histogram.hpp"
#include "erard/device/link.hpp"

namespace {

using namespace erard;

constexpr std::int64_t kPeriod = 500'000;  // [ns]
constexpr int kPublisherPriority = 80, kReceiverPriority = 70;

bool be_urgent(int priority) {
  const sched_param wanted{priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted) == 0;
}

void sleep_until(std::int64_t instant) {
  const timespec at{instant / 1'000'000'000, instant % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

/// Publishes at 2 kHz, and other messages between them on another channel of the same group, as a host that sends its
/// forces there would.
void publish(int count, bool has_others, std::atomic<bool>& is_over) {
  be_urgent(kPublisherPriority);
  Sender sender(kDeviceUrl);
  positions_t positions{};
  positions.key_count = positions_t::kMaxKeys;
  const forces_t forces{};
  sender.publish("WARM_UP", positions);
  const std::int64_t start = monotonic_time_ns() + 100'000'000;
  for (int i = 0; i < count; ++i) {
    sleep_until(start + i * kPeriod);
    positions.sequence = i + 1;
    positions.device_time_ns = monotonic_time_ns();
    sender.publish(kPositionsChannel, positions);
    if (!has_others) continue;
    sleep_until(start + i * kPeriod + kPeriod / 2);
    sender.publish(kForcesChannel, forces);
  }
  sleep_until(monotonic_time_ns() + 200'000'000);
  is_over = true;
}

/// What the listening threads of both do with a message.
struct Arrivals {
  DurationHistogram latency;  // [s]
  std::int64_t count = 0, lost = 0, last = 0;

  void add(const positions_t& positions) {
    latency.add(static_cast<double>(monotonic_time_ns() - positions.device_time_ns) * 1e-9);
    lost += positions.sequence - last - 1;
    last = positions.sequence;
    ++count;
  }
};

Arrivals listen_ourselves(const std::atomic<bool>& is_over) {
  Arrivals arrivals;
  positions_t positions;
  const DatagramListener listener(parse_lcm_address(kDeviceUrl), kPositionsChannel,
                                  [&](Bytes payload) {
                                    if (positions.decode(payload.data(), 0, static_cast<int>(payload.size())) > 0)
                                      arrivals.add(positions);
                                  },
                                  {kReceiverPriority});
  while (!is_over) sleep_until(monotonic_time_ns() + 10'000'000);
  return arrivals;
}

Arrivals listen_by_library(const std::atomic<bool>& is_over) {
  be_urgent(kReceiverPriority);  // before subscribing: the library's own thread inherits it
  Arrivals arrivals;
  lcm_t* const lcm = lcm_create(kDeviceUrl);
  lcm_subscribe(
      lcm, kPositionsChannel,
      [](const lcm_recv_buf_t* buffer, const char*, void* user) {
        positions_t positions;
        if (positions.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) > 0)
          static_cast<Arrivals*>(user)->add(positions);
      },
      &arrivals);
  while (!is_over) lcm_handle_timeout(lcm, 10);
  lcm_destroy(lcm);
  return arrivals;
}

/// CPU time of the process so far [s].
double cpu_time() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void measure(const char* name, Arrivals (*listen)(const std::atomic<bool>&), int count, bool has_others) {
  std::atomic<bool> is_over{false};
  const double before = cpu_time();
  std::thread publisher(publish, count, has_others, std::ref(is_over));
  const Arrivals arrivals = listen(is_over);
  publisher.join();
  const auto us = [&](double share) { return 1e6 * arrivals.latency.quantile(share); };
  fmt::print("{},{},{},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f}\n", name, has_others ? "yes" : "no", arrivals.count,
             arrivals.lost, us(0.5), us(0.99), us(0.999), 1e6 * arrivals.latency.worst(),
             (cpu_time() - before) / count * 1e6);
}

}  // namespace

int main(int argc, char** argv) {
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 10;
  if (seconds <= 0) {
    fmt::print(stderr, "bench_link [SECONDS]: a whole number of seconds for each row\n");
    return 2;
  }
  mlockall(MCL_CURRENT | MCL_FUTURE);
  fmt::print("# SCHED_FIFO {}\n", be_urgent(1) ? "granted" : "refused: times are those of ordinary threads");
  fmt::print("receiver,other_messages,arrived,lost,p50_us,p99_us,p99.9_us,max_us,cpu_us_per_message\n");
  for (const bool has_others : {false, true}) {
    measure("erard", listen_ourselves, 2000 * seconds, has_others);
    measure("lcm", listen_by_library, 2000 * seconds, has_others);
  }
}
