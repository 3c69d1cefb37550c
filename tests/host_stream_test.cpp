// Streams of positions that networks and other programs spoil, during a stroke.
#include <atomic>

#include "support/host_test.hpp"

namespace erard {
namespace {

using test::eventually;
using test::RecordedPeriod;

/// A forte stroke through a spoilt stream, and one through a good one.
class HostStream : public test::DisturbedHost {
 protected:
  void play_through(const Transmit& transmit) {
    start_host();
    device_->play(test::rest(0.1));
    ASSERT_TRUE(eventually([&] { return device_->is_still(); }));
    expect_whole_again();
    window_.from = monotonic_time_ns();
    device_->transmit_by(transmit);
    device_->play(stroke_.press);
    device_->play(stroke_.release);
    ASSERT_TRUE(eventually([&] { return device_->is_still(); }));
    end_disturbance();
  }

  /// What would have come: a message whose time it was when nothing came, each once, in order.
  std::vector<double> repaired(const RecordedPeriod& period) {
    std::int64_t newest = next_;  // of what has come by now
    for (const positions_t& p : period.arrived) newest = std::max(newest, p.sequence);
    if (next_ == 0) next_ = newest;
    std::vector<double> positions;
    if (newest > 0)
      for (; next_ <= newest; ++next_) positions.push_back(samples_[static_cast<std::size_t>(next_ - 1)].position);
    return positions;
  }

  /// The force in the spoilt stroke against that of the stroke as it was played.
  void expect_force_within(double rms) {
    const test::Difference spoilt = test::difference(session_, reference_.force, window_);
    RecordProperty("spoilt_rms_N", std::to_string(spoilt.rms));
    std::printf("spoilt rms %.3g N, largest %.3g N\n", spoilt.rms, spoilt.largest);
    EXPECT_LT(spoilt.rms, rms);
    EXPECT_GT(spoilt.rms, 0);
  }
  void finish_stroke(std::initializer_list<Fault> faults) {
    samples_ = device_->samples();
    truth_ = [this](const RecordedPeriod& period) { return repaired(period); };
    finish(faults);
  }

  std::int64_t next_ = 0;  // sequence
  std::vector<test::Sample> samples_;
};

TEST_F(HostStream, OneInTenLostIsGuessedAndCounted) {
  int lost = 0;
  play_through([&](const positions_t& p, Sender& sender) {
    if ((static_cast<std::uint32_t>(p.sequence) * 2654435761u >> 16) % 10 == 0)  // Knuth's hash: one in ten, no pattern
      ++lost;
    else
      sender.publish(kPositionsChannel, p);
  });
  finish_stroke({Fault::gap});
  EXPECT_GT(lost, 50);
  EXPECT_EQ(device_->status().dropped_lost, lost);
  expect_force_within(0.3);
}

TEST_F(HostStream, WhatComesTwiceCountsOnce) {
  play_through([](const positions_t& p, Sender& sender) {
    sender.publish(kPositionsChannel, p);
    sender.publish(kPositionsChannel, p);
  });
  finish_stroke({Fault::duplicate});
  EXPECT_GT(device_->status().dropped_duplicate, 500);
  expect_force_within(0.3);
}

TEST_F(HostStream, WhatWasOvertakenIsNotUsed) {
  positions_t held{};
  play_through([&](const positions_t& p, Sender& sender) {
    if (p.sequence % 2 == 1) {
      held = p;
      return;
    }
    sender.publish(kPositionsChannel, p);
    if (held.sequence > 0) sender.publish(kPositionsChannel, held);
  });
  finish_stroke({Fault::reordered});
  EXPECT_GT(device_->status().dropped_reordered, 200);
  expect_force_within(0.3);
}

/// A hundred thousand messages of somebody else a second.
class Flood {
 public:
  Flood() : thread_([this] { work(); }) {}
  ~Flood() {
    is_over_ = true;
    thread_.join();
  }
  Flood(const Flood&) = delete;
  Flood& operator=(const Flood&) = delete;

  long sent() const { return sent_; }

 private:
  void work() {
    positions_t foreign{};
    foreign.publisher_id = 1;
    foreign.key_count = 1;
    const test::RawSender raw(parse_lcm_address(kDeviceUrl));
    const MonotonicClock clock;
    for (std::int64_t due = clock.now(); !is_over_; due += 1'000'000) {
      clock.sleep_until(due);
      for (int i = 0; i < 100; ++i, ++sent_) {
        ++foreign.sequence;
        raw.send(test::lcm_datagram(kPositionsChannel, test::encoded(foreign)));
      }
    }
  }

  std::atomic<long> sent_{0};
  std::atomic<bool> is_over_{false};
  std::thread thread_;
};

TEST_F(HostStream, AFloodDoesNotStopTheLoop) {
  start_as({"--best-effort"});  // a recording would be one of the flood
  press();
  {
    const Flood flood;
    const std::int64_t before = device_->force().sequence;
    ASSERT_TRUE(eventually([&] { return flood.sent() > 50'000 && device_->force().sequence > before + 1000; }));
    RecordProperty("sent", std::to_string(flood.sent()));
  }
  expect_whole_again();
  const host_status_t status = device_->status();
  std::printf("foreign %ld overflow %ld kernel %ld\n", status.dropped_foreign_publisher, status.dropped_overflow,
              status.dropped_by_kernel);
  EXPECT_GT(status.dropped_foreign_publisher + status.dropped_overflow + status.dropped_by_kernel, 40'000);
  release_and_play_again();
  const test::Outcome outcome = stop();
  EXPECT_NE(outcome.out.find("foreign_publisher"), std::string::npos) << outcome.out;
  test::expect_safe(device_->heard().forces, GuardSettings{});
}

}  // namespace
}  // namespace erard
