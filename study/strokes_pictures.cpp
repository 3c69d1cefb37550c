// Pictures of the study "strokes".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "study/figure.hpp"
#include "study/pose_sheet.hpp"
#include "study/strokes.hpp"

namespace erard::study {
namespace {

/// Vertical lines at the events, each with its letter near the top, neighbours at different heights.
void mark_events(Panel& panel, const PlayedStroke& stroke) {
  const auto [low, high] = panel.y.range;
  const double inset = 1e-3 * (high - low);  // gnuplot leaves out a line whose ends are rounded out of the range
  for (std::size_t i = 0; i < kMarked.size(); ++i) {
    const Event* event = stroke.find(kMarked[i].kind);
    if (event == nullptr) continue;
    const double time = 1e3 * event->time;
    const double height = high - (0.06 + 0.09 * static_cast<double>(i % 3)) * (high - low);
    panel.curves.push_back({"", {time, time}, {low + inset, high - inset}, "lines lc rgb '#bbbbbb' lw 0.8"});
    panel.curves.push_back({"", {time}, {height}, fmt::format("points pt '{}' lc rgb '#000000'", kMarked[i].letter)});
  }
}

Panel panel_of(const std::string& title, double end, const std::string& y, std::pair<double, double> range) {
  Panel panel;
  panel.title = title;
  panel.x = {"time [ms]", {0, 1e3 * end}};
  panel.y = {y, range};
  return panel;
}

constexpr const char* kRed = "lines lw 1.5 lc rgb '#d55e00'";
constexpr const char* kBlue = "lines lw 1.2 lc rgb '#0072b2'";
constexpr const char* kGreen = "lines lw 1.3 dashtype 2 lc rgb '#009e73'";

template <typename Quantity>
Curve curve_of(const std::string& label, const PlayedStroke& stroke, double end, const Quantity& quantity, double scale,
               const char* style, std::size_t stride = 4) {
  const Points p = points_of(stroke, end, quantity, scale, stride);
  return {label, p.x, p.y, style};
}

/// Figures 6.2, 6.3 and 6.9: position above, force below.
void draw_key_and_force(const std::filesystem::path& svg, const std::vector<StrokeResults>& results) {
  std::vector<Panel> panels;
  for (const bool is_key : {true, false})
    for (const StrokeResults& r : results) {
      const PlayedStroke& stroke = r.driven.by_position;
      const double end = stroke.row.back().time;
      Panel panel = panel_of(r.driven.stroke.name, end, is_key ? "down [mm]" : "force on the finger [N]",
                             {0, is_key ? 14 : 1.25 * stroke.result.peak_force});
      mark_events(panel, stroke);
      if (is_key) {
        panel.curves.push_back(curve_of(
            "piston Y", stroke, end, [](const Snapshot& s) { return s.input.value; }, 1e3, kBlue, 8));
        panel.curves.push_back(curve_of("key y", stroke, end, key_position, 1e3, kRed, 8));
        panel.key = "bottom center";
      } else {
        panel.curves.push_back(curve_of("", stroke, end, finger_force, 1, kRed));
      }
      panels.push_back(panel);
    }
  draw(svg, panels, 2, 600, 340);
}

/// An angle of one stroke with the felt string and with the inelastic one, events marked.
template <typename Quantity>
Panel compare_strings(const StrokeResults& r, const std::string& title, const Quantity& quantity) {
  const PlayedStroke& felt = r.strings[0].played;
  const PlayedStroke& inelastic = r.strings[1].played;
  const double end = felt.row.back().time;
  double low = INFINITY, high = -INFINITY;
  for (const PlayedStroke* stroke : {&felt, &inelastic})
    for (const Snapshot& row : stroke->row) {
      low = std::min(low, quantity(row));
      high = std::max(high, quantity(row));
    }
  const double margin = 0.1 * (high - low);
  Panel panel = panel_of(title, end, "angle [rad]", {low - margin, high + 3 * margin});
  mark_events(panel, felt);
  panel.curves.push_back(curve_of("felt string", felt, end, quantity, 1, kRed, 14));
  panel.curves.push_back(curve_of("inelastic string", inelastic, end, quantity, 1, kGreen, 14));
  panel.key = "off";
  return panel;
}

/// Figure 6.4: all bodies but the damper, which does not take part.
void draw_bodies(const std::filesystem::path& svg, const StrokeResults& r) {
  constexpr std::array kBodies{"key", "whippen", "jack", "repetition lever", "hammer"};
  std::vector<Panel> panels;
  for (std::size_t body = 0; body < kBodies.size(); ++body)
    panels.push_back(compare_strings(r, kBodies[body], [body](const Snapshot& s) { return s.angle[body]; }));
  panels.front().key = "bottom left Left reverse samplen 2";
  draw(svg, panels, 2, 600, 280);
}

/// Figures 6.7, 6.8: the key driven by force over the key driven by position, and how far they are apart.
void draw_replay(const std::filesystem::path& svg, const std::vector<StrokeResults>& results) {
  std::vector<Panel> panels;
  for (const StrokeResults& r : results) {
    const double end = r.driven.by_position.row.back().time;
    Panel panel = panel_of(r.driven.stroke.name, end, "key down [mm]", {0, 12});
    panel.curves.push_back(
        curve_of("driven by position", r.driven.by_position, end, key_position, 1e3, "lines lw 4 lc rgb '#f0c9ae'", 8));
    panel.curves.push_back(curve_of("driven by its force", r.driven.by_force, end, key_position, 1e3, kBlue, 8));
    panel.key = "bottom center";
    panels.push_back(panel);
  }
  draw(svg, panels, 2, 600, 320);
}

/// The blow itself: the head's distance from the string, and the force, with three strings.
void draw_strings(const std::filesystem::path& svg, const std::vector<StrokeResults>& results) {
  std::vector<Panel> panels;
  for (const bool is_head : {true, false})
    for (const StrokeResults& r : results) {
      const double impact = r.strings[0].played.event(EventKind::hammer_meets_string).time;
      const double from = impact - 0.01, end = r.driven.stroke.release;
      double peak = 0;
      for (std::size_t i = 0; i < 3; ++i) peak = std::max(peak, peak_after_impact(r.strings[i].played, end));
      Panel panel = panel_of(r.driven.stroke.name, end, is_head ? "hammer to string [mm]" : "force on the finger [N]",
                             is_head ? std::pair{-1.0, 20.0} : std::pair{0.0, 1.1 * peak});
      panel.x.range.first = 1e3 * from;
      const char* const styles[] = {kRed, kBlue, kGreen};
      for (std::size_t i = 0; i < 3; ++i) {
        const StringStroke& s = r.strings[i];
        const auto string = static_cast<std::size_t>(s.action.roles.string);
        const auto head = [string](const Snapshot& row) { return -row.compression[string]; };
        panel.curves.push_back(is_head ? curve_of(s.name, s.played, end, head, 1e3, styles[i])
                                       : curve_of(s.name, s.played, end, finger_force, 1, styles[i]));
      }
      panel.key = is_head ? "top left" : "off";
      panels.push_back(panel);
    }
  draw(svg, panels, 2, 600, 340);
}

/// Figure 6.5: the action at rest and at the events.
void draw_sheet(const std::filesystem::path& svg, const StrokeResults& r) {
  constexpr Box kHammerSide{-262, -47, -35, 158};  // [mm] all but the key's front
  const PlayedStroke& stroke = r.driven.by_position;
  std::vector<Pose> poses{{stroke.row.front(), "(a) at rest"}};
  for (const MarkedEvent& marked : kMarked) {
    const Event& event = stroke.event(marked.kind);
    poses.push_back(
        {stroke.at(event.time), fmt::format("({}) {}: {:.1f} ms, key {:.2f} mm, finger {:.2f} N", marked.letter,
                                            marked.what, 1e3 * event.time, 1e3 * event.key_position, event.force)});
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Pose& a, const Pose& b) { return a.snapshot.time < b.snapshot.time; });
  draw_poses(svg, default_action(), poses, DriveKind::piston, kHammerSide, 2);
}

}  // namespace

void draw_strokes(const std::filesystem::path& folder, const std::vector<StrokeResults>& results) {
  draw_key_and_force(folder / "strokes_force.svg", results);
  draw_replay(folder / "strokes_replay.svg", results);
  draw_strings(folder / "strokes_strings.svg", results);
  for (const StrokeResults& r : results) {
    draw_bodies(folder / fmt::format("strokes_bodies_{}.svg", r.driven.stroke.name), r);
    draw_sheet(folder / fmt::format("strokes_poses_{}.svg", r.driven.stroke.name), r);
  }
}

}  // namespace erard::study
