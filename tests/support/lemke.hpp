// An exact method to hold the Gauss-Seidel solver against: Lemke's complementary pivoting.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <vector>

#include "erard/solver/one_step_problem.hpp"

namespace erard::test {

/// Linear complementarity problem w = M z + q, w >= 0, z >= 0, w.z = 0 by Lemke's algorithm with a covering vector of
/// ones. Cottle, Pang & Stone, The Linear Complementarity Problem (1992), algorithm 4.4.5; ties by the larger pivot.
/// @return z, or nothing when a ray is met or the pivots run out
inline std::optional<Eigen::VectorXd> solve_lemke(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  if (q.minCoeff() >= 0) return Eigen::VectorXd::Zero(n);
  // tableau: w - M z - 1 z0 = q; columns w (n), z (n), z0, right side
  Eigen::MatrixXd T(n, 2 * n + 2);
  T << Eigen::MatrixXd::Identity(n, n), -M, -Eigen::VectorXd::Ones(n), q;
  std::vector<Eigen::Index> basis(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) basis[static_cast<std::size_t>(i)] = i;
  Eigen::Index row = 0;
  q.minCoeff(&row);
  Eigen::Index entering = 2 * n;
  for (Eigen::Index pivots = 0; pivots < 100 * n; ++pivots) {
    T.row(row) /= T(row, entering);
    for (Eigen::Index i = 0; i < n; ++i)
      if (i != row && T(i, entering) != 0) T.row(i) -= T(i, entering) * T.row(row);
    const Eigen::Index leaving = basis[static_cast<std::size_t>(row)];
    basis[static_cast<std::size_t>(row)] = entering;
    if (leaving == 2 * n) {
      Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
      for (Eigen::Index i = 0; i < n; ++i)
        if (basis[static_cast<std::size_t>(i)] >= n) z[basis[static_cast<std::size_t>(i)] - n] = T(i, 2 * n + 1);
      return z;
    }
    entering = leaving < n ? leaving + n : leaving - n;
    double least = INFINITY, largest_pivot = 0;
    Eigen::Index chosen = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (T(i, entering) <= 1e-11) continue;
      const double ratio = T(i, 2 * n + 1) / T(i, entering);
      const bool is_tie = chosen >= 0 && std::abs(ratio - least) <= 1e-12 * std::abs(least);
      // the covering variable leaves as soon as it may
      const bool ends = basis[static_cast<std::size_t>(i)] == 2 * n;
      if (ratio < least && !is_tie) {
        least = ratio, chosen = i, largest_pivot = T(i, entering);
      } else if (is_tie && (ends || T(i, entering) > largest_pivot)) {
        chosen = i, largest_pivot = ends ? INFINITY : T(i, entering);
      }
    }
    if (chosen < 0) return std::nullopt;
    row = chosen;
  }
  return std::nullopt;
}

/// One-step problem as a linear complementarity problem. With |r| <= B (B = mu r_N or a constant), a = B + r and
/// b = B - r, u = u+ - u-:   0 <= a, u+,  a u+ = 0,   0 <= b, u-,  b u- = 0.
/// Unknowns z: r of half-lines and a of the others, then u- of the others.
/// @return impulses r
inline std::optional<RowVector> solve_exactly(const OneStepProblem& problem) {
  const int m = problem.size;
  std::vector<int> banded;
  for (int i = 0; i < m; ++i)
    if (problem.cone[static_cast<std::size_t>(i)].kind != ConeKind::half_line) banded.push_back(i);
  const int k = static_cast<int>(banded.size());
  // units in which every row has W_ii = 1
  Eigen::VectorXd s(m);
  for (int i = 0; i < m; ++i) s[i] = 1 / std::sqrt(problem.W(i, i));
  const Eigen::MatrixXd W = s.asDiagonal() * problem.W * s.asDiagonal();
  const Eigen::VectorXd q = s.asDiagonal() * problem.q;
  Eigen::MatrixXd E = Eigen::MatrixXd::Identity(m, m);  // r = E z + e
  Eigen::VectorXd e = Eigen::VectorXd::Zero(m);
  for (const int i : banded) {
    const Cone& cone = problem.cone[static_cast<std::size_t>(i)];
    if (cone.kind == ConeKind::friction) E(i, cone.normal) = -cone.bound * s[cone.normal] / s[i];
    if (cone.kind == ConeKind::interval) e[i] = -cone.bound / s[i];
  }
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(m + k, m + k);
  Eigen::VectorXd c(m + k);
  M.topLeftCorner(m, m) = W * E;
  c.head(m) = W * e + q;
  for (int j = 0; j < k; ++j) {
    const int i = banded[static_cast<std::size_t>(j)];
    M(i, m + j) = 1;  // u+ = u + u-
    // b = 2 B - a
    M(m + j, i) = -1;
    const Cone& cone = problem.cone[static_cast<std::size_t>(i)];
    if (cone.kind == ConeKind::friction) M(m + j, cone.normal) = -2 * E(i, cone.normal);
    c[m + j] = -2 * e[i];
  }
  const auto z = solve_lemke(M, c);
  if (!z) return std::nullopt;
  return RowVector(s.asDiagonal() * (E * z->head(m) + e));
}

}  // namespace erard::test
