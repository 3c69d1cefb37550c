// erard-bench: does this machine hold the keys at the rate, and with what margin.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/contender.hpp"
#include "bench/harness.hpp"
#include "bench/lanes.hpp"
#include "bench/markdown_block.hpp"
#include "bench/results.hpp"
#include "erard/device/error.hpp"
#include "erard/device/output_file.hpp"
#include "erard/device/real_time.hpp"
#include "program.hpp"

namespace {

using namespace erard;

constexpr double kSlowestRate = 400, kFastestRate = 50000;  // [Hz] of the output, design range of the scheme
constexpr int kMostKeys = 256, kMostThreads = 64;

std::atomic<bool> is_interrupted{false};

struct Options {
  bench::Request request;
  std::string lanes = "auto", setting = "both", sleep = "on", damper = "on", csv, json, markdown;
  std::optional<double> margin;
  bool is_real_time = false;
};

std::string scene_names() {
  std::string text;
  for (const bench::Scene& scene : bench::scenes()) text += fmt::format("\n  {:<14} {}", scene.name, scene.what);
  return text;
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("--scene", o.request.scenes, "scenes to play, for instance --scene rest,forte (default: all)")
      ->delimiter(',');
  app.add_option("--keys", o.request.keys,
                 "numbers of keys, 1 to 256; more than 1: the keyboard scenes (default: 1,8,44,88)")
      ->delimiter(',')
      ->check(CLI::Range(1, kMostKeys));
  app.add_option(
         "--rate", o.request.rates_Hz,
         "rates of the output in Hz, 400 to 50000 (default: 1000,2000,5000,10000,20000,50000 for one key, 2000 for "
         "more, and 88 of them at 10000 on two threads)")
      ->delimiter(',');
  app.add_option("--setting", o.setting,
                 "cheapest: one internal step a period; default: as erard-sim takes them, 2 at 2 kHz and up to 8 where "
                 "something strikes; both")
      ->check(CLI::IsMember({"cheapest", "default", "both"}))
      ->capture_default_str();
  app.add_option("--sleep", o.sleep, "on: keys of a keyboard that rest are left alone; off: all are computed")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--threads", o.request.threads,
                 "share the keys of a keyboard out to that many threads, each on a CPU of its own")
      ->check(CLI::Range(1, kMostThreads))
      ->capture_default_str();
  app.add_option(
         "--lanes", o.lanes,
         "keys of a keyboard on one thread go together in the lanes of vector registers: auto (the widest of this "
         "CPU; off on more threads), sse2, avx2, avx512, off")
      ->check(CLI::IsMember({"auto", "sse2", "avx2", "avx512", "off"}))
      ->capture_default_str();
  app.add_option("--repeat", o.request.repeat, "measure that many times as long, 1 to 100: p99.99 takes 100000 periods")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_flag("--quick", o.request.is_quick, "a few seconds: rest, piano, forte and 8 keys at 2 kHz, once each");
  app.add_option("--margin", o.margin,
                 "share of the period that p99.9 of every scene's ticks may take (their maximum, where ticks are too "
                 "few), for instance 0.5; exit code 1 when one takes more (default: no verdict)");
  app.add_flag("--realtime", o.is_real_time,
               "run under SCHED_FIFO with locked memory, or not at all: what is refused is told, with exit code 1");
  app.add_flag("--peers", o.request.with_peers, "MuJoCo plays the same in the same run (tools/install-peers)");
  app.add_option("--damper", o.damper, "on: the whole action; off: the damper is clamped")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--csv", o.csv, "write the results to this file, times in us (default: none)");
  app.add_option("--json", o.json, "the same as JSON (default: none)");
  app.add_option(
      "--markdown", o.markdown,
      "write the results as tables into this file, between its lines of comment if it has them; for instance "
      "docs/performance.md (default: none)");
}

