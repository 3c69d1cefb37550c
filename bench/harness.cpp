#include "bench/harness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>

#include "bench/breather.hpp"
#include "bench/fixed_work.hpp"
#include "bench/sample_set.hpp"

namespace erard::bench {
namespace {

constexpr double kQuickKeyboard = 0.1;   // [s] simulated, instead of a whole part
constexpr double kShortestTick = 5e-6;   // [s] with the fixed work: bounds how many fit the time of an entrant
constexpr long kTailOfKeyboard = 10000;  // ticks of ours at least: so many it takes to state p99.9
constexpr double kLargestSet = 600'000;  // ticks: 5 MB of times

Maker maker_of(Engine engine) { return engine == Engine::erard ? make_erard : make_mujoco; }

/// An entrant on its way.
struct Runner {
  Entrant entrant;
  std::unique_ptr<Contender> contender;
  std::size_t least;  // ticks that it plays, however long they take
  SampleSet samples;
  Error error;
  double spent = 0;  // [s]
};

class MatchRun {
 public:
  MatchRun(const Harness& harness, const Match& match, double done_before, double done_after)
      : harness_(harness), match_(match), done_before_(done_before), done_after_(done_after) {
    const bool is_quick_keyboard = match.scene->is_keyboard && match.seconds == 0;
    slice_ =
        std::lround((is_quick_keyboard ? kQuickKeyboard : duration_of(*match.scene, harness.stage)) * match.rate_Hz);
    const auto ticks = static_cast<std::size_t>(std::min(match.seconds / kShortestTick, kLargestSet));
    for (const Entrant& entrant : match.entrants) {
      const std::size_t least = least_ticks(entrant);
      runners_.push_back({entrant,
                          maker_of(entrant.engine)(harness.stage, job(entrant)),
                          least,
                          SampleSet(std::max(least, ticks), timed_steps(entrant)),
                          {},
                          0});
    }
  }

  /// @param truths  converged force of each entrant; empty curves on keyboards
  std::vector<Row> play(const std::vector<ForceCurve>& truths) {
    if (!match_.scene->is_keyboard)
      for (std::size_t i = 0; i < runners_.size(); ++i) warm_up(runners_[i], truths[i]);
    for (bool is_busy = true; is_busy && goes_on();) {
      is_busy = false;
      for (Runner& runner : runners_) is_busy = play_slice(runner) || is_busy;
    }
    std::vector<Row> rows;
    for (Runner& runner : runners_)
      if (!runner.samples.ticks().empty()) rows.push_back(row_of(runner));
    return rows;
  }

 private:
  Job job(const Entrant& entrant) const {
    Job job{match_.scene, match_.keys, match_.rate_Hz, entrant.substeps, entrant.is_split};
    job.may_sleep = entrant.may_sleep;
    job.worker_cpus.assign(harness_.worker_cpus.begin(), harness_.worker_cpus.begin() + (match_.threads - 1));
    job.lanes = entrant.lanes;
    job.felts = entrant.felts;
    return job;
  }

  std::size_t least_ticks(const Entrant& entrant) const {
    if (match_.seconds == 0) return static_cast<std::size_t>(slice_);
    long passes = kPasses;
    if (match_.scene->is_keyboard && entrant.engine == Engine::erard)
      passes = std::max(passes, (kTailOfKeyboard + slice_ - 1) / slice_);
    return static_cast<std::size_t>(passes * slice_);
  }

  /// Steps of a period that are timed one by one: those of one key, where there are always as many.
  int timed_steps(const Entrant& entrant) const { return match_.keys == 1 && !entrant.is_split ? entrant.substeps : 0; }

  /// Share of the plan that is done.
  double done() const {
    double share = 1;
    for (const Runner& runner : runners_)
      share = std::min(share, match_.seconds > 0 ? runner.spent / match_.seconds : runner.spent > 0 ? 1.0 : 0.0);
    return done_before_ + share * (done_after_ - done_before_);
  }
  bool goes_on() const { return harness_.goes_on(done()); }

  /// One slice without clock: caches, branch predictors and clock frequency settle, and the force is had for its error.
  void warm_up(Runner& runner, const ForceCurve& truth) {
    const double end = static_cast<double>(slice_) / match_.rate_Hz;
    const ForceCurve force = force_of(*runner.contender, match_.rate_Hz, end, [this] { return goes_on(); });
    if (match_.scene->release > 0) runner.error = error_of(truth, force, match_.scene->release);
  }

