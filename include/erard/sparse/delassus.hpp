// W = H^T A^-1 H of a mechanism of any size, from a sparse factor.
#pragma once

#include "erard/sparse/definite_system.hpp"

namespace erard {

/// Delassus operator of the rows in play,
///   W = Y^T D^-1 Y,   Y = L^-1 P H
/// Column j of Y is zero but on the paths from the entries of H's column j to the roots of the elimination tree: these
/// are found once, in the constructor; update() uses no heap.
/// Cost of update(): entries of L on those paths, then sum over the coordinates of the square of the columns they are in.
class Delassus {
 public:
  /// @param factor  its pattern counts
  /// @param H       (n x m) directions, compressed; its pattern counts
  /// Throws std::invalid_argument when the sizes do not fit.
  Delassus(const TriangularFactor& factor, const SparseMatrix& H);

  /// @param factor  of the same pattern, its values now
  /// @param H       of the same pattern, its values now
  /// @return W (m x m), both halves
  const Eigen::MatrixXd& update(const TriangularFactor& factor, const SparseMatrix& H) noexcept;

  int entries() const noexcept { return start_.back(); }  // of Y

 private:
  std::vector<int> start_, row_;                 // columns of Y, rows ascending in the order of elimination
  std::vector<double> value_;                    // of Y
  std::vector<int> row_start_, entry_, column_;  // rows of Y: where the entry is, in which column
  std::vector<double> scratch_;                  // (n), zero between calls
  Eigen::MatrixXd W_;
};

}  // namespace erard
