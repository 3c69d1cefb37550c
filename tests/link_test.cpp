// Messages over LCM: what arrives, and what must never.
#include "erard/device/link.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>
#include <vector>

#include "erard/device/error.hpp"
#include "erard/haptics/fault.hpp"
#include "support/udp.hpp"

namespace erard {
namespace {

using test::big_endian;
using test::encoded;
using test::eventually;
using test::lcm_datagram;
using test::lcm_fragment;
using test::RawSender;

constexpr ListenerSettings kOrdinary{0};             // no rights are needed
constexpr const char* kHere = "udpm://127.0.0.1:0";  // one machine, a free port: no group, no route

positions_t some_positions(std::int64_t sequence) {
  positions_t positions{};
  positions.publisher_id = 11;
  positions.sequence = sequence;
  positions.device_time_ns = 1000 * sequence;
  positions.key_count = positions_t::kMaxKeys;
  for (int key = 0; key < positions.key_count; ++key) positions.position_m[key] = 1e-4 * key + 1e-6 * double(sequence);
  return positions;
}

Bytes bytes_of(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

std::string sentence_of(const std::string& url) {
  try {
    parse_lcm_address(url);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LcmAddress, ReadsWhatLcmReads) {
  const LcmAddress usual = parse_lcm_address("udpm://");
  EXPECT_EQ(usual.to_string(), "239.255.76.67:7667");
  EXPECT_EQ(usual.ttl, 0);
  EXPECT_TRUE(usual.is_group());
  const LcmAddress full = parse_lcm_address("udpm://239.1.2.3:70?ttl=1&recv_buf_size=100000");
  EXPECT_EQ(full.to_string(), "239.1.2.3:70");
  EXPECT_EQ(full.ttl, 1);
  EXPECT_EQ(full.receive_buffer_size, 100000);
  EXPECT_FALSE(parse_lcm_address("udpm://127.0.0.1").is_group());
}

TEST(LcmAddress, SaysWhatItCannotRead) {
  for (const auto& [url, complaint] : std::vector<std::pair<std::string, std::string>>{
           {"", "must be an LCM address"},
           {"tcpq://localhost", "must be an LCM address"},
           {"udpm://239.1.2", "239.1.2 is not an IP address"},
           {"udpm://239.1.2.3:70000", "port = 70000, must be a whole number from 0 to 65535"},
           {"udpm://239.1.2.3:7x", "port = 7x"},
           {"udpm://?ttl=", "ttl = , must be"},
           {"udpm://?ttl=256", "ttl = 256, must be"},
           {"udpm://?tll=0", "tll: unknown option"}}) {
    EXPECT_NE(sentence_of(url).find(complaint), std::string::npos) << url << ": " << sentence_of(url);
  }
}

TEST(Sender, SendsToGroupsAlone) {
  EXPECT_THROW(Sender("udpm://127.0.0.1:7667"), InputError);
  EXPECT_THROW(Sender("somewhere"), InputError);
}

TEST(LcmChannel, MustBeAName) {
  EXPECT_NO_THROW(check_lcm_channel(kPositionsChannel));
  EXPECT_NO_THROW(check_lcm_channel(std::string(63, 'A')));
  for (const std::string& name : {std::string(), std::string(64, 'A'), std::string("A B"), std::string("A\nB")})
    EXPECT_THROW(check_lcm_channel(name), InputError) << name;
}

TEST(LcmDatagram, FindsThePayloadOfItsChannelAlone) {
  const std::string good = lcm_datagram("AB", "payload");
  const auto payload = lcm_payload(bytes_of(good), "AB");
  ASSERT_TRUE(payload);
  EXPECT_EQ(std::string(payload->begin(), payload->end()), "payload");
  EXPECT_TRUE(lcm_payload(bytes_of(lcm_datagram("AB", "")), "AB")->empty());
  for (const std::string& bad :
       {lcm_datagram("A", "payload"), lcm_datagram("ABC", "payload"), lcm_datagram("AC", "payload"),
        "LC03" + good.substr(4), std::string("LC02"), std::string(), std::string("LC02\0\0\0\1AB", 10), "x" + good})
    EXPECT_FALSE(lcm_payload(bytes_of(bad), "AB"));
}

TEST(LcmDatagram, IsNotReadBeyondItsEnd) {
  // each cut is a block of its own on the heap: the address sanitizer sees a byte too far
  const std::string whole = lcm_datagram("CHANNEL", "payload");
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const std::unique_ptr<std::uint8_t[]> cut(new std::uint8_t[size]);
    std::copy_n(whole.begin(), size, cut.get());
    const auto payload = lcm_payload({cut.get(), size}, "CHANNEL");
    EXPECT_EQ(payload.has_value(), size >= 16) << size;  // 8 of the header, 7 letters, a zero
    if (payload) {
      EXPECT_EQ(payload->size(), size - 16);
    }
  }
}

TEST(MessageRing, KeepsTheOldestInOrderWhenFull) {
  MessageRing<int, 4> ring;
  EXPECT_EQ(ring.oldest(), nullptr);
  for (int i = 0; i < 4; ++i) {
    *ring.room() = i;
    ring.commit();
  }
  EXPECT_EQ(ring.room(), nullptr);
  for (int i = 0; i < 4; ++i) {
    ASSERT_NE(ring.oldest(), nullptr);
    EXPECT_EQ(*ring.oldest(), i);
    ring.release();
  }
  EXPECT_EQ(ring.oldest(), nullptr);
}

TEST(MessageRing, HandsEveryValueToTheOtherThreadOnce) {
  constexpr std::int64_t kCount = 20000;
  using Pair = std::array<std::int64_t, 2>;  // torn when its halves differ
  const auto ring = std::make_unique<MessageRing<Pair, 8>>();
  std::thread writer([&ring] {
    for (std::int64_t i = 0; i < kCount;)
      if (Pair* room = ring->room()) {
        *room = {i, i};
        ring->commit();
        ++i;
      } else {
        std::this_thread::yield();
      }
  });
  std::int64_t wrong = 0;
  for (std::int64_t i = 0; i < kCount;)
    if (const Pair* pair = ring->oldest()) {
      wrong += *pair != Pair{i, i};
      ring->release();
      ++i;
    } else {
      std::this_thread::yield();
    }
  writer.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Receiver, DeliversWhatWasSentInOrder) {
  Receiver<positions_t> receiver(kHere, kPositionsChannel, kOrdinary);
  const RawSender raw(receiver.listener().address());
  for (std::int64_t i = 1; i <= 20; ++i) raw.send(lcm_datagram(kPositionsChannel, encoded(some_positions(i))));
  ASSERT_TRUE(eventually([&] { return receiver.counts().accepted == 20; }));
  positions_t got{};
  for (std::int64_t i = 1; i <= 20; ++i) {
    ASSERT_TRUE(receiver.take(got));
    EXPECT_EQ(encoded(got), encoded(some_positions(i)));
  }
  EXPECT_FALSE(receiver.take(got));
  EXPECT_EQ(got.sequence, 20);  // as it was
}

TEST(Receiver, CountsOtherTypesAndSizes) {
  Receiver<positions_t> receiver(kHere, "P", kOrdinary);
  const RawSender raw(receiver.listener().address());
  const std::string good = encoded(some_positions(1));
  raw.send(lcm_datagram("P", encoded(forces_t{})));
  raw.send(lcm_datagram("P", std::string(good.size(), '\0')));
  raw.send(lcm_datagram("P", good.substr(0, good.size() - 1)));
  raw.send(lcm_datagram("P", good + "x"));
  raw.send(lcm_datagram("P", good + std::string(40000, 'x')));  // longer than the listener's memory
  raw.send(lcm_datagram("P", good.substr(0, 7)));
  raw.send(lcm_datagram("P", ""));
  raw.send(lcm_datagram("P", good));
  ASSERT_TRUE(eventually([&] { return receiver.counts().accepted == 1; }));
  EXPECT_EQ(receiver.counts().wrong_type, 2);
  EXPECT_EQ(receiver.counts().wrong_size, 5);
  EXPECT_EQ(receiver.counts().overflow, 0);
}

TEST(Receiver, CountsWhatFoundNoRoomAndKeepsTheOldest) {
  Receiver<positions_t> receiver(kHere, "P", kOrdinary);
  const RawSender raw(receiver.listener().address());
  for (std::int64_t i = 1; i <= Receiver<positions_t>::kRoom + 5; ++i) {
    raw.send(lcm_datagram("P", encoded(some_positions(i))));
    ASSERT_TRUE(eventually([&] { return receiver.counts().accepted + receiver.counts().overflow == i; }));
  }
  EXPECT_EQ(receiver.counts().overflow, 5);
  positions_t got;
  for (std::int64_t i = 1; i <= Receiver<positions_t>::kRoom; ++i) {
    ASSERT_TRUE(receiver.take(got));
    EXPECT_EQ(got.sequence, i);
  }
  EXPECT_FALSE(receiver.take(got));
}

TEST(Receiver, IsNotWokenByOtherChannels) {
  int handled = 0;
  DatagramListener listener(
      parse_lcm_address(kHere), "P", [&](Bytes) { ++handled; }, kOrdinary);
  const RawSender raw(listener.address());
  for (int i = 0; i < 50; ++i) raw.send(lcm_datagram(i % 2 ? "Q" : "PQ", "payload"));
  // the kernel decides when they are sent, before anybody could be woken
  EXPECT_EQ(listener.dropped_by_kernel(), 50);
  EXPECT_EQ(handled, 0);
}

TEST(Receiver, SaysWhoIsInItsPlace) {
  Receiver<positions_t> first(kHere, "P", kOrdinary);
  try {
    Receiver<positions_t> second(first.listener().address(), "P", kOrdinary);
    FAIL() << "two receivers on one port of a machine";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is somebody else listening there?"), std::string::npos) << error.what();
  }
}

TEST(Receiver, SaysWhatPriorityWasGranted) {
  const Receiver<positions_t> ordinary(kHere, "P", kOrdinary);
  EXPECT_EQ(ordinary.listener().granted_priority(), 0);
  const sched_param wanted{1};
  sched_param before{};
  const int policy = sched_getscheduler(0);
  sched_getparam(0, &before);
  const bool is_permitted = sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
  sched_setscheduler(0, policy, &before);
  const Receiver<positions_t> urgent(kHere, "P", ListenerSettings{1});
  EXPECT_EQ(urgent.listener().granted_priority(), is_permitted ? 1 : 0);
}

/// All that is known to harm LCM's library, and what could harm any other.
std::vector<std::string> hostile_datagrams(const std::string& channel) {
  const std::string good = lcm_datagram(channel, encoded(some_positions(1)));
  const std::string zero(1, '\0');
  return {
      lcm_fragment(100, 0, 0, 2, channel + zero + "abc"),  // with the next one: death of LCM 1.3.1
      lcm_fragment(100, 0xFFFFFFF0, 1, 2, std::string(40, 'x')),
      lcm_fragment(0xFFFFFFFF, 0, 0, 2, channel + zero),
      lcm_fragment(100, 0, 0, 0, channel + zero),
      lcm_fragment(10, 0, 0, 1, channel + zero + std::string(1000, 'x')),
      "LC02" + big_endian(1, 4) + channel,  // a name without an end
      "LC02" + big_endian(1, 4) + std::string(64, 'A') + zero,
      "LC02" + big_endian(1, 4) + std::string(60000, 'A'),
      "LC02",
      "LC0",
      "",
      "XXXX" + good.substr(4),
      good.substr(0, 9),
      std::string(65000, '\xff'),
  };
}

void expect_survival(Receiver<positions_t>& receiver, const std::string& channel) {
  const RawSender raw(receiver.listener().address());
  for (int round = 0; round < 20; ++round)
    for (const std::string& datagram : hostile_datagrams(channel)) raw.send(datagram);
  raw.send(lcm_datagram(channel, encoded(some_positions(77))));
  positions_t got{};
  ASSERT_TRUE(eventually([&] { return receiver.take(got); }));
  EXPECT_EQ(got.sequence, 77);
  EXPECT_EQ(receiver.counts().accepted, 1);
}

TEST(Receiver, SurvivesHostileDatagrams) {
  Receiver<positions_t> receiver(kHere, "P", kOrdinary);
  expect_survival(receiver, "P");
}

TEST(Receiver, SurvivesRandomDatagrams) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  Receiver<positions_t> receiver(kHere, "P", kOrdinary);
  const RawSender raw(receiver.listener().address());
  const std::string good = lcm_datagram("P", encoded(some_positions(1)));
  for (int i = 0; i < 3000; ++i) {
    std::string datagram = good.substr(0, random() % (good.size() + 1));
    for (unsigned flips = random() % 4; flips > 0 && !datagram.empty(); --flips)
      datagram[random() % std::min<std::size_t>(datagram.size(), 30)] = static_cast<char>(random());
    raw.send(datagram);
  }
  positions_t got{};
  ASSERT_TRUE(eventually([&] {
    raw.send(lcm_datagram("P", encoded(some_positions(77))));
    while (receiver.take(got) && got.sequence != 77) {
    }
    return got.sequence == 77;
  }));
}

TEST(HostStatus, NamesTheBitsOfFaultsAsTheRendererDoes) {
  constexpr std::array<std::int32_t, kFaultCount> bits{
      host_status_t::kDuplicate,        host_status_t::kReordered,      host_status_t::kGap,
      host_status_t::kForeignPublisher, host_status_t::kStaleTime,      host_status_t::kWrongSize,
      host_status_t::kNotFiniteInput,   host_status_t::kOutOfRange,     host_status_t::kImplausibleSpeed,
      host_status_t::kNoInput,          host_status_t::kRealigned,      host_status_t::kStepNotFinite,
      host_status_t::kStepNotConverged, host_status_t::kPassivityActed, host_status_t::kForceLimited,
      host_status_t::kSlewLimited,      host_status_t::kCurrentLimited, host_status_t::kThermalLimited,
      host_status_t::kCannotPush,       host_status_t::kWrongType,      host_status_t::kOverflow,
      host_status_t::kPublishFailed,    host_status_t::kPeriodMissed,   host_status_t::kRecordingStopped,
      host_status_t::kCoarserSteps,
  };
  for (int i = 0; i < kFaultCount; ++i) EXPECT_EQ(bits[static_cast<std::size_t>(i)], 1 << i) << fault_name(i);
}

}  // namespace
}  // namespace erard
