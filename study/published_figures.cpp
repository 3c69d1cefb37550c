#include "study/published_figures.hpp"

#include <cmath>
#include <numbers>

#include "study/played_stroke.hpp"

namespace erard::study {
namespace {

constexpr double kSpacing = 2.5e-4;  // of the samples of a stroke [s]
constexpr double kDeepest = 0.014;   // where the piston stops, 4 mm beyond the rail: after all that is timed here [m]
constexpr double kHold = 0.05;       // [s]
constexpr double kDip = 0.010;       // key travel to the rail, rounded [m]

/// Piston that goes along `position` until it is deepest, and stays there.
Keystroke piston(const std::function<double(double)>& position) {
  double end = 0;
  while (position(end) < kDeepest) end += kSpacing;
  return sampled_keystroke(KeystrokeQuantity::position, end + kHold, kSpacing,
                           [&](double t) { return std::min(kDeepest, position(t)); });
}

Keystroke rising_force(double force) {
  constexpr double kRise = 0.05, kEnd = 0.6;  // [s]
  return sampled_keystroke(KeystrokeQuantity::force, kEnd, kSpacing, [force](double t) {
    return t < kRise ? force * (1 - std::cos(std::numbers::pi * t / kRise)) / 2 : force;
  });
}

}  // namespace

std::vector<StrokeFamily> stroke_families() {
  return {{"pressed, force",
           "a finger without mass whose force [N] rises as a raised cosine in 50 ms and stays",
           Touch::pressed,
           DriveKind::force,
           {0.66, 0.7, 0.75, 0.8, 0.9, 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 7, 10, 15, 20, 30},
           rising_force},
          {"pressed, motion",
           "the piston starts on the key and accelerates evenly [m/s2]",
           Touch::pressed,
           DriveKind::piston,
           {0.4, 0.6, 0.9, 1.3, 1.8, 2.5, 3.5, 5, 7, 10, 14, 20, 28, 40},
           [](double acceleration) { return piston([=](double t) { return acceleration * t * t / 2; }); }},
          {"struck, motion",
           "the piston meets the key with its speed [m/s] and keeps it",
           Touch::struck,
           DriveKind::piston,
           {0.09, 0.1, 0.12, 0.15, 0.18, 0.22, 0.27, 0.33, 0.4, 0.5, 0.6, 0.75, 0.9},
           [](double speed) { return piston([=](double t) { return speed * t; }); }},
          {"struck and pressed",
           "the piston meets the key with its speed [m/s] and doubles it evenly over 10 mm",
           Touch::struck,
           DriveKind::piston,
           {0.05, 0.06, 0.07, 0.09, 0.11, 0.14, 0.17, 0.21, 0.26, 0.32, 0.4, 0.5},
           [](double speed) {
             const double acceleration = 1.5 * speed * speed / kDip;  // (2 v)^2 - v^2 = 2 a s
             return piston([=](double t) { return speed * t + acceleration * t * t / 2; });
           }}};
}

std::vector<FamilyPoint> play_family(const ActionFile& action, const StrokeFamily& family, double key_start) {
  std::vector<FamilyPoint> points;
  for (const double strength : family.strengths) {
    const TracedStroke stroke = trace_stroke(action, family.stroke(strength), family.drive);
    const StrokeTimes times = time_stroke(stroke.trace, stroke.events, key_start);
    if (!std::isnan(times.hammer_string)) points.push_back({strength, times});
  }
  return points;
}

double at_speed(const std::vector<FamilyPoint>& points, double hammer_speed,
                double (StrokeTimes::*quantity)() const noexcept) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const StrokeTimes &a = points[i - 1].times, &b = points[i].times;
    if (hammer_speed < a.maximum_speed || hammer_speed > b.maximum_speed) continue;
    const double part = std::log(hammer_speed / a.maximum_speed) / std::log(b.maximum_speed / a.maximum_speed);
    return (1 - part) * (a.*quantity)() + part * (b.*quantity)();
  }
  return StrokeTimes::kNone;
}

double travel_exponent(const std::vector<FamilyPoint>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const FamilyPoint& point : points) {
    if (point.times.maximum_speed < 1 || point.times.maximum_speed > 5) continue;
    const double u = std::log(point.times.maximum_speed), v = std::log(point.times.travel());
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace erard::study
