// What the machine does to the running host: it stops it, its disk is full, it refuses the network or real time.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

#include "erard/device/verification.hpp"
#include "support/host_test.hpp"

namespace erard {
namespace {

using test::Child;
using test::eventually;
using test::tells;

using HostMachine = test::DisturbedHost;

TEST_F(HostMachine, AStoppedHostLeavesNoForceThatHoldsAndGoesOnByItself) {
  start_host();
  press();
  window_.from = monotonic_time_ns();
  host_->send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_LT(device_->force().valid_until_ns, monotonic_time_ns());
  EXPECT_LT(device_->force().valid_until_ns - device_->force().device_time_ns, 20'000'000);
  host_->send(SIGCONT);
  EXPECT_TRUE(eventually([&] { return tells(device_->status().fault_bits_ever, Fault::no_input); }));
  end_disturbance();
  finish({Fault::period_missed, Fault::no_input});
  expect_key_stays_down(window_);
  // the device has let go meanwhile: the first force afterwards is zero, not a blow
  const std::vector<forces_t>& forces = device_->heard().forces;
  const auto back = std::adjacent_find(forces.begin(), forces.end(), [](const forces_t& a, const forces_t& b) {
    return a.device_time_ns > 0 && b.device_time_ns - a.device_time_ns > 200'000'000;  // the very first has no time
  });
  ASSERT_NE(back, forces.end());
  EXPECT_GT(back->force_N[0], 1);
  EXPECT_EQ(std::next(back)->force_N[0], 0);
}

TEST_F(HostMachine, AFullDiskEndsTheRecordingAndNothingElse) {
  constexpr rlim_t kRoom = 400'000;  // [B] for the first tenth of a second
  start({"--faults", ""}, {.prepare = [] {
          const rlimit room{kRoom, kRoom};
          return setrlimit(RLIMIT_FSIZE, &room) == 0;
        }});
  press();
  EXPECT_TRUE(eventually([&] { return tells(device_->status().fault_bits_now, Fault::recording_stopped); }));
  release_and_play_again();
  const test::Outcome outcome = stop();
  expect_named(Fault::recording_stopped, outcome);
  EXPECT_NE(outcome.out.find("; stopped: "), std::string::npos) << outcome.out;
  test::expect_safe(device_->heard().forces, GuardSettings{});
  ASSERT_EQ(device_->heard().blows.size(), 2u);
  // what was written is whole
  EXPECT_LE(test::fs::file_size(log()), kRoom);
  const Verification verified = verify_session(log(), [](const Verification&) { return true; });
  EXPECT_TRUE(verified.is_same());
  EXPECT_TRUE(verified.is_cut_short);
  EXPECT_GT(verified.periods, 50);
}

TEST_F(HostMachine, ARouteThatIsTakenAwayAndGivenBackIsFoundAgain) {
  start_host();
  press();
  window_.from = monotonic_time_ns();
  ASSERT_TRUE(test::set_multicast_route(false));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  ASSERT_TRUE(test::set_multicast_route(true));
  EXPECT_TRUE(eventually([&] { return tells(device_->status().fault_bits_ever, Fault::publish_failed); }));
  end_disturbance();
  finish({Fault::publish_failed, Fault::no_input});
  expect_faded();
}

TEST(HostWithoutRoute, SaysHowToMakeOne) {
  if (const std::string refused = test::enter_own_network(false); !refused.empty()) GTEST_SKIP() << refused;
  Child host("erard-device", {"--best-effort"});
  const test::Outcome outcome = host.wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  EXPECT_NE(outcome.error.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos) << outcome.error;
}

#ifdef __has_feature  // clang
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1  // as g++ says it
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
constexpr bool kMemoryLockIsReal = false;  // the sanitizer says yes to mlockall() and does nothing
#else
constexpr bool kMemoryLockIsReal = true;
#endif

/// In place of a user to whom nothing was granted.
bool give_up_privileges() {
  constexpr uid_t kNobody = 65534;
  const rlimit none{0, 0}, little{65536, 65536};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &little) != 0) return false;
  return geteuid() != 0 || (setgid(kNobody) == 0 && setuid(kNobody) == 0);
}

TEST_F(HostMachine, WithoutPrivilegesItRefusesAndSaysWhatHelps) {
  Child host("erard-device", {}, {.prepare = give_up_privileges});
  const test::Outcome outcome = host.wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  EXPECT_NE(outcome.error.find("--best-effort"), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.out.find("rtprio 80"), std::string::npos) << outcome.out;  // the line for limits.d
  EXPECT_EQ(outcome.out.find("memlock unlimited") != std::string::npos, kMemoryLockIsReal) << outcome.out;
}

TEST_F(HostMachine, WithoutPrivilegesItCarriesOnWhenTold) {
  start_as({"--best-effort", "--faults", ""}, {.prepare = give_up_privileges});
  press();
  const host_status_t status = device_->status();
  EXPECT_EQ(status.realtime_priority, 0);
  EXPECT_EQ(status.memory_locked == 0, kMemoryLockIsReal);
  release_and_play_again();
  const test::Outcome outcome = stop();
  EXPECT_NE(outcome.out.find("without real time"), std::string::npos) << outcome.out;
  test::expect_safe(device_->heard().forces, GuardSettings{});
  EXPECT_GE(device_->heard().blows.size(), 1u);
}

}  // namespace
}  // namespace erard
