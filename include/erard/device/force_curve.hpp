// A force over time, ours or measured, and how far two of them are apart.
#pragma once

#include <filesystem>
#include <vector>

namespace erard {

struct ForceCurve {
  std::vector<double> time;   // [s] rising
  std::vector<double> force;  // [N]
};

/// Reads the columns t_s and force_N of a CSV, for instance of a trajectory.csv; others are ignored. Throws InputError.
ForceCurve read_force_curve(const std::filesystem::path& file);

/// Relative error of a force curve against a reference up to `end`, by the trapezoid rule over the reference's instants;
/// the curve in between by straight lines; instants that the curve does not cover are left out.
///   eta = integral |F_ref - F| dt / integral |F_ref| dt                          thesis (6.3)
/// @return [-]; 0 when the two have no time in common or the reference is zero there
double relative_error(const ForceCurve& reference, const ForceCurve& curve, double end);

}  // namespace erard
