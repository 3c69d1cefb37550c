// What a slow press shows: touch weight, measured and by the lever ratios of thesis Table 2.1, and those ratios.
#pragma once

#include <string>
#include <vector>

#include "erard/device/action_file.hpp"
#include "study/played_stroke.hpp"
#include "study/section.hpp"
#include "study/thesis_numbers.hpp"

namespace erard::study {

/// Force on the key that lets it sink, and force under which it rises.
struct TouchWeight {
  double down = 0;  // F_down [N]
  double up = 0;    // F_up [N]

  double mean() const noexcept { return (down + up) / 2; }      // of weights and spring       thesis (2.7) over L
  double friction() const noexcept { return (down - up) / 2; }  // of the hinges               thesis (2.8) over L
};

inline constexpr TouchWeight kThesisTouchWeight{thesis::kDownForce, thesis::kUpForce};  // damper removed

/// Piston at 6 mm/s to Y = 7.8 mm and back, a row every 0.5 ms.
PlayedStroke press_slowly(const ActionFile& action);

/// Mean force over y = 1.5 to 7 mm each way.
TouchWeight touch_weight_of(const PlayedStroke& press);

/// Ratios of the angles travelled on the way down, over y = 0.5 to 7.5 mm.
struct KinematicRatios {
  double whippen_to_key = 0;  // alpha_21, Table 2.1: 2.15
  double hammer_to_key = 0;   // alpha_31, Table 2.1: 10.1
};
KinematicRatios kinematic_ratios(const ActionFile& action, const PlayedStroke& press);

/// Of the action without damper, pressed slowly.
TouchWeight measure_touch_weight(const ActionOptions& options);

/// What the printed numbers say in a quasi-static press.
///   mean L = C_w1 - alpha_21 C_w2 + alpha_31 C_w3 - alpha_21 kappa (theta_0 - theta_W)
///   friction L = c_dK + alpha_21 c_dW + alpha_31 c_dH                               thesis (2.1), (2.4), (4.8)
/// The spring lifts the whippen; its moment is taken at the whippen's angle at mid-travel.
struct StaticTouch {
  double kappa = thesis::kWhippenSpring;     // [N m/rad]
  double rest = thesis::kWhippenSpringRest;  // theta_0 [rad]
  double friction = 1;                       // factor on the dry frictions of key, whippen and hammer
};
TouchWeight static_touch_weight(const StaticTouch& parameters) noexcept;

/// Settings of the action that stand for these parameters.
ActionOptions touch_options(const StaticTouch& parameters);

/// One change to the action and its touch weight, measured and by the formula.
struct TouchCase {
  std::string what;
  StaticTouch parameters;
  TouchWeight measured, predicted;
};

/// The thesis's numbers, the remedies one by one, and last the pair of spring and friction that a straight line through
/// the measured cases says would give 0.70 and 0.38 N.
std::vector<TouchCase> touch_cases();

/// The printed numbers that touch weight hangs on, beside the formula or the measurement.
std::vector<Recomputed> recompute_touch(const TouchWeight& measured);

/// Force against key position of the press and its return, for the picture.
struct TouchCurve {
  std::vector<double> down_y, down, up_y, up;  // [m], [N]
};
TouchCurve touch_curve(const ActionOptions& options);

}  // namespace erard::study
