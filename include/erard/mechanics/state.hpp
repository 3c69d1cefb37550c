// All that must be kept to go on from an instant, bit for bit.
#pragma once

#include "erard/mechanics/mechanism.hpp"

namespace erard {

using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;

struct State {
  double time = 0;     // [s]
  CoordinateVector x;  // coordinates (n): hinge angles relative to the parent [rad], slides, compressions [m]
  CoordinateVector v;  // their rates (n); of a felt the mean over the last step
  RowVector impulse;   // reaction of each row over the last step (m) [N s], hinges [N m s]: the warm start
};

}  // namespace erard
