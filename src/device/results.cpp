#include "erard/device/results.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <iterator>
#include <string>

namespace erard {
namespace {

constexpr double kLongestGoodStep = 5.0001e-4;  // [s] 5 % error in forte; 1 ms 8 %, 2.5 ms 19 % and other events

void emit_summary(YAML::Emitter& out, const RunSummary& s) {
  const RunResult& r = s.result;
  const double simulated = static_cast<double>(r.periods) * s.tick.period;
  out << YAML::Key << "action" << YAML::Value << s.action;
  out << YAML::Key << "keystroke" << YAML::Value << s.keystroke;
  out << YAML::Key << "drive" << YAML::Value << name_of(s.tick.drive);
  out << YAML::Key << "rate_Hz" << YAML::Value << 1 / s.tick.period;
  out << YAML::Key << "substeps" << YAML::Value << s.tick.substeps;
  out << YAML::Key << "refinement" << YAML::Value << s.tick.refinement;
  out << YAML::Key << "theta" << YAML::Value << s.tick.scheme.theta;
  out << YAML::Key << "start_s" << YAML::Value << s.start;
  out << YAML::Key << "simulated_s" << YAML::Value << simulated;
  out << YAML::Key << "complete" << YAML::Value << (r.is_complete && r.is_finite);
  out << YAML::Key << "stopped_by" << YAML::Value
      << (!r.is_finite    ? "a step that was not finite"
          : r.is_complete ? "end of the run"
                          : "interrupt");
  out << YAML::Key << "force_peak_N" << YAML::Value << r.peak_force;
  out << YAML::Key << "force_peak_time_s" << YAML::Value << r.peak_force_time;
  out << YAML::Key << "periods" << YAML::Value << r.periods;
  out << YAML::Key << "steps" << YAML::Value << r.steps;
  out << YAML::Key << "linearisations" << YAML::Value << r.linearisations;
  out << YAML::Key << "sweeps" << YAML::Value << r.sweeps;
  out << YAML::Key << "steps_not_converged" << YAML::Value << r.not_converged;
  if (r.events_lost > 0) out << YAML::Key << "events_lost" << YAML::Value << r.events_lost;
  if (!s.comparison) return;
  out << YAML::Key << "compared_with" << YAML::Value << s.comparison->file;
  out << YAML::Key << "compared_from_s" << YAML::Value << s.comparison->from;
  out << YAML::Key << "compared_until_s" << YAML::Value << s.comparison->until;
  out << YAML::Key << "eta" << YAML::Value << s.comparison->eta;
}

void write_yaml(OutputFile& file, const YAML::Emitter& out) {
  file.write(out.c_str());
  file.write("\n");
}

std::string words(std::string name) {
  for (char& c : name)
    if (c == '_') c = ' ';
  return name;
}

}  // namespace

const char* name_of(DriveKind drive) {
  switch (drive) {
    case DriveKind::force: return "force";
    case DriveKind::piston: return "piston";
    case DriveKind::key: return "key";
    default: return "none";
  }
}

TrajectoryFile::TrajectoryFile(OutputFile& file, const Model& model) : file_(file) {
  line_ = "t_s,input,y_m,force_N";
  for (const char* prefix : {"theta", "omega"})
    for (int i = 0; i < model.body_count; ++i)
      fmt::format_to(std::back_inserter(line_), ",{}_{}", prefix, model.bodies[i].name.view());
  for (int c = 0; c < model.contact_count; ++c)
    fmt::format_to(std::back_inserter(line_), ",delta_{}_m", model.contacts[c].name.view());
  for (int c = 0; c < model.contact_count; ++c)
    fmt::format_to(std::back_inserter(line_), ",normal_{}_N", model.contacts[c].name.view());
  file_.write(line_ + "\n");
}

void TrajectoryFile::add(const Snapshot& row) {
  line_.clear();
  fmt::format_to(std::back_inserter(line_), "{:.9g},{:.9g},{:.9g},{:.9g}", row.time, row.input.value, row.key_position,
                 row.force);
  for (const auto* column : {&row.angle, &row.rate, &row.compression, &row.normal})
    for (const double value : *column) fmt::format_to(std::back_inserter(line_), ",{:.9g}", value);
  file_.write(line_ + "\n");
}

void ProblemFile::add(const OneStepProblem& problem, const RowVector& impulse, double time) {
  const int m = problem.size;
  std::string line = fmt::format("{{\"time_s\":{:.9g},\"W\":[", time);
  const auto out = std::back_inserter(line);
  const auto list = [&out, m](const auto& value_of) {
    for (int i = 0; i < m; ++i) fmt::format_to(out, "{}{:.17g}", i == 0 ? "" : ",", value_of(i));
  };
  for (int i = 0; i < m; ++i) {
    fmt::format_to(out, "{}[", i == 0 ? "" : ",");
    list([&](int j) { return problem.W(i, j); });
    fmt::format_to(out, "]");
  }
  fmt::format_to(out, "],\"q\":[");
  list([&](int i) { return problem.q[i]; });
  fmt::format_to(out, "],\"r\":[");
  list([&](int i) { return impulse[i]; });
  fmt::format_to(out, "],\"cone\":[");
  for (int i = 0; i < m; ++i) {
    const Cone& cone = problem.cone[i];
    if (i > 0) fmt::format_to(out, ",");
    if (cone.kind == ConeKind::half_line) fmt::format_to(out, "{{\"kind\":\"half_line\"}}");
    if (cone.kind == ConeKind::friction)
      fmt::format_to(out, "{{\"kind\":\"friction\",\"normal\":{},\"mu\":{:.17g}}}", cone.normal, cone.bound);
    if (cone.kind == ConeKind::interval)
      fmt::format_to(out, "{{\"kind\":\"interval\",\"bound\":{:.17g},\"angular\":{}}}", cone.bound, cone.is_angular);
  }
  fmt::format_to(out, "]}}\n");
  file_.write(line);
}

void write_events(OutputFile& file, const std::vector<Event>& events) {
  YAML::Emitter out;
  out.SetDoublePrecision(9);
  out << YAML::BeginSeq;
  for (const Event& event : events) {
    out << YAML::BeginMap;
    out << YAML::Key << "name" << YAML::Value << name_of(event.kind);
    out << YAML::Key << "time_s" << YAML::Value << event.time;
    out << YAML::Key << "strike" << YAML::Value << event.strike;
    out << YAML::Key << "hammer_speed_m_per_s" << YAML::Value << event.hammer_speed;
    out << YAML::Key << "y_m" << YAML::Value << event.key_position;
    out << YAML::Key << "force_N" << YAML::Value << event.force;
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
  write_yaml(file, out);
}

void write_summary(OutputFile& file, const RunSummary& summary) {
  YAML::Emitter out;
  out.SetDoublePrecision(9);
  out << YAML::BeginMap;
  emit_summary(out, summary);
  // not part of what two runs share: how fast this machine was
  const RunResult& r = summary.result;
  const double simulated = static_cast<double>(r.periods) * summary.tick.period;
  out << YAML::Key << "real_time_factor" << YAML::Value << simulated / std::max(r.computing_time, 1e-9);
  out << YAML::Key << "computing_s" << YAML::Value << r.computing_time;
  out << YAML::Key << "tick_median_s" << YAML::Value << r.tick_time.quantile(0.5);
  out << YAML::Key << "tick_p99_s" << YAML::Value << r.tick_time.quantile(0.99);
  out << YAML::Key << "tick_worst_s" << YAML::Value << r.tick_time.worst();
  out << YAML::EndMap;
  write_yaml(file, out);
}

std::string describe(const RunSummary& s) {
  const RunResult& r = s.result;
  const double simulated = static_cast<double>(r.periods) * s.tick.period;
  const double steps = static_cast<double>(std::max(r.steps, 1L));
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "action       {}\n", s.action);
  fmt::format_to(out, "keystroke    {}, {:.3f} s, drive {}\n", s.keystroke, simulated, name_of(s.tick.drive));
  fmt::format_to(out, "finger       peak {:.2f} N at {:.1f} ms\n", r.peak_force, 1e3 * r.peak_force_time);
  if (!r.events.empty())
    fmt::format_to(out, "\n  strike      time  event                  hammer speed  key down    force\n");
  for (const Event& e : r.events)
    fmt::format_to(out, "  {:>6} {:>6.1f} ms  {:<21} {:>9.3f} m/s {:>6.2f} mm {:>6.2f} N\n", e.strike, 1e3 * e.time,
                   words(name_of(e.kind)), e.hammer_speed, 1e3 * e.key_position, e.force);
  if (!r.events.empty()) text += "\n";
  if (s.comparison)
    fmt::format_to(out, "error        eta {:.2f} % of the force in {}, {:.3f} to {:.3f} s (thesis 6.3)\n",
                   100 * s.comparison->eta, s.comparison->file, s.comparison->from, s.comparison->until);
  fmt::format_to(out,
                 "speed        {:.0f} times faster than real time; a period of {:.0f} us takes {:.1f} us (median; 99 % "
                 "{:.1f}, worst {:.0f}), "
                 "a step {:.2f} us\n",
                 simulated / std::max(r.computing_time, 1e-9), 1e6 * s.tick.period, 1e6 * r.tick_time.quantile(0.5),
                 1e6 * r.tick_time.quantile(0.99), 1e6 * r.tick_time.worst(), 1e6 * r.computing_time / steps);
  fmt::format_to(out, "solver       {} steps of {:.1f}", r.steps, 1e6 * s.tick.scheme.time_step);
  if (s.tick.refinement > 1) fmt::format_to(out, " to {:.1f}", 1e6 * s.tick.scheme.time_step / s.tick.refinement);
  fmt::format_to(out, " us ({:.1f} a period): {:.2f} linearisations, {:.2f} sweeps each",
                 static_cast<double>(r.steps) / std::max(1.0, static_cast<double>(r.periods)),
                 static_cast<double>(r.linearisations) / steps, static_cast<double>(r.sweeps) / steps);
  fmt::format_to(out, ", {} not converged\n", r.not_converged);
  if (s.tick.scheme.time_step > kLongestGoodStep)
    fmt::format_to(out, "NOTE         steps beyond {:.0f} us miss impacts on felts; --substeps makes them shorter\n",
                   1e6 * kLongestGoodStep);
  if (!r.is_finite) fmt::format_to(out, "STOPPED      a number was not finite after {:.6f} s\n", simulated);
  if (!r.is_complete) fmt::format_to(out, "INTERRUPTED  after {:.3f} s; what is complete was kept\n", simulated);
  return text;
}

}  // namespace erard
