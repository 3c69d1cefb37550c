// The linear part of one step of a mechanism of any size: A dv = -R + H r with a sparse, positive definite A.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/SparseCore>

namespace erard {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

enum class FactorStatus {
  regular,
  singular,       // to rounding; of a positive definite system also: it is not positive definite
  not_finite,     // an entry is not a number, or the factors overflow
  other_pattern,  // the matrix has not the pattern that was analysed
};

struct FactorReport {
  FactorStatus status = FactorStatus::other_pattern;
  /// Smallest pivot, relative: 1 - R^2 of that coordinate with those eliminated before it. 0: it moves only with them. [-]
  double least_pivot = 0;
  int coordinate = -1;  // that has it
};

/// A unit lower triangular factor and its diagonal, in the order of elimination: P A P^T = L D L^T.
struct TriangularFactor {
  int size = 0;
  std::vector<int> order;        // (n) coordinate that is eliminated k-th
  std::vector<int> place;        // (n) its inverse
  std::vector<int> parent;       // (n) elimination tree in that order, -1 at a root
  std::vector<int> start;        // (n + 1) of each column below the diagonal
  std::vector<int> row;          // of each entry, in that order
  std::vector<double> value;     // of each entry
  std::vector<double> diagonal;  // D (n)
};

/// Factorises A = A^T > 0 by approximate minimum degree and L D L^T (SuiteSparse's AMD and LDL).
/// T. Davis, Direct Methods for Sparse Linear Systems (2006), 4.8, 7.1.
/// The analysis of the pattern is done once, in the constructor; factorise() and solve() use no heap.
class DefiniteSystem {
 public:
  /// @param pattern  (n x n) both halves, compressed, rows ascending; only its pattern counts
  /// Throws std::invalid_argument when it is not like that or its pattern is not symmetric, std::bad_alloc when memory
  /// ends.
  explicit DefiniteSystem(const SparseMatrix& pattern);

  int size() const noexcept { return factor_.size; }
  /// Entries below the diagonal of L.
  int factor_entries() const noexcept { return factor_.start[factor_.size]; }
  const TriangularFactor& factor() const noexcept { return factor_; }

  /// @param A  (n x n) with the pattern of the constructor; of each pair of symmetric entries one is read
  FactorReport factorise(const SparseMatrix& A) noexcept;

  /// b <- A^-1 b. Allowed only after factorise() was regular.
  void solve(Eigen::Ref<Eigen::VectorXd> b) noexcept;

 private:
  FactorReport check(const SparseMatrix& A) const noexcept;

  TriangularFactor factor_;
  std::vector<int> pattern_start_, pattern_row_;  // of A
  std::vector<int> diagonal_entry_;               // where A's diagonal is (n)
  std::vector<int> count_, pattern_, flag_;       // scratch of LDL (n)
  std::vector<double> scratch_;                   // (n)
};

/// Relative size of a pivot below which a system of that many coordinates counts as singular: what rounding leaves of a
/// pivot that is zero, n eps times the condition of what was eliminated before it. That is not known here and taken as 64:
/// worse-conditioned systems that are singular can pass, regular ones with so small a pivot are refused.
inline double least_regular_pivot(int size) noexcept { return 64 * size * std::numeric_limits<double>::epsilon(); }

}  // namespace erard
