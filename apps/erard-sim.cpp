// erard-sim: plays a keystroke on an action, headless, and tells what the finger feels.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
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
#include "erard/version.hpp"

namespace {

using namespace erard;
using Path = std::filesystem::path;

constexpr double kSlowestRate = 400, kFastestRate = 50000;  // [Hz] of the output, design range of the scheme
constexpr int kMostSubsteps = 1000;
constexpr double kLongestRun = 3600;  // [s]

std::atomic<bool> is_interrupted{false};

struct Options {
  std::string action, keystroke, drive = "auto", compare, dump, out, damper = "off";
  double rate = 2000, duration = NAN, compare_until = NAN;
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
  app.add_option("--substeps", o.substeps, "internal steps per output step, 1 to 1000 (default: as few as keep an internal step at 125 us or less, 4 at 2 kHz)")
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
  app.add_option("--out", o.out, "folder for trajectory.csv, events.yaml, summary.yaml and report.html (default: no files)");
  app.add_option("--svg", o.svg,
                 "poses to draw into the folder of --out: times in s or names of events, for instance "
                 "--svg 0,jack_meets_let_off")
      ->delimiter(',');
  app.add_option("--compare", o.compare,
                 "results of another run (a folder of --out) or a CSV with t_s and force_N: report the relative error eta "
                 "of (6.3) against it, and show both in report.html");
  app.add_option("--compare-until", o.compare_until, "end of the compared window in s (default: all that both have)");
  app.add_option("--dump-osnsp", o.dump,
                 "file for the one-step non-smooth problem of every internal step (W, q, cones, solution), JSON lines");
}

Setting parse_setting(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  std::size_t used = 0;
  double value = NAN;
  try {
    if (equals != std::string::npos) value = std::stod(text.substr(equals + 1), &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (name.empty() || used == 0 || used != text.size() - equals - 1 || !std::isfinite(value))
    throw InputError(fmt::format("--set {}: must be NAME=VALUE with a finite number, for instance --set S_Jy=0.0588", text));
  return {name, value};
}

void check_range(const char* option, double value, double least, double most, const char* unit) {
  if (!(value >= least && value <= most))
    throw InputError(fmt::format("{} = {}, must be {} to {} {}", option, value, least, most, unit));
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

/// Files of one run; those not asked for are absent.
struct Outputs {
  std::optional<TrajectoryFile> trajectory;
  std::optional<ProblemFile> problems;

  Outputs(const Options& o, const Model& model) {
    if (!o.out.empty()) {
      prepare_output_folder(o.out);
      trajectory.emplace(Path(o.out) / "trajectory.csv", model);
    }
    if (!o.dump.empty()) problems.emplace(Path(o.dump));
  }
};

int simulate(const Options& o) {
  check_range("--rate", o.rate, kSlowestRate, kFastestRate, "Hz");
  if (!std::isnan(o.duration)) check_range("--duration", o.duration, 1 / o.rate, kLongestRun, "s");
  ActionOptions action_options;
  for (const std::string& text : o.set) action_options.settings.push_back(parse_setting(text));
  action_options.without = o.without;
  action_options.damper = o.damper == "on";
  const Path action_path = o.action.empty() ? config_dir() / "grand_action.yaml" : Path(o.action);
  const Path keystroke_path = o.keystroke.empty() ? config_dir() / "keystrokes" / "recorded_fast.csv" : Path(o.keystroke);
  const ActionFile action = load_action(action_path, action_options);
  const Keystroke keystroke = read_keystroke(keystroke_path);
  std::optional<OtherRun> other;
  if (!o.compare.empty()) other = read_other_run(o.compare);
  if (!o.svg.empty() && o.out.empty()) throw InputError("--svg needs --out DIR: the pictures are written there");
  if (action.model.finger.body == kGround)
    throw InputError(fmt::format("{}: has no finger, so no keystroke can be played on it", action_path.string()));

  RunSummary summary;
  summary.action = action_path.string();
  summary.keystroke = keystroke_path.string();
  summary.tick.drive = choose_drive(o.drive, keystroke, keystroke_path.string());
  summary.tick.set_rate(o.rate, o.substeps);
  summary.start = keystroke.start();
  Outputs outputs(o, action.model);
  const Scene scene = build_scene(action, o.out.empty() ? Drawing{} : load_drawing(action_path));
  ReportRows rows(action.model, summary.start, summary.tick.period);
  ForceCurve curve;
  Progress progress;

  RunSettings settings;
  settings.tick = summary.tick;
  settings.start = summary.start;
  settings.duration = std::isnan(o.duration) ? keystroke.end() - keystroke.start() : o.duration;
  settings.goes_on = std::ref(progress);
  settings.on_row = [&](const Snapshot& row) {
    if (outputs.trajectory) {
      outputs.trajectory->add(row);
      rows.add(row);
    }
    curve.time.push_back(row.time);
    curve.force.push_back(row.force);
  };
  if (outputs.problems)
    settings.on_problem = [&](const OneStepProblem& problem, const RowVector& impulse, double time) {
      outputs.problems->add(problem, impulse, time);
    };
  summary.result = run(action, keystroke, settings);
  if (other && curve.time.size() > 1) {
    const double until = std::min({std::isnan(o.compare_until) ? INFINITY : o.compare_until, curve.time.back(),
                                   other->force.time.back()});
    summary.comparison = Comparison{o.compare, until, relative_error(other->force, curve, until)};
  }

  fmt::print("{}", describe(summary));
  if (outputs.problems) outputs.problems->commit();
  if (outputs.trajectory) {
    outputs.trajectory->commit();
    write_events(Path(o.out) / "events.yaml", summary.result.events);
    write_summary(Path(o.out) / "summary.yaml", summary);
    fmt::print("files        {0}/trajectory.csv, {0}/events.yaml, {0}/summary.yaml, {0}/report.html\n", o.out);
    action_options.damper = false;  // touch weight is measured without it
    Report report{&summary, &scene, &rows, measure_action(load_action(action_path, action_options)),
                  other ? &*other : nullptr};
    const std::vector<Measure> stroke = measure_stroke(action, rows, summary.result.events);
    report.measures.insert(report.measures.end(), stroke.begin(), stroke.end());
    write_report(Path(o.out) / "report.html", report);
    for (const Path& file : write_poses(o.out, o.svg, report)) fmt::print("picture      {}\n", file.string());
  }
  if (outputs.problems) fmt::print("problems     {}\n", o.dump);
  if (!summary.result.is_complete) return 130;
  return summary.result.is_finite ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Plays a keystroke on a keyboard action and tells what the finger feels.", "erard-sim");
  app.set_version_flag("--version", fmt::format("erard-sim {}", erard::kVersion));
  app.footer("All values are SI. Exit codes: 0 done, 1 the run failed, 2 bad input, 130 interrupted (what is complete is kept).");
  Options options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "erard-sim: {}; see erard-sim --help\n", error.what());
    return 2;
  }
  std::signal(SIGINT, [](int) { is_interrupted = true; });
  std::signal(SIGTERM, [](int) { is_interrupted = true; });
  try {
    return simulate(options);
  } catch (const erard::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "erard-sim: {}\n", error.what());
    return 1;
  }
}
