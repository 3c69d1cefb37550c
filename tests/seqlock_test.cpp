// What one thread writes and another reads is whole. Also run under the thread sanitizer, which sees what luck hides.
#include "erard/device/seqlock.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "erard/device/shared_histogram.hpp"

namespace erard {
namespace {

/// Not a multiple of a word long; every member tells the same number.
struct Value {
  std::int64_t number = 0;
  double doubled = 0;
  std::int32_t copies[7] = {};
  char last = 0;
};

Value value_of(std::int64_t number) {
  Value value{number, 2.0 * static_cast<double>(number), {}, static_cast<char>(number % 100)};
  for (std::int32_t& copy : value.copies) copy = static_cast<std::int32_t>(number);
  return value;
}

void expect_whole(const Value& value) {
  const Value truth = value_of(value.number);
  ASSERT_EQ(value.doubled, truth.doubled);
  for (int i = 0; i < 7; ++i) ASSERT_EQ(value.copies[i], truth.copies[i]);
  ASSERT_EQ(value.last, truth.last);
}

TEST(Seqlock, GivesBackWhatWasStoredLast) {
  Seqlock<Value> shared;
  expect_whole(shared.load());
  EXPECT_EQ(shared.load().number, 0);
  for (const std::int64_t number : {1, 2, 77}) {
    shared.store(value_of(number));
    expect_whole(shared.load());
    EXPECT_EQ(shared.load().number, number);
  }
}

TEST(Seqlock, ReadersSeeWholeValuesThatNeverGoBack) {
  Seqlock<Value> shared;
  constexpr std::int64_t kStores = 200'000;
  std::atomic<int> readers_begun{0};
  const auto read = [&] {
    ++readers_begun;
    std::int64_t last = 0;
    while (last < kStores) {
      const Value value = shared.load();
      expect_whole(value);
      ASSERT_GE(value.number, last);
      last = value.number;
    }
  };
  std::thread first(read), second(read);
  while (readers_begun < 2) std::this_thread::yield();
  for (std::int64_t i = 1; i <= kStores; ++i) shared.store(value_of(i));
  first.join();
  second.join();
}

TEST(SharedHistogram, IsReadWhileItIsFilled) {
  SharedHistogram shared;
  constexpr long kAdded = 20'000;
  std::thread writer([&] {
    for (long i = 0; i < kAdded; ++i) shared.add(1e-6 * static_cast<double>(1 + i % 100));
  });
  for (long seen = 0; seen < kAdded;) {
    const long now = shared.snapshot().total();
    ASSERT_GE(now, seen);
    seen = now;
  }
  writer.join();
  const DurationHistogram all = shared.snapshot();
  EXPECT_EQ(all.total(), kAdded);
  EXPECT_NEAR(all.quantile(0.5), 50e-6, 0.01 * 50e-6);  // bins are 1 % wide
  EXPECT_DOUBLE_EQ(all.worst(), 100e-6);
}

}  // namespace
}  // namespace erard
