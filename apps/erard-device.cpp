// erard-device: the real-time host. Positions of keys come in over LCM, forces go out.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "erard/device/config_dir.hpp"
#include "erard/device/host.hpp"
#include "erard/device/session.hpp"
#include "program.hpp"
#ifdef ERARD_WITH_LANES
#include "erard/lanes/key_lanes.hpp"
#endif

namespace {

using namespace erard;

std::atomic<bool> is_interrupted{false};

struct Options {
  std::string device, action, damper = "on", pace = "clock", record, fault_folder = "erard-faults";
  DeviceOverrides overrides;
  std::optional<double> duration;
  bool is_best_effort = false;
};

void add_options(CLI::App& app, Options& o) {
  app.add_option("--device", o.device, "how the device is rendered (default: config/device.yaml)");
  app.add_option("--action", o.action, "action of every key (default: config/grand_action.yaml)");
  app.add_option("--keys", o.overrides.keys, "number of keys, 1 to 88 (default: that of the device file)");
  app.add_option("--rate", o.overrides.rate_Hz, "periods per second, 400 to 50000 (default: that of the device file)");
  app.add_option("--drive", o.overrides.drive,
                 "piston: positions are those of the coupling's free end; key: of the key itself (default: that of the "
                 "device file)")
      ->check(CLI::IsMember({"piston", "key"}));
  app.add_option("--actuator", o.overrides.actuator,
                 "voice-coil, mr or none: whose currents and limits (default: that of the device file)");
  app.add_option("--damper", o.damper, "on: the whole action; off: the damper is clamped")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--pace", o.pace,
                 "clock: periods of the host's own clock, kept at a fixed delay behind the device; messages: a period "
                 "begins when positions arrive")
      ->check(CLI::IsMember({"clock", "messages"}))
      ->capture_default_str();
  app.add_flag("--best-effort", o.is_best_effort, "run without real time where the machine refuses it");
  app.add_option("--record", o.record,
                 "keep the whole session in this file, an LCM log; erard-replay --verify repeats it");
  app.add_option(
         "--faults", o.fault_folder,
         "folder for the last seconds before each fault, LCM logs; made when needed; an empty name: none are kept")
      ->capture_default_str();
  app.add_option("--duration", o.duration, "end after so many seconds, at most 1e6 (default: at Ctrl-C)");
}

/// To the person at the screen. That may be gone: the host does not stop for it.
template <typename... Args>
void say(std::FILE* where, fmt::format_string<Args...> words, Args&&... args) {
  const std::string text = fmt::format(words, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), where);
}

std::string names_of(Fault faults) {
  std::string text;
  for (int i = 0; i < kFaultCount; ++i)
    if (has(faults, static_cast<Fault>(1u << i))) text += fmt::format("{}{}", text.empty() ? "" : ", ", fault_name(i));
  return text;
}

/// Lines of faults as they come and go, and on a terminal one that lives.
class Display {
 public:
  void show(const Host& host, double elapsed) {
    const HostNews news = host.news();
    const Fault now = news.has_input ? news.now & kTold : Fault::none;
    if (news.has_input && !had_input_) line(elapsed, "positions arrive");
    had_input_ = news.has_input;
    if (const Fault begun = now & ~before_; begun != Fault::none) line(elapsed, names_of(begun));
    if (const Fault gone = before_ & ~now; gone != Fault::none) line(elapsed, "over: " + names_of(gone));
    before_ = now;
    if (!is_terminal_) return;
    const LoopStatus loop = host.loop();
    say(stderr, "\r{:8.1f} s  {} periods  {} missed  {} blows  {} asleep  woke {:.0f} us late, worked {:.0f} us  ",
        elapsed, loop.periods, loop.missed, news.blows, news.asleep, 1e-3 * static_cast<double>(loop.last_lateness_ns),
        1e-3 * static_cast<double>(loop.last_work_ns));
    std::fflush(stderr);
  }
  ~Display() {
    if (is_terminal_) say(stderr, "\n");
  }

 private:
  /// What a person should hear of at once; the others stand in the status messages and in the report.
  static constexpr Fault kTold =
      ~(Fault::step_not_converged | Fault::coarser_steps | Fault::slew_limited | Fault::gap | Fault::realigned);

  void line(double elapsed, const std::string& text) const {
    say(stderr, "{}{:8.1f} s  {}\n", is_terminal_ ? "\r\033[K" : "", elapsed, text);
  }

  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  bool had_input_ = false;
  Fault before_ = Fault::none;
};

std::string quantiles(const DurationHistogram& h) {
  if (h.total() == 0) return "-";
  return fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, max {:.1f} us", 1e6 * h.quantile(0.5),
                     1e6 * h.quantile(0.99), 1e6 * h.quantile(0.999), 1e6 * h.worst());
}

