#include "erard/device/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>

#include "erard/device/error.hpp"
#include "erard/version.hpp"
#include "json.hpp"
#include "web_assets.hpp"

namespace erard {
namespace {

using Path = std::filesystem::path;

constexpr std::string_view kRunStart = "<script type=\"application/json\" id=\"run\">";
constexpr std::string_view kScriptEnd = "</script>";

std::string floats_json(const std::vector<float>& values) {
  return '"' + json::base64(reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(float)) + '"';
}

std::string rows_json(const ReportRows& rows) {
  return fmt::format(R"({{"count":{},"start_s":{:.12g},"period_s":{:.12g},"stride":{},"columns":{},"data":{}}})",
                     rows.count(), rows.start(), rows.period(), rows.stride(), json::list(rows.columns(), json::text),
                     floats_json(rows.by_column()));
}

std::string event_json(const Event& e) {
  return fmt::format(R"({{"name":"{}","time_s":{:.9g},"strike":{},"hammer_speed_m_per_s":{},"y_m":{},"force_N":{}}})",
                     name_of(e.kind), e.time, e.strike, json::number(e.hammer_speed), json::number(e.key_position),
                     json::number(e.force));
}

std::string measure_json(const Measure& m) {
  return fmt::format(R"({{"name":{},"unit":{},"values":{},"low":{},"high":{},"source":{},"how":{},"scale_g":{}}})",
                     json::text(m.name), json::text(m.unit), json::list(m.values, json::number), json::number(m.low),
                     json::number(m.high), json::text(m.source), json::text(m.how), json::number(m.scale_g));
}

/// What a reader must know before anything else: {"level", "text"}.
std::string status_json(const RunSummary& s) {
  const RunResult& r = s.result;
  const double end = s.start + static_cast<double>(r.periods) * s.tick.period;
  std::string level = "good", text = "complete, every step converged";
  if (r.not_converged > 0) {
    level = "note";
    text = fmt::format("complete, but {} of {} steps met the solver's limit of iterations before its tolerance",
                       r.not_converged, r.steps);
  }
  if (!r.is_complete) {
    level = "bad";
    text = fmt::format("INTERRUPTED at {:.4f} s; what follows is complete up to there", end);
  }
  if (!r.is_finite) {
    level = "bad";
    text = fmt::format("FAILED after {:.6f} s: a number was not finite; what follows is the run up to there", end);
  }
  return fmt::format(R"({{"level":"{}","text":"{}"}})", level, text);
}

std::string run_json(const Report& report) {
  const RunSummary& s = *report.summary;
  const double steps = static_cast<double>(std::max(s.result.steps, 1L));
  std::string out = fmt::format(
      R"({{"version":"{}","action":{},"keystroke":{},"drive":"{}","rate_Hz":{:.9g},"substeps":{})", kVersion,
      json::text(Path(s.action).filename().string()), json::text(Path(s.keystroke).filename().string()),
      name_of(s.tick.drive), 1 / s.tick.period, s.tick.substeps);
  out += fmt::format(R"(,"status":{},"steps":{},"linearisations_a_step":{:.3g},"sweeps_a_step":{:.3g})", status_json(s),
                     s.result.steps, static_cast<double>(s.result.linearisations) / steps,
                     static_cast<double>(s.result.sweeps) / steps);
  out += fmt::format(R"(,"peak_force_N":{},"peak_force_time_s":{},"events_lost":{})", json::number(s.result.peak_force),
                     json::number(s.result.peak_force_time), s.result.events_lost);
  out += ",\"events\":" + json::list(s.result.events, event_json);
  out += ",\"measures\":" + json::list(report.measures, measure_json);
  out += ",\"scene\":" + scene_json(*report.scene);
  return out + ",\"rows\":" + rows_json(*report.rows) + "}";
}

std::string other_json(const Report& report) {
  if (report.other == nullptr) return "null";
  const OtherRun& other = *report.other;
  std::string out = "{\"name\":" + json::text(other.name);
  if (report.summary->comparison)
    out += fmt::format(R"(,"eta":{},"until_s":{})", json::number(report.summary->comparison->eta),
                       json::number(report.summary->comparison->until));
  if (!other.run_json.empty()) return out + ",\"run\":" + other.run_json + "}";
  std::vector<float> force(other.force.force.begin(), other.force.force.end());
  // times as they are: a single-precision time of a long recording is too coarse
  return out + ",\"time_s\":" + json::list(other.force.time, json::number) + ",\"force_N\":" + floats_json(force) + "}";
}

/// The page with every {{name}} replaced: a file of web/, or one of the two blocks of data.
std::string fill_page(const std::string& run, const std::string& other) {
  const std::string_view page = web_asset("report.html");
  std::string out;
  std::size_t at = 0;
  for (std::size_t open = page.find("{{"); open != std::string_view::npos; open = page.find("{{", at)) {
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    out += page.substr(at, open - at);
    out += name == "run" ? std::string_view(run) : name == "other" ? std::string_view(other) : web_asset(name);
    at = close + 2;
  }
  return out += page.substr(at);
}

/// The block of data of a report; empty when there is none that may be copied.
std::string read_run_json(const Path& report) {
  std::ifstream file(report, std::ios::binary);
  const std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t start = page.find(kRunStart);
  if (start == std::string::npos) return {};
  const std::size_t from = start + kRunStart.size(), to = page.find(kScriptEnd, from);
  const std::string block = page.substr(from, to == std::string::npos ? 0 : to - from);
  // ours have no markup in them: anything else is not ours
  return block.find_first_of("<>&") == std::string::npos ? block : std::string();
}

double time_of_word(const std::string& word, const Report& report) {
  char* end = nullptr;
  const double time = std::strtod(word.c_str(), &end);
  if (!word.empty() && *end == '\0' && std::isfinite(time)) return time;
  for (const Event& event : report.summary->result.events)
    if (word == name_of(event.kind)) return event.time;
  throw InputError(
      fmt::format("--svg {}: must be a time in s or an event of this run, such as jack_meets_let_off", word));
}

}  // namespace

OtherRun read_other_run(const Path& path) {
  OtherRun other;
  other.name = path.string();
  const bool is_folder = std::filesystem::is_directory(path);
  other.force = read_force_curve(is_folder ? path / "trajectory.csv" : path);
  if (is_folder) other.run_json = read_run_json(path / "report.html");
  return other;
}

void write_report(OutputFile& file, const Report& report) {
  file.write(fill_page(run_json(report), other_json(report)));
}

std::vector<Path> write_poses(const Path& folder, const std::vector<std::string>& words, const Report& report) {
  std::vector<Path> files;
  for (const std::string& word : words) {
    const Snapshot pose = report.rows->snapshot(report.rows->row_at(time_of_word(word, report)));
    files.push_back(folder / ("pose_" + word + ".svg"));
    OutputFile file(files.back());
    file.write(draw_svg(*report.scene, pose, report.summary->tick.drive,
                        fmt::format("{:.2f} ms   key down {:.2f} mm   finger {:.2f} N", 1e3 * pose.time,
                                    1e3 * pose.key_position, pose.force)));
    file.commit();
  }
  return files;
}

}  // namespace erard
