// The running host with a library put under it that sees what its real-time loop calls.
#include <cmath>
#include <ctime>
#include <sstream>

#include "support/host_test.hpp"

namespace erard {
namespace {

using test::eventually;
using test::read_text;
using test::run_program;

/// Calls as a witness has counted them.
struct Testimony {
  long elsewhere = -1, in_loop = -1, behind_loop = -1;
};

Testimony testimony(const std::string& what, const test::fs::path& file) {
  std::istringstream lines(read_text(file));
  Testimony found;
  for (std::string word; lines >> word;) {
    Testimony one;
    lines >> one.elsewhere >> one.in_loop >> one.behind_loop;
    if (word == what) found = one;
  }
  return found;
}

/// The host under a witness, at either pace.
class HostWitness : public test::DisturbedHost, public testing::WithParamInterface<const char*> {
 protected:
  const char* pace() const override { return GetParam(); }
  void start_under(const char* witness) {
    start({"--pace", pace()},
          {.environment = {std::string("LD_PRELOAD=") + witness, "ERARD_WITNESS=" + witness_.string()}});
  }

  test::TemporaryFolder witness_folder_;
  test::fs::path witness_ = witness_folder_ / "witness";
};

INSTANTIATE_TEST_SUITE_P(Pace, HostWitness, testing::Values("clock", "messages"),
                         [](const auto& suite) { return std::string(suite.param); });

TEST_P(HostWitness, TheLoopNeverTouchesTheHeapWhateverComes) {
  start_under(ERARD_HEAP_WITNESS);
  disturb(
      [](positions_t p, Sender& sender) {  // a bit of everything that a period has to deal with
        if (p.sequence / 64 % 4 == 0) return;
        if (p.sequence % 16 == 0) p.position_m[0] = std::nan("");
        if (p.sequence % 17 == 0) p.position_m[0] -= 5e-3;
        sender.publish(kPositionsChannel, p);
        if (p.sequence % 18 == 0) sender.publish(kPositionsChannel, p);
        if (p.sequence % 19 == 0) sender.publish(kPositionsChannel, forces_t{});
        p.publisher_id /= 2;
        if (p.sequence % 20 == 0) sender.publish(kPositionsChannel, p);
      },
      [&] {
        const auto all = Fault::no_input | Fault::not_finite_input | Fault::implausible_speed | Fault::duplicate |
                         Fault::wrong_type | Fault::foreign_publisher;
        return (static_cast<Fault>(device_->status().fault_bits_ever) & all) == all;
      });
  finish({Fault::no_input, Fault::not_finite_input, Fault::implausible_speed, Fault::duplicate, Fault::wrong_type,
          Fault::foreign_publisher});
  const Testimony heap = testimony("heap", witness_);
  EXPECT_EQ(heap.in_loop, 0);
  EXPECT_GT(heap.behind_loop, 0);  // the same thread is seen as soon as it may
  EXPECT_GT(heap.elsewhere, 1000);
}

TEST_P(HostWitness, TheTimeOfDayMayBeSetAndNobodyNotices) {
  start_under(ERARD_WALL_CLOCK_WITNESS);
  const std::int64_t begin = monotonic_time_ns();
  disturb([](const positions_t& p, Sender& sender) { sender.publish(kPositionsChannel, p); },
          [&] { return monotonic_time_ns() - begin > 500'000'000; });  // several steps of it
  trust_the_finger();
  finish({});
  expect_undisturbed();
  const Testimony wall = testimony("wall", witness_), monotonic = testimony("monotonic", witness_);
  EXPECT_EQ(wall.in_loop, 0);
  EXPECT_LT(wall.elsewhere, 10);  // libraries as they start; over a second, the display and the writer would be more
  EXPECT_GT(monotonic.in_loop, static_cast<long>(session_.periods.size()));  // it is the loop that was watched
}

TEST(WallClockWitness, SetsTheClockOfAProgramThatLooksAtIt) {
  const test::TemporaryFolder folder;
  const std::string witness = folder / "witness";
  const std::string command = "env LD_PRELOAD=" ERARD_WALL_CLOCK_WITNESS " ERARD_WITNESS=" + witness + " date +%s";
  std::FILE* const pipe = popen(command.c_str(), "r");
  long told = 0;
  EXPECT_EQ(std::fscanf(pipe, "%ld", &told), 1);
  pclose(pipe);
  EXPECT_NEAR(std::abs(static_cast<double>(told - std::time(nullptr))), 3600, 60);
  EXPECT_GE(testimony("wall", witness).elsewhere, 1);
}

}  // namespace
}  // namespace erard
