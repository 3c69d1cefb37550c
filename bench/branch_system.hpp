// factorise_branches() of the engine for any number of coordinates: what the in-place method would cost above its bounds.
#pragma once

#include <algorithm>
#include <vector>

#include "erard/sparse/definite_system.hpp"

namespace erard::bench {

/// A = L^T D L over an elimination tree from the last coordinate to the first, each column full over all its ancestors.
/// Ancestors are kept nearest first, so the list of an ancestor is the end of the list of each coordinate below it, and
/// every entry is found without a search.
class BranchSystem {
 public:
  explicit BranchSystem(const SparseMatrix& A) {
    const int n = static_cast<int>(A.rows());
    const auto size = static_cast<std::size_t>(n);
    factor_.size = n;
    for (int k = 0; k < n; ++k) factor_.order.push_back(n - 1 - k);
    factor_.place = factor_.order;
    find_tree(A);
    depth_.assign(size, 0);
    for (int k = n - 1; k >= 0; --k)
      if (factor_.parent[k] != -1) depth_[k] = depth_[factor_.parent[k]] + 1;
    factor_.start.push_back(0);
    for (int k = 0; k < n; ++k) {
      for (int a = factor_.parent[k]; a != -1; a = factor_.parent[a]) factor_.row.push_back(a);
      factor_.start.push_back(static_cast<int>(factor_.row.size()));
    }
    factor_.value.resize(factor_.row.size());
    factor_.diagonal.resize(size);
  }

  void factorise(const SparseMatrix& A) noexcept {
    auto& d = factor_.diagonal;
    std::fill(factor_.value.begin(), factor_.value.end(), 0.0);
    for (int k = 0; k < factor_.size; ++k) {
      const int j = factor_.order[k];
      for (int p = A.outerIndexPtr()[j]; p < A.outerIndexPtr()[j + 1]; ++p) {
        const int i = factor_.place[A.innerIndexPtr()[p]];
        if (i == k) d[k] = A.valuePtr()[p];
        if (i > k) factor_.value[factor_.start[k] + depth_[k] - depth_[i] - 1] = A.valuePtr()[p];
      }
    }
    for (int k = 0; k < factor_.size; ++k) {
      const int count = factor_.start[k + 1] - factor_.start[k];
      const int* above = factor_.row.data() + factor_.start[k];
      double* own = factor_.value.data() + factor_.start[k];
      const double inverse = 1 / d[k];
      for (int a = 0; a < count; ++a) {
        const double l = own[a] * inverse;
        double* other = factor_.value.data() + factor_.start[above[a]];
        d[above[a]] -= l * own[a];
        for (int b = a + 1; b < count; ++b) other[b - a - 1] -= l * own[b];
        own[a] = l;
      }
    }
  }

  void solve(Eigen::VectorXd& b) const noexcept {
    const int n = factor_.size;
    for (int k = 0; k < n; ++k) {
      const double value = b[factor_.order[k]];
      for (int p = factor_.start[k]; p < factor_.start[k + 1]; ++p)
        b[factor_.order[factor_.row[p]]] -= factor_.value[p] * value;
    }
    for (int k = n - 1; k >= 0; --k) {
      double sum = b[factor_.order[k]] / factor_.diagonal[k];
      for (int p = factor_.start[k]; p < factor_.start[k + 1]; ++p)
        sum -= factor_.value[p] * b[factor_.order[factor_.row[p]]];
      b[factor_.order[k]] = sum;
    }
  }

  const TriangularFactor& factor() const noexcept { return factor_; }

 private:
  /// J. Liu, ACM Trans. Math. Softw. 12, 127 (1986): paths compressed.
  void find_tree(const SparseMatrix& A) {
    factor_.parent.assign(static_cast<std::size_t>(factor_.size), -1);
    std::vector<int> root(factor_.parent);
    for (int k = 0; k < factor_.size; ++k) {
      const int j = factor_.order[k];
      for (int p = A.outerIndexPtr()[j]; p < A.outerIndexPtr()[j + 1]; ++p) {
        int i = factor_.place[A.innerIndexPtr()[p]];
        while (i < k && i != -1) {
          const int next = root[i];
          root[i] = k;
          if (next == -1) factor_.parent[i] = k;
          i = next;
        }
      }
    }
  }

  TriangularFactor factor_;
  std::vector<int> depth_;
};

}  // namespace erard::bench
