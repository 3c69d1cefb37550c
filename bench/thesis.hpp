// The thesis's own figure for the cost of a step, beside this run's.
#pragma once

#include <string>
#include <vector>

#include "bench/row.hpp"

namespace erard::bench {

/// Thesis 6.4.1: one second of the grand action, position-driven, in steps of h = 0.5 ms took XDE, a general 3-D engine,
/// "about 20 s with a laptop computer equipped with an Intel Core i5 processor"; before the felt laws were put in and
/// synchronised (5.5.2), which was done from outside the engine, 1.2 s.
inline constexpr double kThesisStep = 5e-4;    // h [s]
inline constexpr double kThesisSlowness = 20;  // computing over simulated time [-]
inline constexpr double kThesisFeltlessSlowness = 1.2;

/// Mean time of a step, which is what the thesis tells.
struct ThesisLine {
  std::string model;
  double thesis = Distribution::kNone;       // [s]; NaN: the thesis has no such figure
  double measured = Distribution::kNone;     // [s]
  double undisturbed = Distribution::kNone;  // [s]
};

/// The stroke piano at the same h, one step a period; empty when it was not played.
std::vector<ThesisLine> beside_thesis(const std::vector<Row>& rows);

/// Where the thesis's figures come from, for below the table.
std::string thesis_note();

}  // namespace erard::bench
