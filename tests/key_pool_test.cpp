// Threads change nothing but the time that a period takes. Also run under the thread sanitizer.
#include <gtest/gtest.h>

#include <sched.h>

#include <system_error>

#include "erard/device/key_pool.hpp"
#include "support/scenes.hpp"

namespace erard {
namespace {

using test::Part;

/// CPUs this process may use, the first ones again where there are few.
std::vector<int> usable_cpus(std::size_t count) {
  cpu_set_t set;
  CPU_ZERO(&set);
  EXPECT_EQ(sched_getaffinity(0, sizeof set, &set), 0);
  std::vector<int> cpus;
  while (cpus.size() < count)
    for (int cpu = 0; cpu < CPU_SETSIZE && cpus.size() < count; ++cpu)
      if (CPU_ISSET(cpu, &set)) cpus.push_back(cpu);
  return cpus;
}

struct Pooled {
  const char* name;
  std::size_t workers;
  bool is_bound;
  double spin_time;
};
class KeyPools : public testing::TestWithParam<Pooled> {};
INSTANTIATE_TEST_SUITE_P(KeyPool, KeyPools,
                         testing::Values(Pooled{"none", 0, true, 5e-5}, Pooled{"one", 1, true, 5e-5},
                                         Pooled{"one_unbound", 1, false, 5e-5}, Pooled{"three", 3, true, 5e-5},
                                         Pooled{"more_than_keys", 9, false, 0}, Pooled{"two_that_sleep", 2, true, 0},
                                         Pooled{"one_that_spins", 1, true, 2e-3}),
                         [](const auto& one) { return one.param.name; });

TEST_P(KeyPools, GiveTheBitsOfOneThread) {
  const Pooled& pooled = GetParam();
  const Keystroke forte = test::keystroke("forte");
  const TickSettings settings = test::default_tick();
  const Model model = test::grand_action().model;
  Keyboard single(model, 7, settings), many(model, 7, settings);
  std::vector<int> cpus = usable_cpus(pooled.workers);
  if (!pooled.is_bound) cpus.assign(pooled.workers, KeyPool::kAnyCpu);
  KeyPool pool(many, cpus, pooled.spin_time);
  EXPECT_EQ(pool.thread_count(), static_cast<int>(pooled.workers) + 1);
  std::vector<Part> parts(7);
  for (std::size_t k = 0; k < 7; ++k)
    if (k % 3 != 1) parts[k] = {&forte, 0.004 * double(k)};
  std::vector<DriveSample> inputs;
  for (int i = 0; i < 250; ++i) {
    test::sample(parts, single, inputs);
    const auto truth = single.tick(inputs), forces = pool.tick(inputs);
    for (std::size_t k = 0; k < 7; ++k) ASSERT_EQ(forces[k], truth[k]) << "key " << k << ", period " << i;
  }
  for (int k = 0; k < 7; ++k) {
    EXPECT_EQ(many.state(k).x, single.state(k).x);
    EXPECT_EQ(many.state(k).impulse, single.state(k).impulse);
    EXPECT_EQ(many.is_asleep(k), single.is_asleep(k));
  }
  EXPECT_EQ(many.asleep_count(), 2);
}

TEST(KeyPool, RestsForManyShortPeriods) {
  // nothing to do but to begin and to end: where a lost wake-up would hang
  Keyboard keyboard(test::grand_action().model, 3, test::default_tick());
  KeyPool pool(keyboard, {KeyPool::kAnyCpu, KeyPool::kAnyCpu}, 0);
  const std::vector<DriveSample> inputs(3);
  for (int i = 0; i < 5000; ++i) pool.tick(inputs);
  EXPECT_EQ(keyboard.asleep_count(), 3);
  EXPECT_EQ(keyboard.time(), 5000 * keyboard.settings().period);
}

TEST(KeyPool, EndsWithoutHavingBegun) {
  Keyboard keyboard(test::grand_action().model, 2, test::default_tick());
  const KeyPool pool(keyboard, {KeyPool::kAnyCpu, KeyPool::kAnyCpu}, 0);
  EXPECT_EQ(pool.thread_count(), 3);
}

TEST(KeyPool, RefusesACpuThatIsNotThere) {
  Keyboard keyboard(test::grand_action().model, 2, test::default_tick());
  for (const int cpu : {-2, CPU_SETSIZE - 1, CPU_SETSIZE})
    EXPECT_THROW(KeyPool(keyboard, {KeyPool::kAnyCpu, cpu}), std::system_error) << cpu;
  keyboard.tick(std::vector<DriveSample>(2));  // and is free again
}

}  // namespace
}  // namespace erard
