// What a technician measures on an action, with the range that is usual.
#pragma once

#include <string>
#include <vector>

#include "erard/device/report_rows.hpp"

namespace erard {

/// One line of the technician's summary.
struct Measure {
  std::string name;            // "touch weight down"
  std::string unit;            // "mm"; values in it
  std::vector<double> values;  // one a strike, or one; empty: this run cannot tell
  double low = 0, high = 0;    // usual range; NAN on a side that is open
  std::string source;          // of the range
  std::string how;             // what was measured, in one sentence
  double scale_g = 0;          // [g/N] where technicians weigh: the value in grams is shown too; else 0
};

/// Measures on the action itself, by two slow presses of the piston (6 mm/s to Y = 7.8 mm and back, 12 mm/s to 10.8 mm),
/// whatever the keystroke of the run: touch weight, friction, blow, key dip, let-off, aftertouch, drop. A mechanism
/// without finger or string has none of them.
/// @param action  usually with its damper off, as touch weight is measured
/// Cost: 3.8 s simulated at one internal step a period.
std::vector<Measure> measure_action(const ActionFile& action);

/// Measures on one recorded stroke: hammer speed, key bottom, check distance, repetition readiness, damper.
std::vector<Measure> measure_stroke(const ActionFile& action, const ReportRows& rows, const std::vector<Event>& events);

}  // namespace erard