  /// @return whether it played; no when its time is over or its memory full
  bool play_slice(Runner& runner) {
    SampleSet& samples = runner.samples;
    const bool has_enough = runner.spent >= match_.seconds && samples.ticks().size() >= runner.least;
    if (has_enough || samples.room() < static_cast<std::size_t>(slice_)) return false;
    const auto clock = static_cast<std::int64_t>(std::lround(harness_.clock_overhead * 1e9));
    std::vector<std::int64_t> step_ends(static_cast<std::size_t>(timed_steps(runner.entrant)));
    const std::size_t before = samples.ticks().size();
    const double done_so_far = done();
    Effort effort;
    runner.contender->start();
    const std::int64_t slice_begin = now();
    long i = 0;
    for (; i < slice_ && harness_.goes_on(done_so_far); ++i) {
      breather_.breathe();
      runner.contender->prepare();
      const StepClock steps = step_ends.empty() ? StepClock() : StepClock(step_ends.data());
      const std::int64_t begin = now();
      runner.contender->tick(steps);
      const std::int64_t end = now();
      effort += runner.contender->effort();
      const std::int64_t work_begin = now();
      fixed_work();
      const std::int64_t work_end = now();
      samples.add(begin, step_ends, end, work_begin, work_end, clock);
    }
    if (i < slice_) return samples.cut_back(before), false;
    samples.add(effort);
    runner.spent += 1e-9 * static_cast<double>(now() - slice_begin);
    return true;
  }

  Row row_of(Runner& runner) const {
    SampleSet& samples = runner.samples;
    const Effort& effort = samples.effort();
    if (!effort.is_finite)
      throw std::runtime_error(fmt::format("{} lost its numbers in {} at {} Hz with {} steps a period",
                                           name_of(runner.entrant.engine), match_.scene->name, match_.rate_Hz,
                                           runner.entrant.substeps));
    Row row;
    row.engine = runner.entrant.engine;
    row.scene = match_.scene->name;
    row.keys = match_.keys;
    row.played = match_.scene->is_keyboard         ? played_keys(match_.scene->played, match_.keys)
                 : match_.scene->keystroke.empty() ? 0
                                                   : 1;
    row.rate_Hz = match_.rate_Hz;
    row.threads = match_.threads;
    row.may_sleep = runner.entrant.may_sleep;
    row.felts = runner.entrant.felts;
    row.lanes = runner.entrant.lanes;
    row.setting = runner.entrant.setting;
    row.substeps = runner.entrant.substeps;
    std::vector<double> fastest = fastest_of_passes(samples.ticks(), static_cast<std::size_t>(slice_));
    row.undisturbed = describe(fastest);
    row.tick = describe(samples.ticks());
    row.step = describe(samples.steps());
    row.noise = describe(samples.noise());
    const double steps = static_cast<double>(effort.steps);
    if (effort.steps > 0) row.iterations = static_cast<double>(effort.iterations) / steps;
    if (effort.steps > 0 && runner.entrant.engine == Engine::erard)
      row.sweeps = static_cast<double>(effort.sweeps) / steps;
    row.asleep = static_cast<double>(effort.asleep) / static_cast<double>(row.tick.count);
    row.not_converged = effort.not_converged;
    row.error = runner.error;
    return row;
  }

  const Harness& harness_;
  const Match& match_;
  double done_before_, done_after_;
  Breather breather_{harness_.leaves_room};
  long slice_ = 0;  // a pass [ticks]
  std::vector<Runner> runners_;
};

}  // namespace

std::vector<Row> measure(const Harness& harness, const std::vector<Match>& plan) {
  std::map<std::tuple<const Scene*, Engine, FeltModel>, ForceCurve> converged;
  double total = 0, done = 0;
  const auto weight = [](const Match& match) {
    return (match.seconds + 0.05) * static_cast<double>(match.entrants.size());
  };
  for (const Match& match : plan) total += weight(match);
  std::vector<Row> rows;
  for (const Match& match : plan) {
    const double before = done / total;
    done += weight(match);
    std::vector<ForceCurve> truths;
    for (const Entrant& entrant : match.entrants) {
      const auto [place, is_new] = converged.try_emplace({match.scene, entrant.engine, entrant.felts});
      if (is_new && match.scene->release > 0)
        place->second = converged_force(maker_of(entrant.engine), harness.stage, *match.scene, entrant.felts,
                                        [&] { return harness.goes_on(before); });
      truths.push_back(place->second);
    }
    if (!harness.goes_on(before)) break;
    MatchRun run(harness, match, before, done / total);
    const std::vector<Row> played = run.play(truths);
    rows.insert(rows.end(), played.begin(), played.end());
  }
  compare_with_peers(rows);
  return rows;
}

}  // namespace erard::bench
