// What reaches the running host in place of good positions: what it does meanwhile, and that it comes back.
#include <fmt/format.h>

#include <limits>

#include "support/host_test.hpp"

namespace erard {
namespace {

using test::Child;
using test::eventually;
using test::lcm_datagram;
using test::lcm_fragment;
using test::RawSender;
using test::tells;

using HostInput = test::DisturbedHost;

/// What is most likely to depend on what begins a period.
class HostInputAtEitherPace : public HostInput, public testing::WithParamInterface<const char*> {
  const char* pace() const override { return GetParam(); }
};

INSTANTIATE_TEST_SUITE_P(Pace, HostInputAtEitherPace, testing::Values("clock", "messages"),
                         [](const auto& suite) { return std::string(suite.param); });

/// A device program that presses the key and holds it there.
class DeviceProgram {
 public:
  explicit DeviceProgram(const std::vector<double>& press) {
    std::string text = "t_s,position_m\n";
    for (int i = 0; i < 60000; ++i)
      text += fmt::format("{},{}\n", 5e-4 * i, press[std::min(static_cast<std::size_t>(i), press.size() - 1)]);
    test::write_text(folder_ / "held.csv", text);
    program_ = std::make_unique<Child>("erard-replay", std::vector{(folder_ / "held.csv").string()});
  }
  void send(int signal) const { program_->send(signal); }

