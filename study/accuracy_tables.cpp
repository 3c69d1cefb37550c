#include "study/accuracy_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "erard/device/force_curve.hpp"
#include "study/figure.hpp"
#include "study/section.hpp"

namespace erard::study {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr int kRepeats = 7;  // of every run that is timed

/// The default's kind of step, calm ones of this length, retaken in four.
Candidate surprised(double calm) {
  if (calm == kCalmStep) return default_ticks();
  return ticking(default_ticks().family, fmt::format("{:g} us", 1e6 * calm), surprised_steps(calm, kSurpriseLimit, 4));
}

std::string cell(const ForceError& e) { return fmt::format("{:.2f} / {:.4f} / {:.2f}", 100 * e.eta, e.rms, e.largest); }

}  // namespace

Reference make_reference(const ActionFile& action, const JudgedStroke& stroke) {
  return {stroke, play_judged(action, stroke, converged_steps()), play_judged(action, stroke, converged_steps(100))};
}

Candidate default_ticks() { return ticking("refused when surprised", "250 us (default)", TickSettings{}); }

ForceError error_of(const JudgedRun& run, const Reference& reference) {
  return force_error(run, reference.truth, reference.stroke.end);
}

std::vector<Candidate> candidates() {
  std::vector<Candidate> list;
  for (const double calm : {5e-4, 2.5e-4, 1.25e-4, 6.25e-5}) list.push_back(surprised(calm));
  for (const double theta : {0.5, 0.52, 0.55, 1.0})
    for (const double step : {2.5e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5, 3.125e-5, 1e-5, 5e-6})
      list.push_back(fixed_steps(theta, step));
  for (const int count : {1, 2, 4, 8}) list.push_back(fractional_steps(count));
  for (const int count : {1, 2, 4, 8}) list.push_back(extrapolated_steps(count));
  return list;
}

std::string default_table(const ActionFile& action, const std::vector<Reference>& references) {
  Rows rows;
  for (const Reference& r : references) {
    const JudgedRun run = play_judged(action, r.stroke, default_ticks(), kRepeats);
    const ForceError before = force_error(run, r.truth, r.stroke.check);
    rows.push_back({r.stroke.name, fmt::format("{:.1f}", *std::max_element(r.truth.force.begin(), r.truth.force.end())),
                    cell(error_of(run, r)),
                    r.stroke.check > 0 ? fmt::format("{:.4f} / {:.2f}", before.rms, before.largest) : "",
                    fmt::format("{:.2f}", run.steps), fmt::format("{:.1f}", run.cost), fmt::format("{:.0f}", run.worst),
                    fmt::format("{} of {:.0f}", run.unconverged, run.steps * r.stroke.played / kOutputPeriod),
                    fmt::format("{:.5f}", error_of(r.half, r).rms)});
  }
  return table({"stroke", "peak N", "eta % / RMS N / largest N", "before the check, RMS / largest N", "steps a tick",
                "us a tick", "dearest tick us", "steps not converged", "100 against 200 steps, RMS N"},
               rows);
}

std::string event_table(const ActionFile& action, const std::vector<Reference>& references) {
  Rows rows;
  for (const Reference& r : references) {
    const EventError e = event_error(play_judged(action, r.stroke, default_ticks()), r.truth);
    rows.push_back({r.stroke.name, fmt::format("{}", e.compared + e.missing), fmt::format("{}", e.missing),
                    fmt::format("{}", e.beyond), fmt::format("{:+.2f} ({})", 1e3 * e.time, name_of(e.worst)),
                    e.speed_at > 0 ? fmt::format("{:+.2f} (at {:.2f} m/s)", 100 * e.speed, e.speed_at) : "no blow"});
  }
  return table({"stroke", "events", "not found", "beyond 0.25 ms", "largest error of a time, ms",
                "largest error of a blow's speed, %"},
               rows);
}

