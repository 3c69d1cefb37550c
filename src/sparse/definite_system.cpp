#include "erard/sparse/definite_system.hpp"

#include <amd.h>
extern "C" {
#include <ldl.h>  // does not say itself that it is C, up to SuiteSparse 5
}

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include "pattern.hpp"

namespace erard {

DefiniteSystem::DefiniteSystem(const SparseMatrix& pattern) {
  require_square_pattern(pattern);
  if (!has_symmetric_pattern(pattern))
    throw std::invalid_argument("DefiniteSystem: the pattern has an entry without its mirror image, must be symmetric");
  const int n = static_cast<int>(pattern.rows());
  const auto size = static_cast<std::size_t>(n);
  pattern_start_.assign(pattern.outerIndexPtr(), pattern.outerIndexPtr() + n + 1);
  pattern_row_.assign(pattern.innerIndexPtr(), pattern.innerIndexPtr() + pattern.nonZeros());
  for (int j = 0; j < n; ++j) {
    const auto from = pattern_row_.begin() + pattern_start_[j], to = pattern_row_.begin() + pattern_start_[j + 1];
    const auto found = std::lower_bound(from, to, j);
    if (found == to || *found != j)
      throw std::invalid_argument("DefiniteSystem: a coordinate has no entry on the diagonal, must have one");
    diagonal_entry_.push_back(static_cast<int>(found - pattern_row_.begin()));
  }

  factor_.size = n;
  factor_.order.resize(size);
  factor_.place.resize(size);
  factor_.parent.resize(size);
  factor_.start.resize(size + 1);
  factor_.diagonal.resize(size);
  count_.resize(size);
  pattern_.resize(size);
  flag_.resize(size);
  scratch_.assign(size, 0.0);

  if (amd_order(n, pattern_start_.data(), pattern_row_.data(), factor_.order.data(), nullptr, nullptr) != AMD_OK)
    throw std::bad_alloc();  // what else it can refuse was looked at above
  ldl_symbolic(n, pattern_start_.data(), pattern_row_.data(), factor_.start.data(), factor_.parent.data(),
               count_.data(), flag_.data(), factor_.order.data(), factor_.place.data());
  factor_.row.resize(static_cast<std::size_t>(factor_.start[n]));
  factor_.value.resize(static_cast<std::size_t>(factor_.start[n]));
}

FactorReport DefiniteSystem::factorise(const SparseMatrix& A) noexcept {
  FactorReport report;
  if (!is_pattern(A, pattern_start_, pattern_row_)) return report;
  // LDL takes its input as pointers to what may change, and changes nothing of it
  const int done = ldl_numeric(
      factor_.size, pattern_start_.data(), pattern_row_.data(), const_cast<double*>(A.valuePtr()), factor_.start.data(),
      factor_.parent.data(), count_.data(), factor_.row.data(), factor_.value.data(), factor_.diagonal.data(),
      scratch_.data(), pattern_.data(), flag_.data(), factor_.order.data(), factor_.place.data());
  if (done == factor_.size) return check(A);
  report.status = FactorStatus::singular;  // a pivot of exactly zero
  report.coordinate = factor_.order[done];
  return report;
}

FactorReport DefiniteSystem::check(const SparseMatrix& A) const noexcept {
  FactorReport report{FactorStatus::regular, std::numeric_limits<double>::infinity(), -1};
  for (int k = 0; k < factor_.size; ++k) {
    const int i = factor_.order[k];
    const double own = A.valuePtr()[diagonal_entry_[i]];
    const double pivot = factor_.diagonal[k] / own;
    if (!std::isfinite(factor_.diagonal[k])) return {FactorStatus::not_finite, 0, i};
    const double part = own > 0 ? pivot : 0.0;
    if (part < report.least_pivot) report = {FactorStatus::regular, part, i};
  }
  if (report.least_pivot < least_regular_pivot(factor_.size)) report.status = FactorStatus::singular;
  return report;
}

void DefiniteSystem::solve(Eigen::Ref<Eigen::VectorXd> b) noexcept {
  // LDL's own routines, which take no const
  int* start = factor_.start.data();
  int* row = factor_.row.data();
  double* value = factor_.value.data();
  ldl_perm(factor_.size, scratch_.data(), b.data(), factor_.order.data());
  ldl_lsolve(factor_.size, scratch_.data(), start, row, value);
  ldl_dsolve(factor_.size, scratch_.data(), factor_.diagonal.data());
  ldl_ltsolve(factor_.size, scratch_.data(), start, row, value);
  ldl_permt(factor_.size, b.data(), scratch_.data(), factor_.order.data());
}

}  // namespace erard
