// A loop finds its place behind another clock and holds it.
#include "erard/device/phase_lock.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "erard/device/periodic_loop.hpp"
#include "support/fake_clock.hpp"

namespace erard {
namespace {

using test::FakeClock;
using test::FakeTime;
using test::kT;
using test::kWork;
using test::us;

TEST(PhaseLock, MeasuresTheErrorWithinHalfAPeriod) {
  const PhaseLock lock({});  // 150 us behind
  for (const std::int64_t error : {0L, 1L, -1L, 249'999L, -250'000L})
    for (const std::int64_t periods : {-3L, 0L, 5L})
      EXPECT_EQ(lock.error(10 * kT + 150 * us + error + periods * kT, 10 * kT), error) << periods;
}

TEST(PhaseLock, NeverMovesTheGridFasterThanItsSlew) {
  const PhaseLock lock({.max_slew_ns = 700});
  for (std::int64_t due = 0; due < kT; due += 997) EXPECT_LE(std::abs(lock.shift(due, 123)), 700);
  EXPECT_EQ(lock.shift(150 * us + 200 * us, 0), -700);
  EXPECT_EQ(lock.shift(150 * us - 200 * us, 0), 700);
}

/// A publisher whose clock is off by `ppm`, seen with `jitter` after sending. @return error after that many periods [ns]
std::int64_t settled_error(double ppm, std::int64_t jitter, std::int64_t begins_off, int periods) {
  FakeTime time{3 * kT - 1, 0, {}, {}};
  PeriodicLoop<FakeClock> loop({.phase_ns = begins_off}, FakeClock{&time});
  const PhaseLock lock({});
  std::int64_t error = 0;
  loop.run([&](const Period& period) noexcept {
    const double published =
        std::round(static_cast<double>(period.number) * static_cast<double>(kT) * (1 + 1e-6 * ppm));
    const std::int64_t truth = 1000 * kT + static_cast<std::int64_t>(published);
    error = lock.error(period.due_ns, truth);
    loop.shift(lock.shift(period.due_ns, truth + (period.number * 7919) % (jitter + 1)));
    time.work(kWork, kWork);
    return period.number < periods;
  });
  return error;
}

TEST(PhaseLock, LeadsAGridPointOntoTheInstantItBelongsToHoweverFarAway) {
  const PhaseLock lock({500'000, 0});
  EXPECT_GT(lock.shift(300'000, 0), 0);       // the next instant of that clock is the nearer one
  EXPECT_LT(lock.shift_onto(300'000, 0), 0);  // this one is meant
  std::int64_t due = 400'000;
  for (int i = 0; i < 2000; ++i) due += lock.shift_onto(due, 0);
  EXPECT_LE(std::abs(due), 32);  // half of 1 / gain: less rounds to no shift
}

TEST(PhaseLock, BringsTheLoopToItsPlaceAndHoldsIt) {
  // rounding to whole ns stops the correction where gain * error < 1/2: 32 ns
  EXPECT_LE(std::abs(settled_error(0, 0, 40 * us, 2000)), 32);
  EXPECT_LE(std::abs(settled_error(0, 0, 399 * us, 2000)), 32);
}

TEST(PhaseLock, FollowsAClockThatDrifts) {
  // 20 ppm: 10 ns a period, which a gain of 1/64 holds with an error of 640 ns
  EXPECT_NEAR(static_cast<double>(settled_error(20, 0, 150 * us, 5000)), -640, 64);
  EXPECT_NEAR(static_cast<double>(settled_error(-20, 0, 150 * us, 5000)), 640, 64);
}

TEST(PhaseLock, AveragesArrivalsThatJitter) {
  // spread evenly over 40 us: it settles at their mean, 20 us late, within 40 us / sqrt(12) * sqrt(gain / 2) = 1 us of
  // averaged white noise (this sequence has less), three times over
  EXPECT_NEAR(static_cast<double>(settled_error(0, 40 * us, 150 * us, 20000)), 20e3, 3e3);
}

}  // namespace
}  // namespace erard
