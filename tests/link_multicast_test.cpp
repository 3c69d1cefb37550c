// LCM as it is used, by multicast, beside LCM's own library. In a network of the test's own.
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include "erard/device/link.hpp"
#include "support/heap_calls.hpp"
#include "support/own_network.hpp"
#include "support/udp.hpp"

namespace erard {
namespace {

using test::encoded;
using test::enter_own_network;
using test::eventually;
using test::lcm_datagram;
using test::lcm_fragment;
using test::RawSender;

constexpr ListenerSettings kOrdinary{0};  // no rights are needed

#define REQUIRE_OWN_NETWORK(...) \
  if (const std::string refused = enter_own_network(__VA_ARGS__); !refused.empty()) GTEST_SKIP() << refused

TEST(Multicast, ReachesEveryReceiverOfTheGroup) {
  REQUIRE_OWN_NETWORK();
  Receiver<forces_t> first(kHostUrl, kForcesChannel, kOrdinary), second(kHostUrl, kForcesChannel, kOrdinary);
  Receiver<forces_t> other_group(kDeviceUrl, kForcesChannel, kOrdinary);
  Sender sender(kHostUrl);
  forces_t forces{};
  forces.sequence = 5;
  ASSERT_TRUE(sender.publish(kForcesChannel, forces));
  forces_t got{};
  EXPECT_TRUE(eventually([&] { return first.take(got); }));
  EXPECT_TRUE(eventually([&] { return second.take(got); }));
  EXPECT_EQ(encoded(got), encoded(forces));
  EXPECT_EQ(other_group.counts().accepted, 0);
  EXPECT_EQ(other_group.listener().dropped_by_kernel(), 0);
}

TEST(Multicast, WithoutARouteNamesTheRemedy) {
  REQUIRE_OWN_NETWORK(false);
  for (const bool is_sender : {true, false}) {
    try {
      if (is_sender)
        Sender sender(kDeviceUrl);
      else
        Receiver<positions_t> receiver(kDeviceUrl, kPositionsChannel, kOrdinary);
      ADD_FAILURE() << "there is no route";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("sudo ip route add 224.0.0.0/4 dev lo"), std::string::npos)
          << error.what();
    }
  }
}

TEST(Sender, TakesEveryType) {
  REQUIRE_OWN_NETWORK();
  Sender sender(kHostUrl);
  EXPECT_TRUE(sender.publish(kPositionsChannel, positions_t{}));
  EXPECT_TRUE(sender.publish(kForcesChannel, forces_t{}));
  EXPECT_TRUE(sender.publish(kActuatorChannel, actuator_commands_t{}));
  EXPECT_TRUE(sender.publish(kStatusChannel, host_status_t{}));
  EXPECT_TRUE(sender.publish(kHammerChannel, hammer_event_t{}));
  EXPECT_TRUE(sender.publish(kStateChannel, action_state_t{}));
}

TEST(Multicast, MakesNoHeapCallForAMessageOnceItRuns) {
  REQUIRE_OWN_NETWORK();
  Receiver<positions_t> receiver(kDeviceUrl, kPositionsChannel, kOrdinary);
  Sender sender(kDeviceUrl);
  positions_t sent{}, got{};
  const auto exchange = [&](std::int64_t sequence) {
    sent.sequence = sequence;
    return sender.publish(kPositionsChannel, sent) &&
           eventually([&] { return receiver.take(got) && got.sequence == sequence; });
  };
  ASSERT_TRUE(exchange(1));  // the first one may
  const long before = heap_calls;
  bool is_whole = true;
  for (std::int64_t i = 2; i <= 200; ++i) is_whole = is_whole && exchange(i);
  EXPECT_EQ(heap_calls - before, 0);
  EXPECT_TRUE(is_whole);
}

TEST(Multicast, KeepsNothingOfAHundredThousandChannels) {
  REQUIRE_OWN_NETWORK();
  Receiver<positions_t> receiver(kDeviceUrl, "P", kOrdinary);
  const RawSender raw(receiver.listener().address());
  std::string datagram = lcm_datagram("Pxxxxxxx", "payload");
  raw.send(datagram);
  const long before = heap_calls;
  for (int i = 0; i < 100000; ++i) {
    for (int rest = i, place = 15; place > 8; --place, rest /= 10) datagram[place] = static_cast<char>('0' + rest % 10);
    raw.send(datagram);
  }
  EXPECT_EQ(heap_calls - before, 0);  // LCM's library makes two a name, and never frees them
  EXPECT_EQ(receiver.listener().dropped_by_kernel(), 100001);
}

/// A process that subscribes with LCM's library, and says when it is ready and when it got a message.
class LibrarySubscriber {
 public:
  explicit LibrarySubscriber(const char* url) {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    process_ = fork();
    if (process_ == 0) {
      close(ends[0]);
      subscribe(url, ends[1]);
    }
    close(ends[1]);
    words_ = ends[0];
  }
  ~LibrarySubscriber() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    close(words_);
  }
  LibrarySubscriber(const LibrarySubscriber&) = delete;
  LibrarySubscriber& operator=(const LibrarySubscriber&) = delete;

