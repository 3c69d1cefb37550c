// What the engine is to reach, beside what one run measured.
#pragma once

#include <string>
#include <vector>

#include "bench/row.hpp"

namespace erard::bench {

/// One figure with its limit. `undisturbed` is the engine's own, without what the machine did meanwhile (Row); the verdict
/// is about `measured`.
struct Target {
  std::string claim;
  double limit = 0;
  std::string unit;  // "us", or "times" something that the claim names
  double measured = Distribution::kNone;
  double undisturbed = Distribution::kNone;
  std::string where{};  // the scene that is told, where a claim is about several: the worst of them

  bool is_measured() const;
  bool is_met() const;
  bool is_met_undisturbed() const;
};

/// All targets; those of scenes, rates or settings that were not played are not measured.
std::vector<Target> targets_of(const std::vector<Row>& rows);

/// "A key at rest takes 0.88 us a period awake (rest), 0.0009 us left alone (one of 88)." Empty when neither was measured.
std::string resting_line(const std::vector<Row>& rows);

/// "met", "missed", "missed (met undisturbed)" or "not measured".
std::string verdict(const Target& target);

}  // namespace erard::bench
