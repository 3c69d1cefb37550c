#include "bench/results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "bench/targets.hpp"
#include "erard/mechanics/mechanism.hpp"
#include "erard/solver/workspace.hpp"
#include "src/device/json.hpp"

namespace erard::bench {
namespace {

/// One cell: text, or a number that may be missing (NaN).
struct Cell {
  std::string name;
  std::string text;
  double number = Distribution::kNone;
  bool is_text = false;
};

void add_times(std::vector<Cell>& cells, const std::string& what, const Distribution& d) {
  const std::pair<const char*, double> times[] = {{"min", d.min},   {"median", d.median}, {"p99", d.p99},
                                                  {"p999", d.p999}, {"p9999", d.p9999},   {"max", d.max}};
  for (const auto& [name, value] : times) cells.push_back({fmt::format("{}_{}_us", what, name), {}, 1e6 * value});
}

std::vector<Cell> cells_of(const Row& r) {
  std::vector<Cell> cells{{"engine", name_of(r.engine), 0, true},
                          {"scene", r.scene, 0, true},
                          {"keys", {}, static_cast<double>(r.keys)},
                          {"keys_played", {}, static_cast<double>(r.played)},
                          {"keys_asleep", {}, r.asleep},
                          {"threads", {}, static_cast<double>(r.threads)},
                          {"lanes", r.lanes, 0, true},
                          {"felts", name_of(r.felts), 0, true},
                          {"rate_Hz", {}, r.rate_Hz},
                          {"setting", r.setting, 0, true},
                          {"steps_a_period", {}, static_cast<double>(r.substeps)},
                          {"ticks", {}, static_cast<double>(r.tick.count)}};
  add_times(cells, "tick", r.tick);
  cells.push_back({"share_of_period", {}, r.share()});
  cells.push_back({"real_time_factor", {}, r.real_time_factor()});
  add_times(cells, "step", r.step);
  cells.push_back({"undisturbed_median_us", {}, 1e6 * r.undisturbed.median});
  cells.push_back({"undisturbed_p99_us", {}, 1e6 * r.undisturbed.p99});
  cells.push_back({"undisturbed_p999_us", {}, 1e6 * r.undisturbed.p999});
  cells.push_back({"undisturbed_max_us", {}, 1e6 * r.undisturbed.max});
  cells.push_back({"iterations_a_step", {}, r.iterations});
  cells.push_back({"sweeps_a_step", {}, r.sweeps});
  cells.push_back({"not_converged", {}, static_cast<double>(r.not_converged)});
  cells.push_back({"eta", {}, r.error.eta});
  cells.push_back({"rms_error_N", {}, r.error.rms_N});
  add_times(cells, "noise", r.noise);
  cells.push_back({"times_peer_median", {}, r.times_peer_median});
  cells.push_back({"times_peer_undisturbed", {}, r.times_peer_undisturbed});
  return cells;
}

/// Name and value of each circumstance.
std::vector<Cell> cells_of(const Results& results) {
  const Circumstances& c = results.circumstances;
  return {{"commit", c.commit, 0, true},
          {"compiler", c.compiler, 0, true},
          {"cpu", c.cpu, 0, true},
          {"kernel", c.kernel, 0, true},
          {"scheduling", c.scheduling, 0, true},
          {"clock_overhead_us", {}, 1e6 * c.clock_overhead},
          {"peer", c.peer.empty() ? "not installed" : c.peer, 0, true},
          {"damper", results.has_damper ? "on" : "off", 0, true},
          {"mechanism_bytes", {}, sizeof(Mechanism)},
          {"state_bytes", {}, sizeof(State)},
          {"workspace_bytes", {}, sizeof(Workspace)}};
}

std::vector<Cell> cells_of(const Target& target) {
  return {
      {"claim", target.claim, 0, true},     {"unit", target.unit, 0, true},          {"limit", {}, target.limit},
      {"measured", {}, target.measured},    {"undisturbed", {}, target.undisturbed}, {"scene", target.where, 0, true},
      {"verdict", verdict(target), 0, true}};
}

std::string plain(const Cell& cell) {
  if (cell.is_text) return cell.text;
  return std::isnan(cell.number) ? "" : fmt::format("{:.6g}", cell.number);
}

std::string object(const std::vector<Cell>& cells) {
  std::vector<std::string> members;
  for (const Cell& cell : cells)
    members.push_back(
        fmt::format("{}:{}", json::text(cell.name), cell.is_text ? json::text(cell.text) : json::number(cell.number)));
  return fmt::format("{{{}}}", fmt::join(members, ","));
}

}  // namespace

void write_csv(OutputFile& file, const Results& results) {
  for (const Cell& each : cells_of(results)) file.write(fmt::format("# {}: {}\n", each.name, plain(each)));
  file.write(fmt::format("# complete: {}\n", results.is_complete));
  const auto write_line = [&](const Row& row, const auto& text_of) {
    std::vector<std::string> cells;
    for (const Cell& each : cells_of(row)) cells.push_back(text_of(each));
    file.write(fmt::format("{}\n", fmt::join(cells, ",")));
  };
  write_line(Row{}, [](const Cell& each) { return each.name; });
  for (const Row& row : results.rows) write_line(row, plain);
}

void write_json(OutputFile& file, const Results& results) {
  std::vector<std::string> rows, targets;
  for (const Row& row : results.rows) rows.push_back(object(cells_of(row)));
  for (const Target& target : targets_of(results.rows)) targets.push_back(object(cells_of(target)));
  file.write(fmt::format("{{\"circumstances\":{},\"complete\":{},\n\"rows\":[\n{}\n],\n\"targets\":[\n{}\n]}}\n",
                         object(cells_of(results)), json::flag(results.is_complete), fmt::join(rows, ",\n"),
                         fmt::join(targets, ",\n")));
}

}  // namespace erard::bench
