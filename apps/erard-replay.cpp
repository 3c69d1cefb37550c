// erard-replay: publishes recorded key positions over LCM at their own pace, as a device would.
#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
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
#include "erard/version.hpp"

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
  bool is_loop = false;
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
  const std::unique_ptr<PositionSource> source = is_lcm_log(o.file) ? open_log(o) : open_keystroke(o);
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
  return is_interrupted ? 130 : tally.refused > 0 ? 1 : 0;
}

/// A message on one line, whatever names it quotes.
void complain(std::string message) {
  for (char& c : message)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  fmt::print(stderr, "{}\n", message);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Publishes recorded key positions over LCM (erard.positions_t) at their own pace, as a device would.",
               "erard-replay");
  app.set_version_flag("--version", fmt::format("erard-replay {}", erard::kVersion));
  app.footer(
      "Messages carry this program's own publisher_id, sequence and time. Exit codes: 0 done, 1 the run failed, 2 bad "
      "input, 130 interrupted.");
  Options options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    complain(fmt::format("erard-replay: {}; see erard-replay --help", error.what()));
    return 2;
  }
  try {
    return replay(options);
  } catch (const erard::InputError& error) {
    complain(error.what());
    return 2;
  } catch (const std::exception& error) {
    complain(fmt::format("erard-replay: {}", error.what()));
    return 1;
  }
}
