// This action beside published measurements of grands: timing against hammer speed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/published_curves.hpp"
#include "study/section.hpp"
#include "study/stroke_times.hpp"

namespace erard::study {

/// Strokes of one shape and many strengths.
struct StrokeFamily {
  std::string name;
  std::string what;  // the shape, with the unit of its strength
  Touch touch = Touch::pressed;
  DriveKind drive = DriveKind::piston;
  std::vector<double> strengths;  // rising
  std::function<Keystroke(double strength)> stroke;
};

/// Two pressed and two struck families. None of their constants was fitted to the published curves.
std::vector<StrokeFamily> stroke_families();

struct FamilyPoint {
  double strength = 0;
  StrokeTimes times;
};

/// Plays every strength; strokes that do not reach the string are left out.
std::vector<FamilyPoint> play_family(const ActionFile& action, const StrokeFamily& family,
                                     double key_start = kKeyStart);

/// A quantity of a family at a given maximum hammer speed, on a straight line between points over the logarithm of
/// the speed; NaN outside the family and where a neighbour has none.
double at_speed(const std::vector<FamilyPoint>& points, double hammer_speed,
                double (StrokeTimes::*quantity)() const noexcept);

/// Exponent of the power law through the travel times from 1 to 5 m/s, by least squares of the logarithms.
double travel_exponent(const std::vector<FamilyPoint>& points);

Section published_figures_section(const Pictures& pictures);

}  // namespace erard::study
