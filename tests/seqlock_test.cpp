// What one thread writes and another reads is whole. Also run under the thread sanitizer, which sees what luck hides.
#include "erard/device/seqlock.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "erard/device/shared_histogram.hpp"

namespace erard {
namespace {

/// Every member tells the same number; not a multiple of a word long, and long enough to be met half-written.
struct Value {
  std::int64_t number = 0;
  std::int32_t copies[511] = {};
  char last = 0;
};

Value value_of(std::int64_t number) {
  Value value;
  value.number = number;
  for (std::int32_t& copy : value.copies) copy = static_cast<std::int32_t>(number);
  value.last = static_cast<char>(number % 100);
  return value;
}

void expect_whole(const Value& value) {
  for (const std::int32_t copy : value.copies) ASSERT_EQ(copy, static_cast<std::int32_t>(value.number));
  ASSERT_EQ(value.last, static_cast<char>(value.number % 100));
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
  std::atomic<int> readers{2};
  const auto read = [&] {
    std::int64_t last = 0;
    for (int i = 0; i < 20'000 && !testing::Test::HasFailure(); ++i) {
      const Value value = shared.load();
      expect_whole(value);
      EXPECT_GE(value.number, last);
      last = value.number;
    }
    --readers;
  };
  std::thread first(read), second(read);
  for (std::int64_t i = 1; readers > 0; ++i) {
    shared.store(value_of(i));
    if (i % 16 == 0) std::this_thread::yield();  // who stores without a pause leaves no time to load
  }
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
