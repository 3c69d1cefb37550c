// Mechanisms of any size with the mass matrix of the engine: trees of bodies, what couples them, and generators.
#pragma once

#include <random>
#include <vector>

#include "erard/mechanics/frames.hpp"
#include "erard/sparse/definite_system.hpp"

namespace erard::bench {

/// Two bodies that touch at one point.
struct Touch {
  int body_a = kGround;
  int body_b = kGround;
  Vector2 point = Vector2::Zero();  // in the ground frame [m]
  Vector2 felt = Vector2::UnitY();  // direction in which a felt gives
  double loss = 0;                  // h^2 theta dF/dd of that felt, what it adds to A along `felt` [kg]
  Vector2 row = Vector2::UnitX();   // direction of the law that is a row of the one-step problem
};

struct LargeTree {
  std::vector<Body> bodies;     // parents before children
  std::vector<double> x;        // coordinates (n)
  std::vector<Touch> touches;   // contacts
  std::vector<Touch> closures;  // points where bodies are pinned together: two constraints each
  double pull = 0;              // h theta c_v + h^2 theta^2 kappa of every coordinate, as a part of M_ii [-]

  int size() const { return static_cast<int>(bodies.size()); }
};

/// Frames of all bodies.
std::vector<Frame> place(const LargeTree& tree);

/// M(x) by composite bodies, Featherstone (2008) 6.2, as assemble_mass_matrix() does in place; both halves, compressed.
SparseMatrix mass_matrix(const LargeTree& tree);

/// A = M (1 + pull on the diagonal) + sum of loss h h^T of the felts.
SparseMatrix iteration_matrix(const LargeTree& tree);

/// Directions of the rows (n x touches).
SparseMatrix row_directions(const LargeTree& tree);

/// Directions of the closures (n x 2 closures): x and y of each.
SparseMatrix closure_directions(const LargeTree& tree);

/// A random tree: each body hangs on one drawn from all before it; one in four touches a near relative through a felt,
/// up to 500.
LargeTree bush(int size, unsigned seed);

/// Each body hangs on the one before: a mass matrix without zeros.
LargeTree chain(int size, unsigned seed);

/// Felts of 15 mg one on another, each on its own slide of the ground, the lowest 500 contacts are rows.
LargeTree felt_stack(int size);

/// Four-bar linkages side by side on one frame: three hinged bodies each, the last one pinned to the frame.
LargeTree linkages(int count, unsigned seed);

}  // namespace erard::bench