 private:
  test::TemporaryFolder folder_;
  std::unique_ptr<Child> program_;
};

TEST_P(HostInputAtEitherPace, AKilledDeviceLeavesNoForceAndItsSuccessorFindsTheActionAsItWas) {
  start_host();
  device_->fall_silent();
  const DeviceProgram program(stroke_.press);
  ASSERT_TRUE(eventually([&] { return device_->state().key_position_m > 0.009; }));
  ASSERT_TRUE(eventually([&] { return test::is_whole(device_->force()) && device_->force().force_N[0] > 0.5; }));
  window_.from = monotonic_time_ns();
  program.send(SIGKILL);
  EXPECT_TRUE(eventually([&] { return is_off() && tells(device_->status().fault_bits_now, Fault::no_input); }));
  EXPECT_EQ(device_->status().state, host_status_t::kFading);
  device_->play({bottom()});
  end_disturbance();
  finish({Fault::no_input});
  expect_faded();
}

TEST_F(HostInput, AFrozenDeviceLeavesNoForceAndGoesOnWhenItThaws) {
  start_host();
  device_->fall_silent();
  const DeviceProgram program(stroke_.press);
  ASSERT_TRUE(eventually([&] { return device_->state().key_position_m > 0.009; }));
  ASSERT_TRUE(eventually([&] { return test::is_whole(device_->force()) && device_->force().force_N[0] > 0.5; }));
  window_.from = monotonic_time_ns();
  program.send(SIGSTOP);
  EXPECT_TRUE(eventually([&] { return is_off() && tells(device_->status().fault_bits_now, Fault::no_input); }));
  program.send(SIGCONT);  // all that is late comes at once
  expect_whole_again();
  program.send(SIGKILL);
  EXPECT_TRUE(eventually([&] { return is_off(); }));
  device_->play({bottom()});
  end_disturbance();
  finish({Fault::no_input});
  expect_faded();
}

TEST_P(HostInputAtEitherPace, ValuesThatAreNoNumbersAreNoPositions) {
  start_host();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::array nonsense{std::nan(""), kInfinity, -kInfinity, 1e308, -1e308, 0.5, -0.5};
  disturb(
      [&](positions_t p, Sender& sender) {
        p.position_m[0] = nonsense[static_cast<std::size_t>(p.sequence) % nonsense.size()];
        sender.publish(kPositionsChannel, p);
      },
      [&] {
        const host_status_t status = device_->status();
        return is_off() && status.dropped_not_finite > 10 && status.dropped_out_of_range > 10;
      });
  finish({Fault::not_finite_input, Fault::out_of_range, Fault::no_input});
  expect_faded();
}

/// Whether samples came so closely in the window that nobody could have gone so far between two of them.
bool is_too_close_for(double way, const test::RecordedSession& session, const test::Window& window) {
  std::int64_t last = 0;
  for (const test::RecordedPeriod& period : session.periods) {
    if (!window.holds(period.time()) || period.arrived.empty()) continue;
    const std::int64_t time = period.arrived.back().device_time_ns;  // the newest is looked at
    if (last > 0 && session.rendering().watch.max_speed * 1e-9 * static_cast<double>(time - last) >= way) return false;
    last = time;
  }
  return true;
}

/// Under the address sanitizer samples never came closely enough in eight attempts, with the machine to itself: whether
/// the finger was disturbed cannot be told. What is checked in all cases is that the host stays safe and comes back.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kIsSlow = true;
#else
constexpr bool kIsSlow = false;
#endif

TEST_P(HostInputAtEitherPace, AMomentaryJumpIsNotBelieved) {
  constexpr double kWay = 5e-3;  // [m]
  // Where the machine keeps device or host waiting for 1.7 ms, 5 mm are no jump but a quick motion: then once more.
  for (int attempt = 0; attempt < 8; ++attempt) {
    device_.reset();
    start_host();
    const std::int64_t before = device_->status().dropped_implausible_speed;
    disturb(
        [&](positions_t p, Sender& sender) {  // 4 of 40 samples: 2 ms
          if (p.sequence % 40 < 4) p.position_m[0] -= kWay;
          sender.publish(kPositionsChannel, p);
        },
        [&] { return device_->status().dropped_implausible_speed > before + 8; });
    trust_the_finger();
    finish({Fault::implausible_speed});
    if (kIsSlow) return;
    if (!is_too_close_for(kWay, session_, window_)) continue;
    expect_undisturbed();
    return;
  }
  ADD_FAILURE() << "the machine never let 0.2 s pass without a pause";
}

TEST_P(HostInputAtEitherPace, ALastingJumpIsFollowedSlowlyAndWithoutForce) {
  start_host();
  const auto& jumped = [&](positions_t p, Sender& sender) {
    p.position_m[0] -= 5e-3;
    sender.publish(kPositionsChannel, p);
  };
  disturb(jumped, [&] { return is_off() && tells(device_->status().fault_bits_now, Fault::realigned); });
  finish({Fault::implausible_speed, Fault::realigned});
  // the simulated key never moved quicker than the piston on its way; 1 mm for its spring, and the two instants of a
  // view: 10 ms
  const action_state_t* last = nullptr;
  const test::Heard heard = device_->heard();
  for (const action_state_t& state : heard.states) {
    if (!window_.holds(state.device_time_ns)) continue;
    if (last != nullptr) {
      const double time = 1e-9 * static_cast<double>(state.device_time_ns - last->device_time_ns) + 0.01;
      EXPECT_LT(std::abs(state.key_position_m - last->key_position_m),
                session_.rendering().track.realign_speed * time + 1e-3);
    }
    last = &state;
  }
}

TEST_F(HostInput, AnotherTypeOnTheChannelIsNoPosition) {
  start_host();
  disturb(
      [](const positions_t& p, Sender& sender) {
        forces_t forces{};
        forces.sequence = p.sequence;
        sender.publish(kPositionsChannel, forces);
      },
      [&] { return is_off() && device_->status().dropped_wrong_type > 10; });
  finish({Fault::wrong_type, Fault::no_input});
  expect_faded();
}

TEST_F(HostInput, PositionsOfTheKeyAreNotTakenForThoseOfThePiston) {
  start_host();
  disturb(
      [](positions_t p, Sender& sender) {
        p.kind = positions_t::kKey;
        sender.publish(kPositionsChannel, p);
      },
      [&] { return is_off() && tells(device_->status().fault_bits_now, Fault::wrong_type); });
  finish({Fault::wrong_type, Fault::no_input});
  expect_faded();
}

TEST_F(HostInput, TruncatedAndOverlongMessagesAreNoPositions) {
  start_host();
  const RawSender raw(parse_lcm_address(kDeviceUrl));
  disturb(
      [&](const positions_t& p, Sender&) {
        std::string payload = test::encoded(p);
        payload.resize(static_cast<std::size_t>(p.sequence % 2 == 0 ? p.sequence % 740 : 742 + p.sequence % 2000), 'x');
        raw.send(lcm_datagram(kPositionsChannel, payload));
      },
      [&] { return is_off() && device_->status().dropped_wrong_size > 10; });
  finish({Fault::wrong_type, Fault::no_input});
  expect_faded();
}

TEST_F(HostInput, AnotherNumberOfKeysIsNoPosition) {
  start_host();
  disturb(
      [&](positions_t p, Sender& sender) {
        constexpr std::array counts{0, 2, 88, 89, -1, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
        p.key_count = counts[static_cast<std::size_t>(p.sequence) % counts.size()];
        sender.publish(kPositionsChannel, p);
      },
      [&] { return is_off() && device_->status().dropped_wrong_size > 10; });
  finish({Fault::wrong_size, Fault::no_input});
  expect_faded();
}

TEST_F(HostInput, TheFragmentsThatKillLcmsLibraryDoNothing) {
  start_host();
  const RawSender raw(parse_lcm_address(kDeviceUrl));
  const std::int64_t before = device_->status().dropped_by_kernel;
  disturb(
      [&](const positions_t& p, Sender& sender) {
        raw.send(lcm_fragment(100, 0, 0, 2, std::string(kPositionsChannel) + std::string(1, '\0') + "abc"));
        raw.send(lcm_fragment(100, 0xFFFFFFF0, 1, 2, std::string(40, 'x')));
        sender.publish(kPositionsChannel, p);
      },
      [&] { return device_->status().dropped_by_kernel >= before + 200; });
  trust_the_finger();
  finish({});
  expect_undisturbed();
}

TEST_F(HostInput, ASecondDeviceIsNotHeardWhileTheFirstSpeaks) {
  start_host();
  disturb(
      [](positions_t p, Sender& sender) {
        sender.publish(kPositionsChannel, p);
        p.publisher_id /= 2;
        p.sequence += 1000;
        p.position_m[0] = 2e-3;
        sender.publish(kPositionsChannel, p);
      },
      [&] { return device_->status().dropped_foreign_publisher > 200; });
  trust_the_finger();
  finish({Fault::foreign_publisher});
  expect_undisturbed();
}

}  // namespace
}  // namespace erard
