// Which messages of a channel count, and which positions in them.
#include "erard/haptics/position_watch.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace erard {
namespace {

constexpr std::int64_t kPeriod = 500'000;  // [ns] 2 kHz
constexpr double kT = 5e-4;                // [s]
const std::array<double, 2> kPositions{};

/// A channel whose messages arrive 0.2 ms after their device time.
class Channel {
 public:
  Fault send(std::uint64_t publisher, std::int64_t sequence, std::int64_t host_time, std::int64_t device_time) {
    return watch_.look({publisher, sequence, device_time, kPositions}, host_time);
  }
  Fault send(std::uint64_t publisher, std::int64_t sequence, std::int64_t host_time) {
    return send(publisher, sequence, host_time, host_time - 200'000);
  }
  const MessageWatch& watch() const { return watch_; }

 private:
  PositionWatchSettings settings_;
  MessageWatch watch_{settings_, 2};
};

TEST(MessageWatch, TakesEachSequenceOnceAndOnlyForward) {
  Channel channel;
  const std::array<std::int64_t, 7> sequences{10, 11, 11, 13, 12, 5, 14};
  const std::array<Fault, 7> expected{Fault::none,      Fault::none,      Fault::duplicate, Fault::gap,
                                      Fault::reordered, Fault::reordered, Fault::none};
  for (std::size_t i = 0; i < sequences.size(); ++i)
    EXPECT_EQ(channel.send(1, sequences[i], static_cast<std::int64_t>(i) * kPeriod), expected[i]) << i;
}

TEST(MessageWatch, CountsLostMessages) {
  Channel channel;
  channel.send(1, 10, 0);
  EXPECT_EQ(channel.send(1, 15, kPeriod), Fault::gap);
  EXPECT_EQ(channel.watch().lost(), 4u);
  EXPECT_EQ(channel.send(1, 16, 2 * kPeriod), Fault::none);
  EXPECT_EQ(channel.watch().lost(), 0u);
}

TEST(MessageWatch, SequencesFromEndToEndOfTheirTypeAreNoOverflow) {
  Channel channel;
  channel.send(1, std::numeric_limits<std::int64_t>::min(), 0);
  EXPECT_EQ(channel.send(1, std::numeric_limits<std::int64_t>::max(), kPeriod), Fault::gap);
  EXPECT_EQ(channel.watch().lost(), std::numeric_limits<std::uint64_t>::max() - 1);
}

TEST(MessageWatch, FirstPublisherAliveKeepsTheChannel) {
  Channel channel;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(channel.send(1, i, i * kPeriod), Fault::none);
    EXPECT_EQ(channel.send(2, 1000 + i, i * kPeriod + 1), Fault::foreign_publisher);
  }
}

TEST(MessageWatch, AnotherPublisherHasTheChannelAfterTheTimeoutAndNotBefore) {
  Channel channel;
  channel.send(1, 100, 0);
  EXPECT_EQ(channel.send(2, 1, 10'000'000), Fault::foreign_publisher);  // timeout 10 ms, to the nanosecond
  EXPECT_EQ(channel.send(2, 2, 10'000'001), Fault::none);
  EXPECT_TRUE(channel.watch().is_first());
  EXPECT_EQ(channel.send(1, 101, 10'500'000), Fault::foreign_publisher);  // who was silent has lost it
}

TEST(MessageWatch, PublisherThatBeganAnewUnderItsOldNameIsHeardAfterTheTimeout) {
  Channel channel;
  channel.send(1, 100000, 0);
  EXPECT_EQ(channel.send(1, 1, kPeriod), Fault::reordered);
  EXPECT_EQ(channel.send(1, 2, 10'000'001), Fault::none);
  EXPECT_EQ(channel.send(1, 3, 10'500'001), Fault::none);
}

TEST(MessageWatch, DeviceTimeThatStandsStillIsStale) {
  Channel channel;
  channel.send(1, 1, 1'000'000, 800'000);
  EXPECT_EQ(channel.send(1, 2, 1'500'000, 800'000), Fault::stale_time);
  EXPECT_EQ(channel.send(1, 3, 2'000'000, 700'000), Fault::stale_time);
  EXPECT_EQ(channel.send(1, 4, 2'500'000, 900'000), Fault::gap);  // 2 and 3 did not count
}

TEST(MessageWatch, MessagesThatQueuedForLongerThanTheTimeoutAreStale) {
  Channel channel;
  channel.send(1, 1, 1'000'000, 800'000);
  // 5 ms late counts, 15 ms late does not; clocks without a common zero: the first transit is the measure
  EXPECT_EQ(channel.send(1, 2, 6'500'000, 1'300'000), Fault::none);
  EXPECT_EQ(channel.send(1, 3, 16'400'000, 1'800'000), Fault::stale_time);
}

TEST(MessageWatch, ClocksThatDriftByAHundredPartsPerMillionStayInTouch) {
  Channel channel;
  for (std::int64_t i = 0; i < 400'000; ++i) {  // 200 s, after which they are 20 ms apart
    const std::int64_t device = i * kPeriod;
    ASSERT_EQ(channel.send(1, i, device + device / 10'000, device), Fault::none) << i;
  }
}

TEST(MessageWatch, MessageWithAnotherNumberOfKeysIsRefused) {
  PositionWatchSettings settings;
  MessageWatch watch(settings, 3);
  EXPECT_EQ(watch.look({1, 1, 0, kPositions}, 0), Fault::wrong_size);
}

/// A key that is being looked at every period.
class KeyUnderWatch {
 public:
  SampleVerdict look(double position, bool is_new_stream = false) {
    faults = Fault::none;
    time_ += kT;
    return watch_.look(settings, position, time_, kT, is_new_stream, faults);
  }
  void skip(double seconds) { time_ += seconds; }
  /// Until it counts. @return samples that took
  int begin(double position) {
    int n = 1;
    while (look(position) == SampleVerdict::rejected) ++n;
    return n;
  }

  PositionWatchSettings settings;
  Fault faults = Fault::none;

 private:
  KeyWatch watch_;
  double time_ = 0;
};

TEST(KeyWatch, CountsOnceEnoughSamplesFitTogether) {
  KeyUnderWatch key;
  EXPECT_EQ(key.begin(0.001), key.settings.recovery_samples);
  EXPECT_EQ(key.faults, Fault::none);
  EXPECT_EQ(key.look(0.0011), SampleVerdict::good);
}

TEST(KeyWatch, NumbersThatAreNoneAreRejectedAndTheNextGoodOneCounts) {
  KeyUnderWatch key;
  key.begin(0);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(key.look(bad), SampleVerdict::rejected);
    EXPECT_EQ(key.faults, Fault::not_finite_input);
    EXPECT_EQ(key.look(0.0001), SampleVerdict::good);
  }
}

TEST(KeyWatch, PositionsBeyondTheLimitsAreRejected) {
  KeyUnderWatch key;
  key.begin(0.015);
  for (const double bad : {1e308, -1e308, 0.0161, -0.0031}) {
    EXPECT_EQ(key.look(bad), SampleVerdict::rejected) << bad;
    EXPECT_EQ(key.faults, Fault::out_of_range) << bad;
  }
  EXPECT_EQ(key.look(0.016), SampleVerdict::good);
}

TEST(KeyWatch, AJumpOfFiveMillimetresInAPeriodIsRejectedAndOneSpikeHarmsNothing) {
  KeyUnderWatch key;
  key.begin(0.001);
  EXPECT_EQ(key.look(0.006), SampleVerdict::rejected);
  EXPECT_EQ(key.faults, Fault::implausible_speed);
  EXPECT_EQ(key.look(0.001), SampleVerdict::good);
}

TEST(KeyWatch, FastestAllowedKeyIsNeverRejected) {
  KeyUnderWatch key;
  key.begin(0);
  for (int i = 1; i <= 10; ++i)  // 3 m/s, a millionth less for rounding
    EXPECT_EQ(key.look(i * 3.0 * kT * (1 - 1e-6)), SampleVerdict::good) << i;
}

TEST(KeyWatch, WayThatAllowsForTheTimeOfLostSamplesCounts) {
  KeyUnderWatch key;
  key.begin(0);
  key.skip(4 * kT);
  EXPECT_EQ(key.look(0.006), SampleVerdict::good);  // 2.4 m/s over five periods
}

TEST(KeyWatch, AJumpThatLastsCountsAfterSoManySamplesAsResumed) {
  KeyUnderWatch key;
  key.begin(0);
  for (int i = 1; i < key.settings.recovery_samples; ++i)
    EXPECT_EQ(key.look(0.009 + 1e-5 * i), SampleVerdict::rejected) << i;
  EXPECT_EQ(key.look(0.0091), SampleVerdict::resumed);
  EXPECT_EQ(key.look(0.0091), SampleVerdict::good);
}

TEST(KeyWatch, SamplesThatDoNotFitTogetherNeverCount) {
  KeyUnderWatch key;
  key.begin(0);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(key.look(i % 2 == 0 ? 0.005 : 0.012), SampleVerdict::rejected) << i;
}

TEST(KeyWatch, AfterASilenceTheKeyMayBeAnywhereButMustBeSeenAgainSeveralTimes) {
  KeyUnderWatch key;
  key.begin(0);
  key.skip(0.3);
  EXPECT_EQ(key.look(0.009), SampleVerdict::rejected);
  EXPECT_EQ(key.faults, Fault::none);  // nothing implausible about it
  int n = 1;
  while (key.look(0.009) == SampleVerdict::rejected) ++n;
  EXPECT_EQ(n, key.settings.recovery_samples - 1);
}

TEST(KeyWatch, NewStreamBeginsAnew) {
  KeyUnderWatch key;
  key.begin(0.002);
  EXPECT_EQ(key.look(0.002, true), SampleVerdict::rejected);
  EXPECT_EQ(key.begin(0.002), key.settings.recovery_samples - 1);
}

}  // namespace
}  // namespace erard
