// The observer that knows the device's own force.
#include "study/lever_observer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "erard/haptics/velocity.hpp"
#include "support/heap_calls.hpp"

namespace erard::study {
namespace {

constexpr double kPeriod = 5e-4;  // [s]

TEST(LeverObserver, WithoutCommandsIsTheFadingParabola) {
  LeverObserver observer({0.1, 0.7, 1, 3e-4, 0}, kPeriod);
  LeverObserver at_once({0.1, 0.7, 0, 3e-4, 0}, kPeriod);
  FadingPolynomial parabola(kPeriod, 0.7, 2);
  for (int i = 0; i < 200; ++i) {
    const double y = 1e-3 * std::sin(0.05 * i);
    const double expected = parabola.update(y);
    EXPECT_NEAR(at_once.update(y).rate, expected, 1e-12) << i;  // rounding of another order of sums
    at_once.sent(0);
    observer.update(y);
    observer.sent(0);
  }
}

/// A free lever under pushes only, exactly: steps of held commands, each n periods late; no lag.
struct FreeLever {
  double mass;
  double y = 0, v = 0;
  void advance(double push) {
    y += kPeriod * v - push / mass * kPeriod * kPeriod / 2;
    v -= push / mass * kPeriod;
  }
};

TEST(LeverObserver, FollowsItsOwnForceWithoutAnyMiss) {
  // what it commands is all that acts: it must know position and rate ahead, to rounding, from the first sample on
  for (const int delay : {0, 1, 2}) {
    LeverObserver observer({0.06, 0.9, delay, 0, 0}, kPeriod);
    FreeLever lever{0.06};
    double command[300] = {};
    for (int k = 0; k < 200; ++k) {
      const DriveSample ahead = observer.update(lever.y);
      FreeLever then = lever;
      for (int i = 0; i < delay; ++i) then.advance(k - delay + i >= 0 ? command[k - delay + i] : 0);
      EXPECT_NEAR(ahead.value, then.y, 1e-12) << delay << ' ' << k;
      EXPECT_NEAR(ahead.rate, then.v, 1e-9) << delay << ' ' << k;
      command[k] = std::sin(0.3 * k);
      observer.sent(command[k]);
      lever.advance(k >= delay ? command[k - delay] : 0);
    }
  }
}

TEST(LeverObserver, FindsTheForceThatItWasNotTold) {
  LeverObserver observer({0.1, 0.7, 1, 0, 0}, kPeriod);
  FreeLever lever{0.1};
  for (int k = 0; k < 200; ++k) {
    observer.update(lever.y);
    observer.sent(0);
    lever.advance(-2);  // the finger, 2 N down
  }
  EXPECT_NEAR(observer.unknown(), 20, 1e-6);  // what memory 0.7 leaves of the start after 200 samples is nothing
}

TEST(LeverObserver, LagOfTheActuatorIsTheExponentialOfAHeldCommand) {
  // a lever that never moves under a constant command: the unknown must balance the force that has settled
  LeverObserver observer({0.1, 0.7, 1, 3e-4, 0}, kPeriod);
  for (int k = 0; k < 400; ++k) {
    observer.update(0);
    observer.sent(3);
  }
  EXPECT_NEAR(observer.unknown(), 30, 1e-6);
  EXPECT_NEAR(observer.update(0).rate, 0, 1e-9);
}

TEST(LeverObserver, TakesNoHeap) {
  LeverObserver observer({}, kPeriod);
  const long before = heap_calls;
  for (int i = 0; i < 100; ++i) {
    observer.update(1e-6 * i);
    observer.sent(0.1 * i);
  }
  EXPECT_EQ(heap_calls, before);
}

}  // namespace
}  // namespace erard::study
