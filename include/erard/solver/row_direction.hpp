// H: how the laws see the coordinates.
#pragma once

#include "erard/solver/workspace.hpp"

namespace erard {

/// Column of H of one row: an impulse of 1 on the row is an impulse `lever` on each of its coordinates; the velocity of
/// the row is the sum of lever times rate.
struct RowDirection {
  int count = 0;
  const int* coordinate = nullptr;  // (count) ascending
  const double* lever = nullptr;    // (count)

  template <typename Rates>
  double along(const Rates& rate) const noexcept {
    double sum = 0;
    for (int k = 0; k < count; ++k) sum += lever[k] * rate[coordinate[k]];
    return sum;
  }
  template <typename Loads>
  void apply(double impulse, Loads&& load) const noexcept {
    for (int k = 0; k < count; ++k) load[coordinate[k]] += impulse * lever[k];
  }
  /// A += weight H H^T, lower half.
  void couple(double weight, CoordinateMatrix& A) const noexcept {
    for (int k = 0; k < count; ++k)
      for (int j = 0; j <= k; ++j) A(coordinate[k], coordinate[j]) += weight * lever[k] * lever[j];
  }
};

inline RowDirection direction_of(const Mechanism& mechanism, const Workspace& work, const Row& row) noexcept {
  static constexpr double kOne = 1;
  if (row.kind == RowKind::hinge) return {1, &row.index, &kOne};
  if (row.kind == RowKind::stop) return {1, &mechanism.felt_coordinate[row.index], &kOne};
  const ContactPath& path = mechanism.path[row.index];
  const auto& lever = row.kind == RowKind::tangential ? work.tangent_lever : work.normal_lever;
  return {path.count, path.coordinate.data(), lever[row.index].data()};
}

}  // namespace erard