std::string ringing_table(const ActionFile& action, const std::vector<Reference>& references) {
  Rows rows;
  for (const auto& [index, from, until] : {std::tuple{0, 0.14, 0.20}, {1, 0.08, 0.12}}) {
    const Reference& r = references[static_cast<std::size_t>(index)];
    const RailRinging ours = rail_ringing(play_judged(action, r.stroke, default_ticks()), from, until);
    const RailRinging truth = rail_ringing(r.truth, from, until);
    rows.push_back({r.stroke.name, fmt::format("{:.2f} ({:.2f})", ours.frequency, truth.frequency),
                    fmt::format("{:.2f} ({:.2f})", 1e6 * ours.amplitude, 1e6 * truth.amplitude)});
  }
  return table({"stroke", "Hz (converged)", "amplitude of the key, um (converged)"}, rows);
}

std::string independent_table(const ActionFile& action, const std::vector<Reference>& references,
                              const std::filesystem::path& folder) {
  const auto against = [&](const Reference& r, const JudgedRun& run) {
    ForceCurve curve;
    for (std::size_t i = 0; i < run.force.size(); ++i) {
      curve.time.push_back(static_cast<double>(i) * run.period);
      curve.force.push_back(run.force[i]);
    }
    return fmt::format("{:.2f}",
                       100 * relative_error(read_force_curve(folder / (r.stroke.name + ".csv")), curve, r.stroke.end));
  };
  Rows rows;
  for (const Candidate& c : {default_ticks(), fixed_steps(0.5, 5e-4), fixed_steps(0.5, 2.5e-4),
                             fixed_steps(0.5, 1.25e-4), fixed_steps(0.5, 6.25e-5), converged_steps()}) {
    std::vector<std::string> row{c.family + ", " + c.setting};
    for (int i = 0; i < 2; ++i) {
      const Reference& r = references[static_cast<std::size_t>(i)];
      row.push_back(against(r, play_judged(action, r.stroke, c)));
    }
    rows.push_back(row);
  }
  return table({"against the independent simulation, eta %", "piano", "forte"}, rows);
}

Judgement judge(const ActionFile& action, const Candidate& candidate, const std::vector<Reference>& references) {
  Judgement judgement{candidate, {}, {}};
  for (const Reference& r : references) {
    const JudgedRun run = play_judged(action, r.stroke, candidate, kRepeats);
    judgement.error.push_back(error_of(run, r));
    judgement.cost.push_back(run.cost);
  }
  return judgement;
}

std::string judgement_table(const std::vector<Judgement>& all, const std::vector<Reference>& references) {
  std::vector<std::string> head{"scheme", "steps"};
  for (const Reference& r : references) head.push_back(r.stroke.name);
  head.push_back("us a tick (the first; the dearest stroke)");
  Rows rows;
  for (const Judgement& j : all) {
    rows.push_back({j.candidate.family, j.candidate.setting});
    for (const ForceError& e : j.error) rows.back().push_back(cell(e));
    rows.back().push_back(fmt::format("{:.1f}; {:.1f}", j.cost[0], *std::max_element(j.cost.begin(), j.cost.end())));
  }
  return table(head, rows);
}

void draw_diagram(const std::filesystem::path& svg, const std::vector<Judgement>& all,
                  const std::vector<Reference>& references) {
  // the winner's first; red is nobody else's
  constexpr std::array kColours{"d62728", "1f77b4", "17becf", "2ca02c", "7f7f7f",
                                "9467bd", "ff7f0e", "8c564b", "000000"};
  std::vector<Panel> panels;
  for (std::size_t s = 0; s < references.size(); ++s) {
    Panel panel{references[s].stroke.name,
                {"computing time of a tick of 0.5 ms [us]", {0.3, 300}, true},
                {"error of the force, RMS [N]", {1e-6, 10}, true},
                {},
                s == 0 ? "bottom left reverse Left samplen 1.5 spacing 0.9 font ',10'" : "off"};
    Curve chosen{"the default", {}, {}, "points pt 7 ps 1.4 lc rgb '#d62728'"};
    for (const Judgement& j : all) {
      const std::string& family = j.candidate.family;
      if (panel.curves.empty() || panel.curves.back().label != family) {
        const std::size_t number = panel.curves.size();
        panel.curves.push_back(
            {family,
             {},
             {},
             fmt::format("linespoints pt 7 ps {} lw {} lc rgb '#{}'", number + 1 < kColours.size() ? 0.4 : 1.0,
                         number == 0 ? 3 : 1, kColours[number % kColours.size()])});
      }
      panel.curves.back().x.push_back(j.cost[s]);
      panel.curves.back().y.push_back(j.error[s].rms);
      if (j.candidate.setting != default_ticks().setting) continue;
      chosen.x = {j.cost[s]};
      chosen.y = {j.error[s].rms};
    }
    panel.curves.push_back(chosen);
    panels.push_back(panel);
  }
  draw(svg, panels, 3, 430, 520);
}

