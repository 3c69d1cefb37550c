// erard-sim: plays a keystroke on an action, headless, and tells what the finger feels.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "erard/device/config_dir.hpp"
#include "erard/device/error.hpp"
#include "erard/device/report.hpp"
#include "erard/device/results.hpp"
#include "program.hpp"

namespace {

using namespace erard;
using Path = std::filesystem::path;

constexpr double kSlowestRate = 400, kFastestRate = 50000;  // [Hz] of the output, design range of the scheme
constexpr int kMostSubsteps = 1000;
constexpr double kLongestRun = 3600;  // [s]

std::atomic<bool> is_interrupted{false};

struct Options {
  std::string action, keystroke, drive = "auto", compare, dump, out, damper = "off", felts = "massless";
  double rate = 2000;
  std::optional<double> duration, compare_until;
  int substeps = 0;
  std::vector<std::string> without, set, svg;
};

void add_options(CLI::App& app, Options& o) {
  app.add_option("--action", o.action, "action file, YAML (default: the grand action that comes with erard)");
  app.add_option("--keystroke", o.keystroke,
                 "keystroke, CSV with a header: t_s and position_m or force_N (default: a recorded fast strike)");
  app.add_option("--drive", o.drive,
                 "piston: the file moves the free end of the finger's spring and damper; key: it moves the key; "
                 "force: it presses the key (default: piston for position_m, force for force_N)")
      ->check(CLI::IsMember({"auto", "piston", "key", "force"}));
  app.add_option("--rate", o.rate, "rate of the output in Hz, 400 to 50000")->capture_default_str();
  app.add_option("--substeps", o.substeps,
                 "internal steps per output step, 1 to 1000, all of one length (default: of 250 us at most, and split "
                 "down to 62.5 us where the motion is not as guessed)")
      ->check(CLI::Range(1, kMostSubsteps));
  app.add_option("--duration", o.duration, "simulated time in s, up to 3600 (default: the length of the keystroke)");
  app.add_option("--without", o.without, "contacts to leave out, for instance --without KH,HG")->delimiter(',');
  app.add_option("--set", o.set,
                 "replace a parameter of the action, absolute and in the file's unit (SI), for instance "
                 "--set S_Jy=0.0588; repeatable")
      ->expected(1)
      ->take_all();
  app.add_option("--damper", o.damper, "on: the damper takes part; off: it is clamped")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--felts", o.felts,
                 "massless: each felt keeps its compression as history; bodies: each felt is a light body on a slide; "
                 "rigid: no felts, bodies touch directly")
      ->check(CLI::IsMember({"massless", "bodies", "rigid"}))
      ->capture_default_str();
  app.add_option("--out", o.out,
                 "folder for trajectory.csv, events.yaml, summary.yaml and report.html (default: no files)")
      ->check(
          CLI::Validator([](std::string& text) { return text.empty() ? "must name a folder" : std::string(); }, ""));
  app.add_option("--svg", o.svg,
                 "poses to draw into the folder of --out: times in s or names of events, for instance "
                 "--svg 0,jack_meets_let_off")
      ->delimiter(',');
  app.add_option(
      "--compare", o.compare,
      "results of another run (a folder of --out) or a CSV with t_s and force_N: report the relative error eta "
      "of (6.3) against it, and show both in report.html");
  app.add_option("--compare-until", o.compare_until, "end of the compared window in s (default: all that both have)");
  app.add_option("--dump-osnsp", o.dump,
                 "file for the one-step non-smooth problem of every internal step (W, q, cones, solution), JSON lines");
}

Setting parse_setting(const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const char* begin = text.data() + std::min(equals + 1, text.size());
  const char* end = text.data() + text.size();
  double value = NAN;
  const auto [stop, failure] = std::from_chars(begin, end, value);
  if (equals == 0 || begin == end || failure != std::errc{} || stop != end || !std::isfinite(value))
    throw InputError(
        fmt::format("--set {}: must be NAME=VALUE with a finite number, for instance --set S_Jy=0.0588", text));
  return {text.substr(0, equals), value};
}

void check_range(const std::string& what, double value, double least, double most, const char* unit) {
  if (!(value >= least && value <= most))
    throw InputError(fmt::format("{} = {}, must be {} to {} {}", what, value, least, most, unit));
}

