// All that must be kept to go on from an instant, bit for bit.
#pragma once

#include "erard/mechanics/mechanism.hpp"

namespace erard {

using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;
using ContactVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxContacts, 1>;

struct State {
  double time = 0;     // [s]
  CoordinateVector x;  // coordinates (n): hinge angles relative to the parent [rad], slides, compressions [m]
  CoordinateVector v;  // their rates (n); of a felt the mean over the last step
  CoordinateVector acceleration;  // change of v over the last step by its length (n): the guess for the next
  ContactVector compression;      // of the felts without mass (contacts), 0 for all others: their history [m]
  double time_step = 0;           // length h of the last step [s]
  RowVector impulse;              // reaction of each row over the last step (m) [N s], hinges [N m s]: the warm start
};

/// Compression of the felt of contact c, with or without mass [m].
inline double compression_of(const Mechanism& mechanism, const State& state, int c) noexcept {
  const int felt = mechanism.felt_coordinate[c];
  return felt < 0 ? state.compression[c] : state.x[felt];
}

}  // namespace erard
