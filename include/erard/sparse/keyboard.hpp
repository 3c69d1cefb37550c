// Many actions on one frame that gives way: the linear part of one step of all of them, as one sparse system.
#pragma once

#include <span>
#include <vector>

#include "erard/erard.hpp"
#include "erard/sparse/delassus.hpp"

namespace erard {

/// What carries the actions: one body on a vertical slide and a spring.
struct KeyboardFrame {
  double mass = 40;        // [kg] an estimate: frame and keybed of a grand, what moves of them
  double stiffness = 4e6;  // [N/m] an estimate: its lowest mode at 50 Hz
  double viscous = 1e3;    // [N s/m] an estimate: 4 % of critical
};

/// The same action with that frame between it and the ground: coordinate 0 is the frame's, all others move up by one.
/// Contacts with the ground become contacts with the frame; the finger goes on to see the key as the frame does. The
/// spring is loaded so that frame and action rest at coordinate 0.
/// @param share  of the frame's mass, spring and loss that this action carries [-]
/// The model must have room for one more body.
Model put_on_frame(const Model& action, const KeyboardFrame& frame, double share);

/// Linear part of one step of one action, as the last linearisation of step() left it:
///   A dv = -R + H r
struct ActionStep {
  Eigen::MatrixXd A;           // iteration matrix (n x n)
  Eigen::VectorXd R;           // residual (n)
  Eigen::MatrixXd H;           // directions of the rows in play (n x m)
  std::vector<bool> is_fixed;  // clamped or prescribed coordinates (n)
};

/// Copies it out of the scratch of a step.
ActionStep last_linearisation(const Mechanism& mechanism, const Workspace& work);

/// All of them with coordinate 0, the frame's, in common: its entries add up.
struct KeyboardStep {
  SparseMatrix A;     // (n x n), n = 1 + sum of the actions' coordinates without the frame
  SparseMatrix H;     // (n x m)
  Eigen::VectorXd R;  // (n)
  /// Coordinate of the keyboard that is coordinate i > 0 of action k.
  int coordinate(int k, int i) const noexcept { return first[k] + i - 1; }
  std::vector<int> first;      // of each action
  std::vector<int> first_row;  // of each action, and their number m
};

/// @param actions     each with the frame as coordinate 0
/// @param is_clamped  the frame does not move
/// Rows and columns of fixed coordinates are those of the unit matrix, their loads zero, as in the step itself.
KeyboardStep assemble_keyboard(std::span<const ActionStep> actions, bool is_clamped);

}  // namespace erard