/// Lanes that are meant. Throws InputError when this CPU, or this build, has not got them.
std::string lanes_of(const Options& o) {
  const std::vector<std::string> names = bench::lane_names();
  if (o.lanes == "auto") return names.empty() ? "off" : names.back();
  if (o.lanes == "off") return o.lanes;
  if (std::find(names.begin(), names.end(), o.lanes) == names.end())
    throw InputError(fmt::format("--lanes {}: this CPU and this build have {}", o.lanes,
                                 names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  if (o.request.threads > 1)
    throw InputError(fmt::format("--lanes {} with --threads {}: lanes are for one thread", o.lanes, o.request.threads));
  return o.lanes;
}

void check(Options& o) {
  o.request.cheapest = o.setting != "default";
  o.request.with_default = o.setting != "cheapest";
  for (const double rate : o.request.rates_Hz)
    if (!(rate >= kSlowestRate && rate <= kFastestRate))
      throw InputError(fmt::format("--rate = {}, must be {} to {} Hz", rate, kSlowestRate, kFastestRate));
  if (o.margin && !(*o.margin > 0 && std::isfinite(*o.margin)))
    throw InputError(fmt::format("--margin = {}, must be a positive share of the period", *o.margin));
  o.request.may_sleep = o.sleep == "on";
  o.request.lanes = lanes_of(o);
  const std::pair<const char*, const std::string*> files[] = {
      {"--csv", &o.csv}, {"--json", &o.json}, {"--markdown", &o.markdown}};
  for (const auto& [one, file] : files)
    for (const auto& [other, same] : files)
      if (file != same && !file->empty() && *file == *same)
        throw InputError(fmt::format("{} and {} are both {}, must be two files", one, other, *file));
}

/// Progress on a terminal, once a run takes longer than two seconds.
class Progress {
 public:
  bool operator()(double done) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    if (is_terminal_ && elapsed > 2 && elapsed - shown_ > 0.2 && done > 0) {
      shown_ = elapsed;
      fmt::print(stderr, "\r{:5.1f} %  {:.0f} s left ", 100 * done, elapsed * (1 - done) / done);
      std::fflush(stderr);
    }
    return !is_interrupted;
  }
  ~Progress() {
    if (shown_ > 0) fmt::print(stderr, "\r{:<30}\r", "");
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  double shown_ = 0;
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
};

/// Scheduling and CPU of this run, in words. Throws std::runtime_error when what was asked for is refused.
/// @param cpus  the first is this thread's, the others are for more threads
std::string settle(const std::vector<int>& cpus, bool is_real_time) {
  const bool is_pinned = !cpus.empty() && request_cpu(cpus.front()).is_granted;
  const std::string where = is_pinned ? fmt::format("pinned to CPU {}", cpus.front()) : "not pinned to a CPU (refused)";
  if (!is_real_time) return where + ", ordinary scheduling";
  for (const Grant& grant : {request_fifo(RealTimeRequest{}.priority), request_memory_lock()})
    if (!grant.is_granted)
      throw std::runtime_error(fmt::format("--realtime: {}: {}; {}", grant.what, grant.granted, grant.remedy));
  return where + ", SCHED_FIFO, memory locked";
}

/// @return whether all rows of erard keep the margin
bool keeps_margin(const std::vector<bench::Row>& rows, double margin) {
  bool all = true;
  for (const bench::Row& row : rows) {
    if (row.engine != bench::Engine::erard || row.share() <= margin) continue;
    all = false;
    fmt::print(
        "MISSED: {} with {} key{} at {:.0f} Hz on {} thread{}, {}: {} of the ticks takes {:.1f} % of the period, "
        "allowed are {:g} %\n",
        row.scene, row.keys, row.keys == 1 ? "" : "s", row.rate_Hz, row.threads, row.threads == 1 ? "" : "s",
        row.setting, std::isnan(row.tick.p999) ? "the longest" : "p99.9", 100 * row.share(), 100 * margin);
  }
  return all;
}

int run(Options& o) {
  check(o);
  const bool misses_peer = o.request.with_peers && bench::mujoco_version().empty();
  if (misses_peer) o.request.with_peers = false;
  const std::vector<int> cpus = bench::usable_cpus();
  o.request.cpus = std::max(1, static_cast<int>(cpus.size()));
  const std::vector<bench::Match> plan = bench::make_plan(o.request);
  std::optional<bench::MarkdownBlock> markdown;
  if (!o.markdown.empty()) markdown.emplace(o.markdown, "erard-bench");
  std::optional<OutputFile> csv, json;
  if (!o.csv.empty()) csv.emplace(o.csv);
  if (!o.json.empty()) json.emplace(o.json);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });

  bench::Results results;
  results.has_damper = o.damper == "on";
  const bench::Stage stage = bench::load_stage(results.has_damper);
  const std::string scheduling = settle(cpus, o.is_real_time);
  results.circumstances = bench::look_around();
  results.circumstances.scheduling = scheduling;
  if (misses_peer)
    fmt::print("peer: MuJoCo is not installed in this build; tools/install-peers fetches it, then run CMake again\n\n");
  {
    Progress progress;
    const std::vector<int> others(cpus.begin() + (cpus.empty() ? 0 : 1), cpus.end());
    const bench::Harness harness{stage, results.circumstances.clock_overhead, o.is_real_time, others,
                                 std::ref(progress)};
    results.rows = bench::measure(harness, plan);
  }
  results.is_complete = !is_interrupted;

  if (csv) bench::write_csv(*csv, results);
  if (json) bench::write_json(*json, results);
  if (csv && json)
    commit_together({&*csv, &*json});
  else if (csv)
    csv->commit();
  else if (json)
    json->commit();
  if (markdown && results.is_complete) markdown->replace(bench::markdown(results));
  fmt::print("{}", bench::table(results));
  if (markdown && !results.is_complete) fmt::print("{} is left as it was\n", o.markdown);
  const bool is_kept = !o.margin || keeps_margin(results.rows, *o.margin);
  if (std::fflush(stdout) != 0) throw std::runtime_error("the table could not be written to the standard output");
  if (!results.is_complete) return kInterrupted;
  return is_kept ? kDone : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures how long this machine takes for scenes on the grand action, and how exact it is at that.",
               "erard-bench");
  app.footer(
      "Scenes:" + scene_names() +
      "\n\nA tick is one period of all keys, a step one internal step of one key. Without options it takes about "
      "three\nminutes. Exit codes: 0 done, 1 a scene missed the margin or the run failed, 2 bad input, 130 "
      "interrupted (what\nwas measured is kept).");
  Options options;
  add_options(app, options);
  return erard::run_program(app, argc, argv, [&] { return run(options); });
}
