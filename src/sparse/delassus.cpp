#include "erard/sparse/delassus.hpp"

#include <algorithm>
#include <stdexcept>

namespace erard {

Delassus::Delassus(const TriangularFactor& factor, const SparseMatrix& H) {
  const int n = factor.size;
  const int m = static_cast<int>(H.cols());
  if (H.rows() != n || !H.isCompressed())
    throw std::invalid_argument("Delassus: the directions must be n x m, of the size of the factor, and compressed");
  // columns of Y: the union of the paths to the roots
  std::vector<int> seen(static_cast<std::size_t>(n), -1);
  std::vector<int> row_count(static_cast<std::size_t>(n), 0);
  start_.push_back(0);
  for (int j = 0; j < m; ++j) {
    for (int p = H.outerIndexPtr()[j]; p < H.outerIndexPtr()[j + 1]; ++p)
      for (int k = factor.place[H.innerIndexPtr()[p]]; k != -1 && seen[k] != j; k = factor.parent[k]) {
        seen[k] = j;
        row_.push_back(k);
        ++row_count[k];
      }
    std::sort(row_.begin() + start_.back(), row_.end());
    start_.push_back(static_cast<int>(row_.size()));
  }
  // the same by rows
  row_start_.assign(static_cast<std::size_t>(n) + 1, 0);
  for (int k = 0; k < n; ++k) row_start_[k + 1] = row_start_[k] + row_count[k];
  std::vector<int> next(row_start_.begin(), row_start_.end() - 1);
  entry_.resize(row_.size());
  column_.resize(row_.size());
  for (int j = 0; j < m; ++j)
    for (int p = start_[j]; p < start_[j + 1]; ++p) {
      const int at = next[row_[p]]++;
      entry_[at] = p;
      column_[at] = j;
    }
  value_.resize(row_.size());
  scratch_.assign(static_cast<std::size_t>(n), 0.0);
  W_.resize(m, m);
}

const Eigen::MatrixXd& Delassus::update(const TriangularFactor& factor, const SparseMatrix& H) noexcept {
  const int m = static_cast<int>(W_.cols());
  for (int j = 0; j < m; ++j) {
    for (int p = H.outerIndexPtr()[j]; p < H.outerIndexPtr()[j + 1]; ++p)
      scratch_[factor.place[H.innerIndexPtr()[p]]] = H.valuePtr()[p];
    for (int q = start_[j]; q < start_[j + 1]; ++q) {
      const int k = row_[q];
      const double y = scratch_[k];
      scratch_[k] = 0;
      value_[q] = y;
      for (int p = factor.start[k]; p < factor.start[k + 1]; ++p) scratch_[factor.row[p]] -= factor.value[p] * y;
    }
  }
  W_.setZero();
  for (int k = 0; k < factor.size; ++k)
    for (int a = row_start_[k]; a < row_start_[k + 1]; ++a) {
      const double left = value_[entry_[a]] / factor.diagonal[k];
      for (int b = row_start_[k]; b <= a; ++b) W_(column_[b], column_[a]) += left * value_[entry_[b]];  // down a column
    }
  W_.triangularView<Eigen::StrictlyLower>() = W_.transpose();
  return W_;
}

}  // namespace erard