DriveKind choose_drive(const std::string& name, const Keystroke& keystroke, const std::string& file) {
  const bool is_force = keystroke.quantity() == KeystrokeQuantity::force;
  if (name == "auto") return is_force ? DriveKind::force : DriveKind::piston;
  if ((name == "force") != is_force)
    throw InputError(fmt::format("{}: holds {}, which --drive {} cannot use; leave --drive out or give a file with {}",
                                 file, is_force ? "force_N" : "position_m", name, is_force ? "position_m" : "force_N"));
  return name == "force" ? DriveKind::force : name == "key" ? DriveKind::key : DriveKind::piston;
}

/// Progress on a terminal, once a run takes longer than two seconds.
class Progress {
 public:
  bool operator()(double done) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    if (is_terminal_ && elapsed > 2 && elapsed - shown_ > 0.2) {
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

/// What a run is to do, read and checked: nothing is written before all of it is good.
struct Plan {
  Path action_path, keystroke_path;
  ActionOptions action_options;
  ActionFile action;
  Keystroke keystroke;
  std::optional<OtherRun> other;
  RunSummary summary;
  double duration;       // [s]
  double compare_until;  // [s]
};

/// The key is put where the file says: from the start that must be its rest.
void check_start(const Plan& plan) {
  constexpr double kRest = 1e-4;  // [m]
  const double start = plan.keystroke.at(plan.keystroke.start()).value;
  if (plan.summary.tick.drive == DriveKind::key && std::abs(start) > kRest)
    throw InputError(fmt::format("{}: starts at position_m = {}, must start within {} m of rest for --drive key",
                                 plan.keystroke_path.string(), start, kRest));
}

/// The window of --compare must hold something to compare with.
void check_window(const Plan& plan, const std::string& name) {
  const ForceCurve& other = plan.other->force;
  const double end = std::min(plan.compare_until, plan.summary.start + plan.duration);
  double largest = 0;
  int rows = 0;
  for (std::size_t i = 0; i < other.time.size(); ++i) {
    if (other.time[i] < plan.summary.start || other.time[i] > end) continue;
    ++rows;
    largest = std::max(largest, std::abs(other.force[i]));
  }
  if (rows < 2 || largest == 0)
    throw InputError(fmt::format("--compare {}: holds no force between {} and {} s, must overlap with the run", name,
                                 plan.summary.start, end));
}

Plan make_plan(const Options& o) {
  check_range("--rate", o.rate, kSlowestRate, kFastestRate, "Hz");
  if (!o.svg.empty() && o.out.empty()) throw InputError("--svg needs --out DIR: the pictures are written there");
  if (o.compare_until && o.compare.empty())
    throw InputError("--compare-until needs --compare: there is nothing to compare with");
  ActionOptions options;
  for (const std::string& text : o.set) options.settings.push_back(parse_setting(text));
  options.without = o.without;
  options.damper = o.damper == "on";
  options.felts = o.felts == "rigid" ? FeltModel::rigid : o.felts == "bodies" ? FeltModel::bodies : FeltModel::massless;
  const Path action_path = o.action.empty() ? config_dir() / "grand_action.yaml" : Path(o.action);
  const Path keystroke_path =
      o.keystroke.empty() ? config_dir() / "keystrokes" / "recorded_fast.csv" : Path(o.keystroke);
  Plan plan{action_path,
            keystroke_path,
            options,
            load_action(action_path, options),
            read_keystroke(keystroke_path),
            {},
            {},
            0,
            0};
  for (const std::string& note : plan.action.notes) fmt::print(stderr, "erard-sim: {}\n", note);
  if (plan.action.model.finger.body == kGround)
    throw InputError(fmt::format("{}: has no finger, so no keystroke can be played on it", action_path.string()));
  plan.duration = o.duration.value_or(plan.keystroke.end() - plan.keystroke.start());
  check_range(o.duration ? "--duration" : keystroke_path.string() + ": duration", plan.duration, 1 / o.rate,
              kLongestRun, "s");
  plan.compare_until = o.compare_until.value_or(INFINITY);
  if (std::isnan(plan.compare_until)) throw InputError("--compare-until = nan, must be a time in s");
  plan.summary.action = action_path.string();
  plan.summary.keystroke = keystroke_path.string();
  plan.summary.tick.drive = choose_drive(o.drive, plan.keystroke, keystroke_path.string());
  plan.summary.tick.set_rate(o.rate, o.substeps);
  plan.summary.start = plan.keystroke.start();
  check_start(plan);
  if (!o.compare.empty()) {
    plan.other = read_other_run(o.compare);
    check_window(plan, o.compare);
  }
  return plan;
}

/// Files of one run, all opened before it starts; those not asked for are absent.
struct Outputs {
  std::optional<OutputFile> trajectory, events, summary, report, problems;

  explicit Outputs(const Options& o) {
    if (!o.out.empty()) {
      prepare_output_folder(o.out);
      trajectory.emplace(Path(o.out) / "trajectory.csv");
      events.emplace(Path(o.out) / "events.yaml");
      summary.emplace(Path(o.out) / "summary.yaml");
      report.emplace(Path(o.out) / "report.html");
    }
    if (o.dump.empty()) return;
    std::error_code ignored;
    for (const Path& used : {Path(o.action), Path(o.keystroke), Path(o.compare), Path(o.out) / "trajectory.csv.part"})
      if (std::filesystem::equivalent(used, o.dump, ignored) ||
          std::filesystem::equivalent(used, o.dump + ".part", ignored))
        throw InputError(fmt::format("--dump-osnsp {}: is another file of this run, must be one of its own", o.dump));
    problems.emplace(o.dump);
  }

  void commit() {
    if (trajectory) commit_together({&*trajectory, &*events, &*summary, &*report});
    if (problems) problems->commit();
  }
};

Report make_report(const Plan& plan, const Scene& scene, const ReportRows& rows) {
  ActionOptions undamped = plan.action_options;
  undamped.damper = false;  // touch weight is measured without it
  Report report{&plan.summary, &scene, &rows, measure_action(load_action(plan.action_path, undamped)),
                plan.other ? &*plan.other : nullptr};
  const std::vector<Measure> stroke = measure_stroke(plan.action, rows, plan.summary.result.events);
  report.measures.insert(report.measures.end(), stroke.begin(), stroke.end());
  return report;
}

/// Plays the plan and fills the files.
void play(const Options& o, Plan& plan, Outputs& outputs) {
  const Model& model = plan.action.model;
  RunSummary& summary = plan.summary;
  std::optional<TrajectoryFile> trajectory;
  std::optional<ProblemFile> problems;
  if (outputs.trajectory) trajectory.emplace(*outputs.trajectory, model);
  if (outputs.problems) problems.emplace(*outputs.problems);
  const Scene scene = build_scene(plan.action, trajectory ? load_drawing(plan.action_path) : Drawing{});
  ReportRows rows(model, summary.start, summary.tick.period);
  ForceCurve curve;
  Progress progress;

  RunSettings settings;
  settings.tick = summary.tick;
  settings.start = summary.start;
  settings.duration = plan.duration;
  settings.goes_on = std::ref(progress);
  settings.on_row = [&](const Snapshot& row) {
    if (trajectory) {
      trajectory->add(row);
      rows.add(row);
    }
    if (!plan.other) return;
    curve.time.push_back(row.time);
    curve.force.push_back(row.force);
  };
  if (problems)
    settings.on_problem = [&](const OneStepProblem& problem, const RowVector& impulse, double time) {
      problems->add(problem, impulse, time);
    };
  summary.result = run(plan.action, plan.keystroke, settings);

  if (plan.other && curve.time.size() > 1) {
    const ForceCurve& other = plan.other->force;
    const double from = std::max(curve.time.front(), other.time.front());
    const double until = std::min({plan.compare_until, curve.time.back(), other.time.back()});
    summary.comparison = Comparison{o.compare, from, until, relative_error(other, curve, until)};
  }
  std::vector<Path> pictures;
  if (trajectory) {
    const Report report = make_report(plan, scene, rows);
    write_events(*outputs.events, summary.result.events);
    write_summary(*outputs.summary, summary);
    write_report(*outputs.report, report);
    outputs.commit();
    pictures = write_poses(o.out, o.svg, report);
  } else {
    outputs.commit();
  }
  fmt::print("{}", describe(summary));
  if (trajectory)
    fmt::print("files        {0}/report.html, {0}/trajectory.csv, {0}/events.yaml, {0}/summary.yaml\n", o.out);
  for (const Path& picture : pictures) fmt::print("picture      {}\n", picture.string());
  if (problems) fmt::print("problems     {}\n", o.dump);
}

int simulate(const Options& o) {
  Plan plan = make_plan(o);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { is_interrupted = true; });
  Outputs outputs(o);
  play(o, plan, outputs);
  if (std::fflush(stdout) != 0) throw std::runtime_error("the summary could not be written to the standard output");
  if (!plan.summary.result.is_complete) return kInterrupted;
  return plan.summary.result.is_finite ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Plays a keystroke on a keyboard action and tells what the finger feels.", "erard-sim");
  app.footer(
      "All values are SI. Exit codes: 0 done, 1 the run failed, 2 bad input, 130 interrupted (what is complete is "
      "kept).");
  Options options;
  add_options(app, options);
  return erard::run_program(app, argc, argv, [&] { return simulate(options); });
}