void report(const Host& host, const LoopSummary& run, double elapsed) {
  const LoopStatus& loop = run.status;
  const HostNews news = host.news();
  const ReceiverCounts received = host.received();
  const double periods = static_cast<double>(std::max<std::int64_t>(loop.periods, 1));
  say(stdout, "\nperiods          {} of {:.0f} us in {:.1f} s, {} left out\n", loop.periods,
      1e-3 * static_cast<double>(std::llround(1e9 * host.settings().rendering.tick.period)), elapsed, loop.skipped);
  say(stdout, "missed           {}: woke late {}, interrupted {}, worked long {}\n", loop.missed,
      loop.missed_by(MissCause::woke_late), loop.missed_by(MissCause::interrupted),
      loop.missed_by(MissCause::worked_long));
  say(stdout, "wake-up          {}\n", quantiles(host.wake_lateness()));
  say(stdout, "work             {}\n", quantiles(host.work_time()));
  say(stdout, "sample to force  {}\n", quantiles(host.latency()));
  say(stdout, "page faults      {} minor, {} major; {} involuntary switches\n", run.usage.minor_faults,
      run.usage.major_faults, run.usage.involuntary_switches);
  say(stdout,
      "positions        {} used, {} lost on the way, {} of another type or size, {} overflowed, {} dropped by the "
      "kernel\n",
      news.accepted, news.lost, received.wrong_type + received.wrong_size, received.overflow, host.dropped_by_kernel());
  say(stdout, "blows            {}, the last at {:.2f} m/s\n", news.blows, news.last_blow_speed);
  say(stdout, "force            largest {:.2f} N, largest change in a period {:.3f} N\n", news.largest_force,
      news.largest_change);
  say(stdout,
      "periods with     passivity {:.3f} %, force limit {:.3f} %, slew limit {:.3f} %, actuator limit {:.3f} %\n",
      100 * static_cast<double>(news.passivity_periods) / periods,
      100 * static_cast<double>(news.force_limit_periods) / periods,
      100 * static_cast<double>(news.slew_limit_periods) / periods,
      100 * static_cast<double>(news.actuator_limit_periods) / periods);
  const RecorderStatus recorder = host.recorder();
  if (recorder.events > 0 || !recorder.trouble.empty())
    say(stdout, "recorded         {} messages, {} bytes, {} lost{}\n", recorder.events, recorder.bytes, recorder.lost,
        recorder.trouble.empty() ? "" : "; stopped: " + recorder.trouble);
  if (recorder.faults_saved > 0) say(stdout, "faults saved     {} files\n", recorder.faults_saved);
  say(stdout, "faults           {}\n", news.ever == Fault::none ? "none" : "");
  for (int i = 0; i < kFaultCount; ++i) {
    if (!has(news.ever, static_cast<Fault>(1u << i))) continue;
    say(stdout, "  {:<19} began {} times\n", fault_name(i), news.begun[static_cast<std::size_t>(i)]);
  }
}

/// What the parser does not see: NaN is no number to it, and no file has an empty name.
void check(const CLI::App& app, const Options& o) {
  constexpr double kLongest = 1e6;  // [s] 11 days; a time point counts to 292 years
  if (o.duration && !(*o.duration > 0 && *o.duration <= kLongest))
    throw InputError(fmt::format("--duration = {}, must be above 0 and at most {} s", *o.duration, kLongest));
  if (app.count("--record") > 0 && o.record.empty()) throw InputError("--record: its name is empty, name a file");
}

/// Many keys go together in the lanes of vector registers, where this build has them; the forces are the same to the bit.
MakePlayer player_for([[maybe_unused]] int keys) {
#ifdef ERARD_WITH_LANES
  constexpr int kWorthIt = 8;  // keys: below, lanes are mostly empty
  if (keys >= kWorthIt) return [](Keyboard& keyboard) { return std::make_unique<KeyLanes>(keyboard); };
#endif
  return {};
}

int run(const Options& o) {
  const std::filesystem::path config = o.device.empty() || o.action.empty() ? config_dir() : "";
  Session session;
  session.device =
      read_config(o.device.empty() ? config / "device.yaml" : std::filesystem::path(o.device), "a device file");
  session.action =
      read_config(o.action.empty() ? config / "grand_action.yaml" : std::filesystem::path(o.action), "an action file");
  session.overrides = o.overrides;
  session.damper = o.damper == "on";
  const SessionParts parts = load_session(session);

  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);  // a screen or a disk that is no more
  HostOptions options{o.pace == "messages" ? HostPace::messages : HostPace::clock, o.record, o.fault_folder,
                      to_text(session), player_for(parts.settings.rendering.keys)};
  Host host(parts.action, parts.settings, options);
  say(stdout, "{}", grant_table(host.grants()));
  if (!host.is_real_time() && !o.is_best_effort)
    throw std::runtime_error("this machine does not grant real time; see above, or let --best-effort carry on without");
  if (!host.is_real_time()) say(stdout, "carrying on without real time (--best-effort): forces may come late\n");
  const RenderSettings& r = parts.settings.rendering;
  say(stdout, "{} key{}, {:g} Hz; positions from {} {}, forces to {} {}\n", r.keys, r.keys == 1 ? "" : "s",
      1 / r.tick.period, parts.settings.link.positions_url, parts.settings.link.positions_channel,
      parts.settings.link.forces_url, parts.settings.link.forces_channel);
  std::fflush(stdout);

  using Clock = std::chrono::steady_clock;
  constexpr auto kStatusPeriod = std::chrono::milliseconds(100);
  const Clock::time_point start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  host.go();
  {
    Display display;
    for (Clock::time_point next = start; !is_interrupted && !(o.duration && elapsed() >= *o.duration);) {
      host.publish_status();
      display.show(host, elapsed());
      next += kStatusPeriod;
      std::this_thread::sleep_until(o.duration ? std::min(next, start + std::chrono::duration_cast<Clock::duration>(
                                                                            std::chrono::duration<double>(*o.duration)))
                                               : next);
    }
  }
  host.stop();
  const LoopSummary summary = host.finish();
  host.publish_status();
  report(host, summary, elapsed());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw std::runtime_error("the report could not be written to the standard output");
  return kDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Renders keyboard actions in hard real time: positions in, forces out, over LCM.", "erard-device");
  app.footer(
      "The final report names every fault. Exit codes: 0 ended by Ctrl-C or --duration, 1 the machine refused what it "
      "takes, 2\nbad input.");
  Options options;
  add_options(app, options);
  return erard::run_program(app, argc, argv, [&] {
    check(app, options);
    return run(options);
  });
}
