// erard-replay: publishes recorded key positions over LCM at their own pace, as a device would.
#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "erard/device/duration_histogram.hpp"
#include "erard/device/error.hpp"
#include "erard/device/link.hpp"
#include "erard/device/position_source.hpp"
#include "erard/device/verification.hpp"
#include "program.hpp"

namespace {

using namespace erard;

constexpr double kSlowestRate = 1, kFastestRate = 50000;  // [Hz]
constexpr double kSlowest = 0.01, kFastest = 100;         // times the recorded pace

std::atomic<bool> is_interrupted{false};

struct Options {
  std::string file, kind = "piston", url = kDeviceUrl, channel = kPositionsChannel;
  double speed = 1;
  std::optional<double> rate;
  std::optional<int> key, keys;
  std::optional<std::string> log_channel;
  bool is_loop = false, is_verification = false;
};

void add_options(CLI::App& app, Options& o) {
  app.add_option("FILE", o.file, "keystroke, CSV with t_s and position_m, or an LCM log that holds erard.positions_t")
      ->required();
  app.add_option("--speed", o.speed, "times the recorded pace, 0.01 to 100")->capture_default_str();
  app.add_option("--rate", o.rate, "of a keystroke: messages per second, 1 to 50000 (default: 2000)");
  app.add_option("--keys", o.keys, "of a keystroke: keys in each message, 1 to 88 (default: 1)");
  app.add_option("--key", o.key, "of a keystroke: the key that plays, 0 is the lowest (default: all of them)");
  app.add_option("--kind", o.kind,
                 "of a keystroke: piston: its positions are those of the free end of the finger's spring and damper; "
                 "key: of the key")
      ->check(CLI::IsMember({"piston", "key"}))
      ->capture_default_str();
  app.add_option("--log-channel", o.log_channel, "of a log: the channel to replay (default: that of --channel)");
  app.add_option("--url", o.url, "LCM address to publish to")->capture_default_str();
  app.add_option("--channel", o.channel, "LCM channel to publish on")->capture_default_str();
  app.add_flag("--loop", o.is_loop, "over and over, until Ctrl-C");
  CLI::Option* const verification = app.add_flag(
      "--verify", o.is_verification,
      "FILE is a recording of erard-device: publish nothing, compute its forces again from its positions and "
      "compare them to the bit");
  for (CLI::Option* const other : app.get_options())
    if (other->get_name().rfind("--", 0) == 0 && other != verification && other->get_name() != "--help" &&
        other->get_name() != "--version")
      verification->excludes(other);
}

template <typename Number>
Number in_range(const char* what, Number value, Number least, Number most) {
  if (!(value >= least && value <= most))
    throw InputError(fmt::format("{} = {}, must be {} to {}", what, value, least, most));
  return value;
}

std::unique_ptr<PositionSource> open_keystroke(const Options& o) {
  if (o.log_channel) throw InputError(fmt::format("--log-channel: {} is no LCM log, leave it out", o.file));
  Keystroke keystroke = read_keystroke(o.file);
  if (keystroke.quantity() != KeystrokeQuantity::position)
    throw InputError(fmt::format("{}: holds force_N, must hold position_m: a device measures positions", o.file));
  KeystrokeKeys keys;
  keys.kind = o.kind == "key" ? positions_t::kKey : positions_t::kPiston;
  keys.key_count = in_range("--keys", o.keys.value_or(1), 1, int{positions_t::kMaxKeys});
  if (o.key) keys.key = in_range("--key", *o.key, 0, keys.key_count - 1);
  const double rate = in_range("--rate", o.rate.value_or(2000), kSlowestRate, kFastestRate);
  // so many messages a second at any pace: faster means fewer samples of the same keystroke
  return std::make_unique<KeystrokeSource>(std::move(keystroke), o.speed / rate, keys);
}

std::unique_ptr<PositionSource> open_log(const Options& o) {
  if (o.rate || o.key || o.keys || o.kind != "piston")
    throw InputError(
        fmt::format("{}: is an LCM log, so --rate, --keys, --key and --kind are its own: leave them out", o.file));
  auto log = std::make_unique<LogSource>(o.file, o.log_channel.value_or(o.channel));
  if (log->is_cut_short()) fmt::print(stderr, "erard-replay: {}: ends within an event, which is left out\n", o.file);
  return log;
}

/// Sleeps until an instant of CLOCK_MONOTONIC, or a signal.
void sleep_until(std::int64_t instant_ns) {
  const timespec instant{instant_ns / 1'000'000'000, instant_ns % 1'000'000'000};
  while (!is_interrupted && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &instant, nullptr) == EINTR) {
  }
}

struct Tally {
  std::int64_t sent = 0, refused = 0;
  int keys = 0;  // of the last message
  std::int64_t start_ns = 0;
  DurationHistogram lateness;  // of a message against its instant [s]
};

