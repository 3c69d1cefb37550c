// The results for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/results.hpp"
#include "bench/targets.hpp"
#include "bench/thesis.hpp"
#include "erard/solver/workspace.hpp"

namespace erard::bench {
namespace {

/// Which entrant: the first columns of both tables.
std::string entrant_of(const Row& r) {
  const std::string scene = r.felts == FeltModel::massless ? r.scene : fmt::format("{} {}", r.scene, name_of(r.felts));
  return fmt::format("{:<7}{:<14}{:>4}{:>7}{:>4}{:>7}{:>6.0f} {:<9}{:>3}", name_of(r.engine), scene, r.keys,
                     cell(r.asleep, 1), r.threads, r.lanes, r.rate_Hz, r.setting, r.substeps);
}
std::string entrant_head() {
  return fmt::format("{:<7}{:<14}{:>4}{:>7}{:>4}{:>7}{:>6} {:<9}{:>3}", "engine", "scene", "keys", "asleep", "thr",
                     "lanes", "Hz", "setting", "n");
}
constexpr int kEntrant = 61;  // characters of it

std::string times_of(const Row& r) {
  const Distribution& t = r.tick;
  const auto share = fmt::format("{}{}", std::isnan(t.p999) ? "<" : "", cell(100 * r.share(), 1));
  return fmt::format("{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>7}{:>8}\n", t.count, us_cell(t.min), us_cell(t.median),
                     us_cell(t.p99), us_cell(t.p999), us_cell(t.p9999), us_cell(t.max), share,
                     cell(r.real_time_factor(), r.real_time_factor() < 10 ? 2 : 0), us_cell(r.noise.tail()));
}
std::string times_head() {
  return fmt::format("{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>7}{:>8}\n", "ticks", "min", "median", "p99", "p99.9",
                     "p99.99", "max", "% of T", "x real", "noise");
}

std::string work_of(const Row& r) {
  return fmt::format("{:>8}{:>8}{:>10}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>10}{:>8}\n", us_cell(r.step.median),
                     us_cell(r.step.p999), us_cell(r.undisturbed.median), us_cell(r.undisturbed.p99),
                     us_cell(r.undisturbed.max), cell(r.iterations, 1), cell(r.sweeps, 1), cell(100 * r.error.eta, 2),
                     cell(r.error.rms_N, 3), cell(r.times_peer_median, 2), cell(r.times_peer_undisturbed, 2));
}
std::string work_head() {
  return fmt::format("{:>8}{:>8}{:>10}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>10}{:>8}\n", "median", "p99.9", "median", "p99",
                     "max", "iter", "sweeps", "eta %", "RMS N", "median", "undist.");
}

/// All rows, a blank line between scenes.
std::string all_lines(const std::vector<Row>& rows, std::string (*rest_of)(const Row&)) {
  std::string text, scene;
  for (const Row& row : rows) {
    if (!scene.empty() && row.scene != scene) text += "\n";
    scene = row.scene;
    text += entrant_of(row);
    text += rest_of(row);
  }
  return text;
}

std::string circumstance_lines(const Results& results) {
  const Circumstances& c = results.circumstances;
  const std::pair<const char*, std::string> lines[] = {
      {"commit", c.commit},
      {"compiler", c.compiler},
      {"machine", fmt::format("{}, {}", c.cpu, c.kernel)},
      {"scheduling", c.scheduling},
      {"clock", fmt::format("{:.0f} ns a look, subtracted", 1e9 * c.clock_overhead)},
      {"peer", c.peer.empty() ? "not installed" : c.peer},
      {"damper", results.has_damper ? "on" : "off"},
      {"memory", memory_of_an_action()}};
  std::string text;
  for (const auto& [name, value] : lines) text += fmt::format("{:<12} {}\n", name, value);
  return text;
}

std::string tick_lines(const std::vector<Row>& rows) {
  return fmt::format(
      "\n{:{}}one period of all keys, a tick [us]\n{}{}{}\n{}"
      "noise: its p99.9 in this row; asleep: keys that are left alone, on average; thr: threads; n: internal steps a\n"
      "period; % of T: p99.9 of the tick (<: its maximum, for want of samples) as a share of the period; -: not "
      "measured,\n"
      "or too few samples to tell\n",
      "", kEntrant, entrant_head(), times_head(), all_lines(rows, times_of), noise_line(rows));
}

/// Those rows alone that have something to tell.
std::string step_lines(std::vector<Row> rows) {
  std::erase_if(rows, [](const Row& row) { return row.step.count == 0 && row.undisturbed.count == 0; });
  if (rows.empty()) return {};
  return fmt::format(
      "\n{:{}}{:>16}{:>26}{:>16}{:>16}{:>18}\n{}{}{}"
      "undisturbed: each tick of the scene at its fastest of all passes; eta, RMS: up to the release, against 5 us "
      "steps\n"
      "of the same engine\n",
      "", kEntrant, "one step [us]", "undisturbed tick [us]", "a step", "error of force", "times the peer",
      entrant_head(), work_head(), all_lines(rows, work_of));
}

std::string thesis_lines(const std::vector<Row>& rows) {
  const std::vector<ThesisLine> lines = beside_thesis(rows);
  if (lines.empty()) return {};
  std::string text =
      fmt::format("\n{:<46}{:>12}{:>12}{:>12}{:>12}\n", "beside the thesis: piano, a step of 500 us [us]", "thesis",
                  "here", "undisturbed", "times less");
  for (const ThesisLine& line : lines)
    text += fmt::format("{:<46}{:>12}{:>12}{:>12}{:>12}\n", line.model, us_cell(line.thesis), us_cell(line.measured),
                        us_cell(line.undisturbed), cell(line.thesis / line.measured, 0));
  return text + thesis_note();
}

std::string target_lines(const std::vector<Row>& rows) {
  const std::vector<Target> targets = targets_of(rows);
  if (std::none_of(targets.begin(), targets.end(), [](const Target& each) { return each.is_measured(); })) return {};
  std::string text = fmt::format("\n{:<76}{:>10}{:>10}{:>13}\n", "targets", "at most", "measured", "undisturbed");
  for (const Target& target : targets)
    text += fmt::format("{:<76}{:>10}{:>10}{:>13} {:<6}{}{}\n", target.claim, fmt::format("{:g}", target.limit),
                        three_digits(target.measured), three_digits(target.undisturbed), target.unit, verdict(target),
                        target.where.starts_with("keyboard") || target.where.empty() ? "" : ", " + target.where);
  return text;
}

/// Median over the rows, of what is there.
double typical(const std::vector<Row>& rows, double (*value_of)(const Row&)) {
  std::vector<double> values;
  for (const Row& row : rows)
    if (!std::isnan(value_of(row))) values.push_back(value_of(row));
  return describe(values).median;
}

}  // namespace

std::string cell(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

std::string three_digits(double value) { return cell(value, value < 0.1 ? 4 : value < 10 ? 2 : value < 100 ? 1 : 0); }

std::string us_cell(double seconds) { return three_digits(1e6 * seconds); }

std::string noise_line(const std::vector<Row>& rows) {
  const double floor = typical(rows, [](const Row& row) { return row.noise.median; });
  const double floor99 = typical(rows, [](const Row& row) { return row.noise.p99; });
  const double floor999 = typical(rows, [](const Row& row) { return row.noise.p999; });
  return fmt::format("Noise floor: fixed work of {} us takes {} us (p99) and {} us (p99.9) in the typical row.\n",
                     us_cell(floor), us_cell(floor99), us_cell(floor999));
}

std::string memory_of_an_action() {
  constexpr std::size_t kAll = sizeof(Mechanism) + sizeof(State) + sizeof(Workspace);
  return fmt::format("{} bytes: Mechanism {}, State {}, Workspace {}", kAll, sizeof(Mechanism), sizeof(State),
                     sizeof(Workspace));
}

std::string table(const Results& results) {
  std::string text = circumstance_lines(results);
  if (!results.rows.empty()) {
    text += tick_lines(results.rows);
    text += step_lines(results.rows);
    text += fmt::format("\n{}", resting_line(results.rows));
    text += thesis_lines(results.rows);
    text += target_lines(results.rows);
  }
#ifndef __OPTIMIZE__
  text += "NOTE: built without optimisation, these are not the engine's times\n";
#endif
  if (!results.is_complete) text += "INTERRUPTED: not all that was planned\n";
  return text;
}

}  // namespace erard::bench