  /// @return its next word; '-' when it died, '?' when it said nothing for a while
  char listen() const {
    pollfd waiting{words_, POLLIN, 0};
    if (poll(&waiting, 1, 30000) <= 0) return '?';
    char word = '-';
    return read(words_, &word, 1) == 1 ? word : '-';
  }

 private:
  [[noreturn]] static void subscribe(const char* url, int words) {
    lcm_t* lcm = lcm_create(url);
    const auto say = [](const lcm_recv_buf_t*, const char*, void* where) {
      if (write(*static_cast<int*>(where), "m", 1) != 1) _exit(1);
    };
    if (lcm == nullptr || lcm_subscribe(lcm, kPositionsChannel, say, &words) == nullptr) _exit(1);
    if (write(words, "r", 1) != 1) _exit(1);
    while (lcm_handle(lcm) == 0) {
    }
    _exit(1);
  }

  pid_t process_;
  int words_;
};

void send_the_pair(const RawSender& raw) {
  raw.send(lcm_fragment(100, 0, 0, 2, std::string(kPositionsChannel) + std::string(1, '\0') + "abc"));
  raw.send(lcm_fragment(100, 0xFFFFFFF0, 1, 2, std::string(40, 'x')));
}

TEST(Multicast, TheFragmentsThatKillLcmsLibraryDoNotReachTheReceiver) {
  REQUIRE_OWN_NETWORK();
  const LibrarySubscriber library(kDeviceUrl);
  ASSERT_EQ(library.listen(), 'r');
  Receiver<positions_t> receiver(kDeviceUrl, kPositionsChannel, kOrdinary);
  const RawSender raw(parse_lcm_address(kDeviceUrl));
  Sender sender(kDeviceUrl);
  positions_t positions{};
  positions.sequence = 1;
  ASSERT_TRUE(sender.publish(kPositionsChannel, positions));
  EXPECT_EQ(library.listen(), 'm');

  send_the_pair(raw);
  positions.sequence = 2;
  ASSERT_TRUE(sender.publish(kPositionsChannel, positions));
  const char answer = library.listen();
  RecordProperty("library", answer == '-' ? "died" : "survived");
  // else these would be harmless packets, and to survive them no merit
  if (LCM_MAJOR_VERSION == 1 && LCM_MINOR_VERSION == 3) {
    EXPECT_EQ(answer, '-');
  }
  positions_t got{};
  EXPECT_TRUE(eventually([&] { return receiver.take(got) && got.sequence == 2; }));
  EXPECT_EQ(receiver.counts().accepted, 2);
}

TEST(Multicast, LcmsLibraryReadsWhatTheSenderWrites) {
  REQUIRE_OWN_NETWORK();
  struct Got {
    positions_t positions;
    int size = 0;
  } got;
  lcm_t* lcm = lcm_create(kDeviceUrl);
  ASSERT_NE(lcm, nullptr);
  const auto keep = [](const lcm_recv_buf_t* buffer, const char*, void* where) {
    auto& kept = *static_cast<Got*>(where);
    kept.size = kept.positions.decode(buffer->data, 0, static_cast<int>(buffer->data_size));
  };
  ASSERT_NE(lcm_subscribe(lcm, kPositionsChannel, keep, &got), nullptr);
  Sender sender(kDeviceUrl);
  positions_t positions{};
  positions.sequence = 9;
  positions.position_m[87] = -1.25e-3;
  ASSERT_TRUE(sender.publish(kPositionsChannel, positions));
  ASSERT_EQ(lcm_handle(lcm), 0);
  EXPECT_EQ(got.size, positions.getEncodedSize());
  EXPECT_EQ(encoded(got.positions), encoded(positions));
  lcm_destroy(lcm);
}

}  // namespace
}  // namespace erard
