// What both kinds of systems ask of a pattern.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "erard/sparse/definite_system.hpp"

namespace erard {

/// Throws std::invalid_argument unless it is square, compressed, not empty, its rows ascending.
inline void require_square_pattern(const SparseMatrix& pattern) {
  if (pattern.rows() != pattern.cols() || pattern.rows() == 0)
    throw std::invalid_argument("sparse system: the matrix is not square or empty, must be n x n, n >= 1");
  if (!pattern.isCompressed()) throw std::invalid_argument("sparse system: must be compressed (makeCompressed())");
  for (int j = 0; j < pattern.cols(); ++j)
    for (int p = pattern.outerIndexPtr()[j] + 1; p < pattern.outerIndexPtr()[j + 1]; ++p)
      if (pattern.innerIndexPtr()[p - 1] >= pattern.innerIndexPtr()[p])
        throw std::invalid_argument("sparse system: the rows of a column must ascend");
}

inline bool has_symmetric_pattern(const SparseMatrix& pattern) {
  const SparseMatrix mirrored = pattern.transpose();
  return std::equal(pattern.outerIndexPtr(), pattern.outerIndexPtr() + pattern.cols() + 1, mirrored.outerIndexPtr()) &&
         std::equal(pattern.innerIndexPtr(), pattern.innerIndexPtr() + pattern.nonZeros(), mirrored.innerIndexPtr());
}

/// Whether a matrix has this pattern.
inline bool is_pattern(const SparseMatrix& A, const std::vector<int>& start, const std::vector<int>& row) noexcept {
  return A.isCompressed() && A.cols() + 1 == static_cast<Eigen::Index>(start.size()) && A.rows() == A.cols() &&
         std::equal(start.begin(), start.end(), A.outerIndexPtr()) &&
         std::equal(row.begin(), row.end(), A.innerIndexPtr());
}

}  // namespace erard
