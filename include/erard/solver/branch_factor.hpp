// Factorisation of a matrix with the sparsity of a tree, without fill.
#pragma once

#include "erard/mechanics/mechanism.hpp"

namespace erard {

/// A = L^T D L with L unit lower triangular, L_ij only where j lies above i in the tree.
/// Featherstone, Rigid Body Dynamics Algorithms (2008), 6.5. Cost: the sum of the squared depths.
/// @param A (n x n) symmetric positive definite, overwritten: D on the diagonal, L below it
inline void factorise_branches(const Mechanism& mechanism, CoordinateMatrix& A) noexcept {
  const auto& above = mechanism.parent;
  for (int k = mechanism.coordinate_count - 1; k >= 0; --k) {
    for (int i = above[k]; i != kGround; i = above[i]) {
      const double a = A(k, i) / A(k, k);
      for (int j = i; j != kGround; j = above[j]) A(i, j) -= a * A(k, j);
      A(k, i) = a;
    }
  }
}

/// b <- A^-1 b with the factors above.
template <typename Vector>
void solve_branches(const Mechanism& mechanism, const CoordinateMatrix& factor, Vector&& b) noexcept {
  const auto& above = mechanism.parent;
  const int n = mechanism.coordinate_count;
  for (int i = n - 1; i >= 0; --i)
    for (int j = above[i]; j != kGround; j = above[j]) b[j] -= factor(i, j) * b[i];
  for (int i = 0; i < n; ++i) {
    b[i] /= factor(i, i);
    for (int j = above[i]; j != kGround; j = above[j]) b[i] -= factor(i, j) * b[j];
  }
}

}  // namespace erard
