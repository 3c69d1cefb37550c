// The linear part of one step of a closed chain: bilateral constraints beside the coordinates of a tree.
#pragma once

#include <memory>
#include <vector>

#include "erard/sparse/definite_system.hpp"

namespace erard {

/// Solves the system of a tree whose loops are closed by constraints,
///   [ A    G ] [ dv ]   [ b ]
///   [ G^T  0 ] [ -r ] = [ u ]                     A dv = b + G r,   G^T dv = u
/// symmetric but indefinite: L D L^T without exchanges meets pivots of zero, so SuiteSparse's KLU (sparse LU with
/// partial pivoting; T. Davis, E. Palamadai Natarajan, ACM Trans. Math. Softw. 37, 36 (2010)).
/// Before, it is scaled to a unit diagonal of A and unit columns of G in that metric, so that hinges [kg m^2], slides [kg]
/// and constraints of any unit weigh the same in the choice of pivots.
///
/// The pattern is analysed in the constructor. The first factorise() chooses the pivots and uses the heap; later ones
/// keep them and use none, but for one whose kept pivots have become poor (growth, or a pivot lost in rounding): it
/// chooses anew.
class ConstrainedSystem {
 public:
  /// @param A  (n x n) both halves, compressed; its pattern counts
  /// @param G  (n x c) directions of the constraints, c >= 0, compressed; its pattern counts
  /// Throws std::invalid_argument when they are not like that, std::bad_alloc when memory ends. A pattern that no numbers
  /// make regular is taken: factorise() reports it.
  ConstrainedSystem(const SparseMatrix& A, const SparseMatrix& G);
  ~ConstrainedSystem();
  ConstrainedSystem(ConstrainedSystem&&) noexcept;
  ConstrainedSystem& operator=(ConstrainedSystem&&) noexcept;

  /// `least_pivot` of the report is the smallest pivot of U by the largest; `coordinate` n + j is constraint j.
  /// Constraints that repeat each other, or that act on nothing, make the system singular.
  FactorReport factorise(const SparseMatrix& A, const SparseMatrix& G) noexcept;

  /// @param b  (n) in: loads, out: dv
  /// @param u  (c) in: velocities that the constraints have to reach, out: their impulses r
  /// Allowed only after factorise() was regular. No heap.
  void solve(Eigen::Ref<Eigen::VectorXd> b, Eigen::Ref<Eigen::VectorXd> u) noexcept;

  int coordinates() const noexcept;
  int constraints() const noexcept;
  int factor_entries() const noexcept;  // of L and U, both diagonals included; 0 before the first factorise()
  int pivot_choices() const noexcept;   // how many times factorise() had to choose pivots

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace erard