/// Progress on a terminal, once it takes longer than two seconds.
class Progress {
 public:
  void show(const Tally& tally, std::int64_t now_ns, double left_s) {
    if (!is_terminal_ || now_ns - tally.start_ns < 2'000'000'000 || now_ns - shown_ns_ < 200'000'000) return;
    shown_ns_ = now_ns;
    fmt::print(stderr, "\r{} messages, {:.0f} s left   ", tally.sent, left_s);
    std::fflush(stderr);
  }
  ~Progress() {
    if (shown_ns_ > 0) fmt::print(stderr, "\r{:<40}\r", "");
  }

 private:
  std::int64_t shown_ns_ = 0;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
};

/// Publishes the source once. No message is left out: those that are late follow at once.
/// @param start  instant of its first message [ns]
void publish_once(const Options& o, PositionSource& source, std::int64_t start, Sender& sender, std::int64_t publisher,
                  Tally& tally, Progress& progress) {
  positions_t positions;
  std::int64_t time = 0;
  while (!is_interrupted && source.next(positions, time)) {
    const std::int64_t due = start + std::llround(static_cast<double>(time) / o.speed);
    sleep_until(due);
    if (is_interrupted) return;
    const std::int64_t now = monotonic_time_ns();
    positions.publisher_id = publisher;
    positions.sequence = tally.sent + tally.refused + 1;
    positions.device_time_ns = now;
    ++(sender.publish(o.channel.c_str(), positions) ? tally.sent : tally.refused);
    tally.keys = positions.key_count;
    tally.lateness.add(static_cast<double>(now - due) * 1e-9);
    progress.show(tally, now, static_cast<double>(source.duration_ns() - time) * 1e-9 / o.speed);
  }
}

void report(const Options& o, const Tally& tally) {
  const auto us = [&](double share) { return 1e6 * tally.lateness.quantile(share); };
  fmt::print("published    {} messages of {} keys in {:.3f} s, {} on {}\n", tally.sent, tally.keys,
             static_cast<double>(monotonic_time_ns() - tally.start_ns) * 1e-9, o.channel, o.url);
  fmt::print("late by      {:.0f} us at p50, {:.0f} us at p99, {:.0f} us at worst\n", us(0.5), us(0.99),
             1e6 * tally.lateness.worst());
  if (tally.refused > 0) fmt::print(stderr, "erard-replay: {} messages could not be sent\n", tally.refused);
}

int replay(const Options& o) {
  in_range("--speed", o.speed, kSlowest, kFastest);
  check_lcm_channel(o.channel);
  const std::unique_ptr<PositionSource> source = is_event_log(o.file) ? open_log(o) : open_keystroke(o);
  if (o.is_loop && source->duration_ns() == 0)
    throw InputError(fmt::format("{}: has one instant alone, must have two for --loop", o.file));
  Sender sender(o.url);
  const std::int64_t mean_interval = source->duration_ns() / std::max<std::int64_t>(source->message_count() - 1, 1);
  const auto round = std::llround(static_cast<double>(source->duration_ns() + mean_interval) / o.speed);

  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });
  prctl(PR_SET_TIMERSLACK, 1);  // [ns]; else the kernel may let an ordinary thread sleep 50 us longer
  const std::int64_t publisher = draw_publisher_id();
  Tally tally;
  tally.start_ns = monotonic_time_ns();
  Progress progress;
  std::int64_t start = tally.start_ns;
  do {
    publish_once(o, *source, start, sender, publisher, tally, progress);
    source->rewind();
    start += round;
  } while (o.is_loop && !is_interrupted);
  report(o, tally);
  if (std::fflush(stdout) != 0) throw std::runtime_error("the summary could not be written to the standard output");
  return is_interrupted ? kInterrupted : tally.refused > 0 ? kFailed : kDone;
}

/// Recomputes a recorded session. @return kFailed where a force differs
int verify(const Options& o) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });
  const std::int64_t start = monotonic_time_ns();
  std::int64_t shown = start;
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  const Verification v = verify_session(o.file, [&](const Verification& so_far) {
    if (is_terminal && so_far.periods % 1000 == 0 && monotonic_time_ns() - shown > 500'000'000) {
      shown = monotonic_time_ns();
      fmt::print(stderr, "\r{} periods", so_far.periods);
    }
    return !is_interrupted;
  });
  if (shown != start) fmt::print(stderr, "\r{:<30}\r", "");
  fmt::print("repeated     {} periods with {} messages{}\n", v.periods, v.messages,
             v.has_gap        ? ", up to where the recorder lost events"
             : v.is_cut_short ? ", up to where the file was cut short"
                              : "");
  if (v.first_difference >= 0)
    fmt::print(
        "differs      in {} periods, first in period {}: key {} recorded {} N, computed {} N; at most by {:.3g} N\n",
        v.differing, v.first_difference, v.key, v.recorded, v.computed, v.largest);
  if (is_interrupted) return kInterrupted;
  fmt::print("verdict      {}\n", v.is_same()      ? "the same forces, bit for bit"
                                  : v.periods == 0 ? "nothing to compare"
                                                   : "other forces");
  return v.is_same() ? kDone : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Publishes recorded key positions over LCM (erard.positions_t) at their own pace, as a device would; with "
      "--verify "
      "computes\na recorded session over again instead.",
      "erard-replay");
  app.footer(
      "Messages carry this program's own publisher_id, sequence and time. Exit codes: 0 done, 1 the run failed or a "
      "force\ndiffers, 2 bad input, 130 interrupted.");
  Options options;
  add_options(app, options);
  return run_program(app, argc, argv, [&] { return options.is_verification ? verify(options) : replay(options); });
}
