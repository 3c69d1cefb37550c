// How many floating-point operations a step needs at least: what a profile is held against.
#pragma once

#include <array>
#include <string_view>

#include "erard/mechanics/state.hpp"

namespace erard::bench {

/// Parts of a step, in the order in which it goes through them.
enum class Phase {
  iterate,        // first guess, middle of the step, movement of the end velocity
  frames,         // where the bodies are
  gaps,           // of all contacts
  levers,         // H of their normals, and of tangents with friction
  dynamics,       // mass matrix, gyroscopic terms, weight
  felt_laws,      // their mean over the step
  linearisation,  // residual R and iteration matrix A
  factorisation,  // A = L^T D L, and solving with it
  friction,       // as it was a step ago, put to the test
  rows,           // one-step problem: rows in play, W, q
  sweeps,         // Gauss-Seidel over them
  finish,         // checks, felt history, force, new state
};
inline constexpr int kPhases = 12;
std::string_view name_of(Phase phase);

/// Operations of each phase.
using Work = std::array<double, kPhases>;

/// Least work of one step that ends in `after`: one linearisation, in which friction goes on as it was, of the scheme as
/// docs/scheme.md has it, with what is zero or constant by the mechanism's own structure left out: frames on the ground,
/// entries of M between branches, felts that are open, tangents that touch nothing.
/// An addition, multiplication, division, comparison or square root counts 1, a power 50, sine and cosine of an angle 40:
/// about the instructions of the C library's. One-step problems count nothing: they are what a step may be spared.
/// Felts without mass alone are counted; the drive is a piston.
Work least_work(const Mechanism& mechanism, const State& after);

}  // namespace erard::bench
