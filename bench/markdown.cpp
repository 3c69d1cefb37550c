// The results as the tables of docs/performance.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/results.hpp"
#include "bench/targets.hpp"
#include "bench/thesis.hpp"

namespace erard::bench {
namespace {

constexpr double kMainRate_Hz = 2000;

/// "4.06", or "< 98.3" for a maximum that stands for p99.9.
std::string tail_cell(const Distribution& d) {
  return fmt::format("{}{}", std::isnan(d.p999) && d.count > 0 ? "< " : "", us_cell(d.tail()));
}

const Row* peer_of(const std::vector<Row>& rows, const Row& ours) {
  for (const Row& row : rows)
    if (row.engine != Engine::erard && row.scene == ours.scene && row.keys == ours.keys &&
        row.rate_Hz == ours.rate_Hz && row.substeps == ours.substeps && row.threads == ours.threads)
      return &row;
  return nullptr;
}

/// A table of erard's rows that `is_told`, or nothing where there is none.
std::string rows_as_table(const std::vector<Row>& rows, const std::string& title, const std::string& head,
                          const std::function<bool(const Row&)>& is_told,
                          const std::function<std::string(const Row&)>& line_of) {
  std::string lines;
  for (const Row& row : rows)
    if (row.engine == Engine::erard && row.felts == FeltModel::massless && is_told(row)) lines += line_of(row) + "\n";
  if (lines.empty()) return {};
  const auto columns = std::count(head.begin(), head.end(), '|') - 1;
  std::string rule = "|";
  for (long i = 0; i < columns; ++i) rule += "---|";
  return fmt::format("\n{}\n\n{}\n{}\n{}", title, head, rule, lines);
}

std::string strokes(const std::vector<Row>& rows) {
  return rows_as_table(
      rows, "One key at 2 kHz, a tick [us]; the last columns are MuJoCo's with the same number of steps:",
      "| scene | setting | undisturbed: median | p99 | max | as measured: median | p99.9 | eta % | RMS N | MuJoCo: "
      "undisturbed median | p99 | RMS N | times the peer |",
      [](const Row& row) { return row.keys == 1 && row.rate_Hz == kMainRate_Hz; },
      [&](const Row& r) {
        const Row none;
        const Row* found = peer_of(rows, r);
        const Row& peer = found != nullptr ? *found : none;
        return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |", r.scene, r.setting,
                           us_cell(r.undisturbed.median), us_cell(r.undisturbed.p99), us_cell(r.undisturbed.max),
                           us_cell(r.tick.median), tail_cell(r.tick), cell(100 * r.error.eta, 2),
                           cell(r.error.rms_N, 3), us_cell(peer.undisturbed.median), us_cell(peer.undisturbed.p99),
                           cell(peer.error.rms_N, 3), cell(r.times_peer_undisturbed, 2));
      });
}

std::string rates(const std::vector<Row>& rows) {
  return rows_as_table(
      rows, "One key at other rates, cheapest: a step a period:",
      "| scene | kHz | period us | undisturbed: median us | p99.9 | as measured: median | p99.9 | eta % |",
      [](const Row& row) { return row.keys == 1 && row.rate_Hz != kMainRate_Hz && row.setting != "default"; },
      [](const Row& r) {
        return fmt::format("| {} | {:g} | {:g} | {} | {} | {} | {} | {} |", r.scene, r.rate_Hz / 1000, 1e6 / r.rate_Hz,
                           us_cell(r.undisturbed.median), tail_cell(r.undisturbed), us_cell(r.tick.median),
                           tail_cell(r.tick), cell(100 * r.error.eta, 2));
      });
}

std::string keyboards(const std::vector<Row>& rows) {
  return rows_as_table(
      rows, "Many keys, all of them in one period [us]:",
      "| scene | keys | played | asleep | kHz | threads | lanes | setting | undisturbed: median | p99 | max | as "
      "measured: "
      "median "
      "| p99.9 | times the peer |",
      [](const Row& row) { return row.keys > 1; },
      [](const Row& r) {
        return fmt::format("| {} | {} | {} | {:.1f} | {:g} | {} | {} | {} | {} | {} | {} | {} | {} | {} |", r.scene,
                           r.keys, r.played, r.asleep, r.rate_Hz / 1000, r.threads, r.lanes, r.setting,
                           us_cell(r.undisturbed.median), us_cell(r.undisturbed.p99), us_cell(r.undisturbed.max),
                           us_cell(r.tick.median), tail_cell(r.tick), cell(r.times_peer_median, 2));
      });
}

std::string thesis(const std::vector<Row>& rows) {
  const std::vector<ThesisLine> lines = beside_thesis(rows);
  if (lines.empty()) return {};
  std::string text =
      "\nBeside the thesis: `piano` in steps of 0.5 ms, mean time of a step [us]:\n\n"
      "| model | thesis | here | undisturbed | times less |\n|---|---|---|---|---|\n";
  for (const ThesisLine& line : lines)
    text += fmt::format("| {} | {} | {} | {} | {} |\n", line.model, us_cell(line.thesis), us_cell(line.measured),
                        us_cell(line.undisturbed), cell(line.thesis / line.measured, 0));
  return text + "\n" + thesis_note();
}

std::string targets(const std::vector<Row>& rows) {
  std::string text =
      "\nTargets, judged by the times as measured:\n\n"
      "| target | at most | measured | undisturbed | | the worst of |\n|---|---|---|---|---|---|\n";
  for (const Target& each : targets_of(rows))
    text += fmt::format("| {} | {:g} {} | {} | {} | {} | {} |\n", each.claim, each.limit, each.unit,
                        three_digits(each.measured), three_digits(each.undisturbed), verdict(each), each.where);
  return text;
}

}  // namespace

std::string markdown(const Results& results) {
  const Circumstances& c = results.circumstances;
  std::string text = fmt::format("Commit {}, {}; {}, {}; {}; {}; damper {}. One action takes {}.\n", c.commit,
                                 c.compiler, c.cpu, c.kernel, c.scheduling, c.peer.empty() ? "no peer" : c.peer,
                                 results.has_damper ? "on" : "off", memory_of_an_action());
  text += noise_line(results.rows) + resting_line(results.rows);
  text += targets(results.rows);
  text += strokes(results.rows);
  text += rates(results.rows);
  text += keyboards(results.rows);
  text += thesis(results.rows);
  return text;
}

}  // namespace erard::bench
