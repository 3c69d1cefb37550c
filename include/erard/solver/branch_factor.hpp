// Factorisation of a matrix with the sparsity of a tree, without fill.
#pragma once

#include "erard/mechanics/mechanism.hpp"

namespace erard {

/// A = L^T D L with L unit lower triangular, L_ij only where j lies above i in the tree.
/// Featherstone, Rigid Body Dynamics Algorithms (2008), 6.5. Cost: the sum of the squared depths.
/// @param A (n x n) symmetric positive definite, lower half; overwritten: 1/D on the diagonal, L below it
inline void factorise_branches(const AncestorTable& above, CoordinateMatrix& A) noexcept {
  for (int k = above.size - 1; k >= 0; --k) {
    const double inverse = 1 / A(k, k);
    A(k, k) = inverse;
    const auto& ancestor = above.list[k];
    const int count = above.count[k];
    for (int a = 0; a < count; ++a) {
      const int i = ancestor[a];
      const double l = A(k, i) * inverse;
      for (int b = a; b < count; ++b) A(i, ancestor[b]) -= l * A(k, ancestor[b]);
      A(k, i) = l;
    }
  }
}

/// b <- L^-T b: what the coordinates above feel of a load. b stays zero beyond `last`.
/// @param b     (n)
/// @param last  b is zero beyond this coordinate
inline void solve_upwards(const AncestorTable& above, const CoordinateMatrix& factor, int last, double* b) noexcept {
  for (int i = last; i > 0; --i) {
    const double value = b[i];
    if (value == 0) continue;
    const auto& ancestor = above.list[i];
    for (int a = 0; a < above.count[i]; ++a) b[ancestor[a]] -= factor(i, ancestor[a]) * value;
  }
}

/// b <- L^-1 D^-1 b: with solve_upwards() before it, b <- A^-1 b.
inline void solve_downwards(const AncestorTable& above, const CoordinateMatrix& factor, double* b) noexcept {
  for (int i = 0; i < above.size; ++i) {
    double sum = factor(i, i) * b[i];
    const auto& ancestor = above.list[i];
    for (int a = 0; a < above.count[i]; ++a) sum -= factor(i, ancestor[a]) * b[ancestor[a]];
    b[i] = sum;
  }
}

}  // namespace erard
