// How far a contender's force is from what it would be in much finer steps.
#pragma once

#include <functional>
#include <limits>

#include "bench/contender.hpp"
#include "erard/device/force_curve.hpp"

namespace erard::bench {

struct Error {
  double eta = std::numeric_limits<double>::quiet_NaN();    // relative, thesis (6.3) [-]
  double rms_N = std::numeric_limits<double>::quiet_NaN();  // root mean square [N]
};

using Maker = std::function<std::unique_ptr<Contender>(const Stage&, const Job&)>;

/// Rate and internal steps of a converged run: 5 us, 100 steps in a period of 2 kHz, force told at instants that all
/// rates up to 50 kHz that divide it have in common.
inline constexpr double kConvergedRate_Hz = 100000;
inline constexpr int kConvergedSubsteps = 2;

/// Force on the first key of a scene from 0 to `end` [s], once a period.
/// @param goes_on  asked once a period; when it says no the curve ends there
ForceCurve force_of(Contender& contender, double rate_Hz, double end, const std::function<bool()>& goes_on);

/// Force of this engine on this scene, converged, up to the release.
ForceCurve converged_force(const Maker& make, const Stage& stage, const Scene& scene, FeltModel felts,
                           const std::function<bool()>& goes_on);

/// At the instants of `force` up to `end`; between its own the truth is joined by straight lines. NaN when `truth` is
/// empty.
Error error_of(const ForceCurve& truth, const ForceCurve& force, double end);

}  // namespace erard::bench
