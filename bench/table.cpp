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

std::string line_of(const Row& r) {
  const auto share = fmt::format("{}{}", std::isnan(r.tick.p999) ? "<" : "", cell(100 * r.share(), 1));
  return fmt::format(
      "{:<7}{:<14}{:>4}{:>6.0f} {:<9}{:>3}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>7}{:>8}{:>6}{:>7}{:>7}{:>8}"
      "{:>8}\n",
      name_of(r.engine), r.scene, r.keys, r.rate_Hz, r.setting, r.substeps, r.tick.count, time_cell(r.tick.min),
      time_cell(r.tick.median), time_cell(r.tick.p99), time_cell(r.tick.p999), time_cell(r.tick.p9999),
      time_cell(r.tick.max), share, cell(r.real_time_factor(), r.real_time_factor() < 10 ? 2 : 0),
      time_cell(r.step.median), time_cell(r.step.p999), cell(r.iterations, 1), cell(r.sweeps, 1),
      cell(100 * r.error.eta, 2), cell(r.error.rms_N, 3), time_cell(r.noise.tail()));
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
  text += fmt::format("\n{:<40}{:^72}{:^16}\n", "", "tick, all keys [us]", "step [us]");
  text += fmt::format(
      "{:<7}{:<14}{:>4}{:>6} {:<9}{:>3}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>7}{:>8}{:>6}{:>7}{:>7}{:>8}{:>8}"
      "\n",
      "engine", "scene", "keys", "Hz", "setting", "n", "ticks", "min", "median", "p99", "p99.9", "p99.99", "max",
      "% of T", "x real", "median", "p99.9", "iter", "sweeps", "eta %", "RMS N", "noise");
  std::string scene;
  for (const Row& row : results.rows) {
    if (!scene.empty() && row.scene != scene) text += "\n";
    scene = row.scene;
    text += line_of(row);
  }
  const double floor = typical(results.rows, [](const Row& row) { return row.noise.median; });
  const double floor99 = typical(results.rows, [](const Row& row) { return row.noise.p99; });
  const double floor999 = typical(results.rows, [](const Row& row) { return row.noise.p999; });
  text += fmt::format(
      "\nnoise floor: fixed work of {} us takes {} us (p99) and {} us (p99.9) in the typical row; the last column has "
      "its p99.9\n",
      time_cell(floor), time_cell(floor99), time_cell(floor999));
  text +=
      "n: internal steps a period; % of T: p99.9 of the tick (< : its maximum, for want of samples) as a share of the "
      "period;\niter, sweeps: a step; eta, RMS: force up to the release against 5 us steps of the same engine; -: not "
      "measured or too few samples\n";
  for (const Row& row : results.rows)
    if (!std::isnan(row.times_peer_median))
      text += fmt::format(
          "{:<14} {:>3} keys {:>6.0f} Hz {:<9} erard takes {:.2f} times as long as the peer (median; "
          "minimum {:.2f})\n",
          row.scene, row.keys, row.rate_Hz, row.setting, row.times_peer_median, row.times_peer_min);
  if (!results.is_complete) text += "INTERRUPTED: not all that was planned\n";
  return text;
}

}  // namespace erard::bench
