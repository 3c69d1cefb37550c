// The results for people.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/results.hpp"

namespace erard::bench {
namespace {

/// "12.3", or "-" for what is not there.
std::string cell(double value, int digits) { return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits); }

/// Three digits that matter.
std::string time_cell(double seconds) {
  const double us = 1e6 * seconds;
  return cell(us, us < 10 ? 2 : us < 100 ? 1 : 0);
}

/// Which entrant: the first columns of both tables.
std::string entrant_of(const Row& r) {
  return fmt::format("{:<7}{:<14}{:>4}{:>6.0f} {:<9}{:>3}", name_of(r.engine), r.scene, r.keys, r.rate_Hz, r.setting,
                     r.substeps);
}
std::string entrant_head() {
  return fmt::format("{:<7}{:<14}{:>4}{:>6} {:<9}{:>3}", "engine", "scene", "keys", "Hz", "setting", "n");
}

std::string times_of(const Row& r) {
  const Distribution& t = r.tick;
  const auto share = fmt::format("{}{}", std::isnan(t.p999) ? "<" : "", cell(100 * r.share(), 1));
  return fmt::format("{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>7}{:>8}\n", t.count, time_cell(t.min),
                     time_cell(t.median), time_cell(t.p99), time_cell(t.p999), time_cell(t.p9999), time_cell(t.max),
                     share, cell(r.real_time_factor(), r.real_time_factor() < 10 ? 2 : 0), time_cell(r.noise.tail()));
}
std::string times_head() {
  return fmt::format("{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>7}{:>8}\n", "ticks", "min", "median", "p99", "p99.9",
                     "p99.99", "max", "% of T", "x real", "noise");
}

std::string work_of(const Row& r) {
  return fmt::format("{:>8}{:>8}{:>10}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>10}{:>8}\n", time_cell(r.step.median),
                     time_cell(r.step.p999), time_cell(r.undisturbed.median), time_cell(r.undisturbed.p99),
                     time_cell(r.undisturbed.max), cell(r.iterations, 1), cell(r.sweeps, 1), cell(100 * r.error.eta, 2),
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

/// Median over the rows, of what is there.
double typical(const std::vector<Row>& rows, double (*value_of)(const Row&)) {
  std::vector<double> values;
  for (const Row& row : rows)
    if (!std::isnan(value_of(row))) values.push_back(value_of(row));
  return describe(values).median;
}

}  // namespace

std::string table(const Results& results) {
  std::string text;
  const Circumstances& c = results.circumstances;
  const std::pair<const char*, std::string> lines[] = {
      {"commit", c.commit},
      {"compiler", c.compiler},
      {"machine", fmt::format("{}, {}", c.cpu, c.kernel)},
      {"scheduling", c.scheduling},
      {"clock", fmt::format("{:.0f} ns a look, subtracted", 1e9 * c.clock_overhead)},
      {"peer", c.peer.empty() ? "not installed" : c.peer},
      {"damper", results.has_damper ? "on" : "off"}};
  for (const auto& [name, value] : lines) text += fmt::format("{:<12} {}\n", name, value);
  text += fmt::format("\n{:43}one period of all keys, a tick [us]\n{}{}", "", entrant_head(), times_head());
  text += all_lines(results.rows, times_of);
  const double floor = typical(results.rows, [](const Row& row) { return row.noise.median; });
  const double floor99 = typical(results.rows, [](const Row& row) { return row.noise.p99; });
  const double floor999 = typical(results.rows, [](const Row& row) { return row.noise.p999; });
  text += fmt::format(
      "\nnoise floor: fixed work of {} us takes {} us (p99) and {} us (p99.9) in the typical row; the last column has "
      "its p99.9\n",
      time_cell(floor), time_cell(floor99), time_cell(floor999));
  text +=
      "n: internal steps a period; % of T: p99.9 of the tick (<: its maximum, for want of samples) as a share of the "
      "period;\n-: not measured, or too few samples to tell\n";
  text += fmt::format("\n{:43}{:>16}{:>26}{:>16}{:>16}{:>18}\n{}{}", "", "one step [us]", "undisturbed tick [us]",
                      "a step", "error of force", "times the peer", entrant_head(), work_head());
  std::vector<Row> told = results.rows;
  std::erase_if(told, [](const Row& row) { return row.step.count == 0 && std::isnan(row.times_peer_median); });
  text += all_lines(told, work_of);
  text +=
      "undisturbed: each tick of the scene at its fastest of all passes; eta, RMS: up to the release, against 5 us "
      "steps of the same engine\n";
#ifndef __OPTIMIZE__
  text += "NOTE: built without optimisation, these are not the engine's times\n";
#endif
  if (!results.is_complete) text += "INTERRUPTED: not all that was planned\n";
  return text;
}

}  // namespace erard::bench
