#include "bench/targets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/results.hpp"

namespace erard::bench {
namespace {

constexpr double kMicro = 1e6;
constexpr double kMainRate_Hz = 2000, kSharedRate_Hz = 10000, kFastRate_Hz = 50000;
constexpr int kLargeKeyboard = 88;

/// The figure of one row, as measured and undisturbed.
using Figure = std::function<double(const Row&, const Distribution& tick)>;

double median_us(const Row&, const Distribution& tick) { return kMicro * tick.median; }
double p99_us(const Row&, const Distribution& tick) { return kMicro * tick.p99; }
double tail_us(const Row&, const Distribution& tick) { return kMicro * tick.tail(); }
double median_us_a_key(const Row& row, const Distribution& tick) { return kMicro * tick.median / row.keys; }

const char* const kStrokes[] = {"piano", "forte", "repetition", "recorded_fast"};

/// Adds one row to a claim about the worst of several.
void take(Target& target, const Row* row, const Figure& figure) {
  if (row == nullptr) return;
  const double measured = figure(*row, row->tick);
  target.undisturbed = std::fmax(target.undisturbed, figure(*row, row->undisturbed));  // of NaN and a number the number
  if (measured <= target.measured) return;
  target.measured = measured;
  target.where = row->scene;
}

/// The worst of all strokes on one key, cheapest.
Target of_strokes(const std::vector<Row>& rows, const std::string& claim, double limit, double rate_Hz,
                  const Figure& figure) {
  Target target{claim, limit, "us"};
  for (const char* stroke : kStrokes) take(target, find_row(rows, {stroke, 1, rate_Hz, "cheapest"}), figure);
  return target;
}

Target of_keyboard(const std::vector<Row>& rows, const std::string& claim, double limit, const RowKey& key,
                   const Figure& figure) {
  Target target{claim, limit, "us"};
  take(target, find_row(rows, key), figure);
  return target;
}

/// The peer with the same steps beside each stroke.
Target against_peer(const std::vector<Row>& rows) {
  Target target{"one key, strokes: median step, times that of MuJoCo", 0.25, "times"};
  for (const char* stroke : kStrokes) {
    const Row* ours = find_row(rows, {stroke, 1, kMainRate_Hz, "cheapest"});
    const Row* peer = find_row(rows, {stroke, 1, kMainRate_Hz, "cheapest", 1, Engine::mujoco});
    if (ours == nullptr || peer == nullptr) continue;
    take(target, ours, [&](const Row&, const Distribution& tick) {
      const bool is_measured = &tick == &ours->tick;
      return tick.median / (is_measured ? peer->tick : peer->undisturbed).median;
    });
  }
  return target;
}

/// A key at rest that is not left alone beside the quickest stroke: waking has no price of its own.
Target awake_at_rest(const std::vector<Row>& rows) {
  Target target{"one key at rest, awake: median step, times that of the quickest stroke", 1, "times"};
  const Row* rest = find_row(rows, {"rest", 1, kMainRate_Hz, "cheapest"});
  if (rest == nullptr) return target;
  for (const char* stroke : kStrokes) {
    const Row* row = find_row(rows, {stroke, 1, kMainRate_Hz, "cheapest"});
    if (row == nullptr) continue;
    take(target, row, [&](const Row&, const Distribution& tick) {
      return (&tick == &row->tick ? rest->tick : rest->undisturbed).median / tick.median;
    });
  }
  return target;
}

}  // namespace

bool Target::is_measured() const { return !std::isnan(measured); }
bool Target::is_met() const { return measured <= limit; }
bool Target::is_met_undisturbed() const { return undisturbed <= limit; }

std::string verdict(const Target& target) {
  if (!target.is_measured()) return "not measured";
  if (target.is_met()) return "met";
  return target.is_met_undisturbed() ? "missed (met undisturbed)" : "missed";
}

std::string resting_line(const std::vector<Row>& rows) {
  const Row* awake = find_row(rows, {"rest", 1, kMainRate_Hz, "cheapest"});
  const Row* asleep = find_row(rows, {"keyboard_none", kLargeKeyboard, kMainRate_Hz, "cheapest"});
  std::string text;
  if (awake != nullptr) text += fmt::format(" {} us awake (rest)", three_digits(kMicro * awake->tick.median));
  if (asleep != nullptr)
    text += fmt::format("{} {} us {} (one of {})", text.empty() ? "" : ",",
                        three_digits(kMicro * asleep->tick.median / asleep->keys),
                        asleep->may_sleep ? "left alone" : "with sleep off", asleep->keys);
  return text.empty() ? text : fmt::format("A key at rest takes{} a period, median.\n", text);
}

std::vector<Target> targets_of(const std::vector<Row>& rows) {
  const RowKey all{"keyboard_all", kLargeKeyboard, kMainRate_Hz, "cheapest"};
  const RowKey all_default{"keyboard_all", kLargeKeyboard, kMainRate_Hz, "default"};
  const RowKey some{"keyboard_some", kLargeKeyboard, kMainRate_Hz, "cheapest"};
  const RowKey none{"keyboard_none", kLargeKeyboard, kMainRate_Hz, "cheapest"};
  const RowKey shared{"keyboard_all", kLargeKeyboard, kSharedRate_Hz, "cheapest", 2};
  return {
      against_peer(rows),
      of_strokes(rows, "one key, strokes: p99 of a step", 4, kMainRate_Hz, p99_us),
      awake_at_rest(rows),
      of_keyboard(rows, "88 keys all played, cheapest: median", 130, all, median_us),
      of_keyboard(rows, "88 keys all played, cheapest: p99.9", 250, all, tail_us),
      of_keyboard(rows, "88 keys all played, default: p99.9", 400, all_default, tail_us),
      of_keyboard(rows, "88 keys, 8 of them played, cheapest: median", 40, some, median_us),
      of_keyboard(rows, "a key at rest, one of 88: median", 0.1, none, median_us_a_key),
      of_strokes(rows, "one key at 50 kHz: p99.9, against the period", kMicro / kFastRate_Hz, kFastRate_Hz, tail_us),
      of_keyboard(rows, "88 keys all played at 10 kHz on two threads: p99.9, against the period",
                  kMicro / kSharedRate_Hz, shared, tail_us)};
}

}  // namespace erard::bench