std::string surprise_table(const ActionFile& action, const std::vector<Reference>& references) {
  Rows rows;
  for (const double limit : {1., 3., 10., 30., 100.})
    for (const int refinement : {2, 4, 8}) {
      const Judgement j = judge(action, ticking("", "", surprised_steps(kCalmStep, limit, refinement)), references);
      rows.push_back({fmt::format("{:g}", limit), fmt::format("{}", refinement)});
      for (std::size_t i = 0; i < references.size(); ++i)
        rows.back().push_back(fmt::format("{:.4f} / {:.2f}, {:.1f} us", j.error[i].rms, j.error[i].largest, j.cost[i]));
    }
  std::vector<std::string> head{"surprise limit, m/s^2", "refinement"};
  for (const Reference& r : references) head.push_back(r.stroke.name + ", RMS / largest N, a tick");
  return table(head, rows);
}

std::string tolerance_table(const ActionFile& action, const std::vector<Reference>& references) {
  TickSettings tight;
  tight.scheme.newton_limit = 40;
  tight.scheme.newton_tolerance = 1e-6;
  tight.scheme.placement_tolerance = 1e-3;
  tight.scheme.sweep_tolerance = 1e-9;
  tight.scheme.sweep_limit = 2000;
  std::vector<std::pair<std::string, TickSettings>> list{{"default", {}}};
  const auto add = [&](const std::string& name, auto change) {
    list.emplace_back(name, TickSettings{});
    change(list.back().second.scheme);
  };
  for (const double x : {1e-1, 1e-3, 1e-6})
    add(fmt::format("newton_tolerance {:g}", x), [x](Scheme& s) { s.newton_tolerance = x; });
  for (const double x : {1e9, 1e-2, 1e-3})
    add(x > 1 ? "frames placed once a step" : fmt::format("placement_tolerance {:g}", x),
        [x](Scheme& s) { s.placement_tolerance = x; });
  for (const double x : {1e-4, 1e-9})
    add(fmt::format("sweep_tolerance {:g}", x), [x](Scheme& s) { s.sweep_tolerance = x; });
  for (const int x : {30, 1000}) add(fmt::format("sweep_limit {}", x), [x](Scheme& s) { s.sweep_limit = x; });
  add("friction never recalled", [](Scheme& s) { s.is_friction_recalled = false; });
  list.emplace_back("all tight", tight);
  Rows rows;
  for (const auto& [name, settings] : list) {
    rows.push_back({name});
    for (const Reference& r : references) {
      const JudgedRun base = play_judged(action, r.stroke, ticking("", "", tight));
      const JudgedRun run = play_judged(action, r.stroke, ticking("", "", settings), kRepeats);
      const ForceError e = force_error(run, base, r.stroke.end);
      rows.back().push_back(fmt::format("{:.4f} / {:.3f}, {:.1f} us", e.rms, e.largest, run.cost));
    }
  }
  std::vector<std::string> head{"setting"};
  for (const Reference& r : references) head.push_back(r.stroke.name + ", RMS / largest N from all tight, a tick");
  return table(head, rows);
}

}  // namespace erard::study
