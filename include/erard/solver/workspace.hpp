// Scratch of one step. Nothing here is read before it is written in the same step.
#pragma once

#include "erard/mechanics/dynamics.hpp"
#include "erard/solver/one_step_problem.hpp"

namespace erard {

using Coordinates = std::array<double, kMaxCoordinates>;  // of which the first n count

/// Impulse of a law that is a function of the velocity at the end of the step, linearised about the iterate.
struct CompliantImpulse {
  double impulse = 0;  // at the iterate [N s]
  double loss = 0;     // of impulse per m/s of velocity along the row [N s/(m/s)]
};

struct Workspace {
  // the iterate: end of the step, and the instant t + theta h at which the smooth terms are taken
  Coordinates end_velocity;     // v_{n+1}
  Coordinates middle_velocity;  // v_{n+theta}
  Coordinates middle_position;  // x_{n+theta}
  Coordinates end_shift;        // x_{n+1} less the position at which the frames are

  // mechanics where the frames were placed: at the middle of an iterate
  Coordinates placed_velocity;  // end velocity of that iterate
  Coordinates placed_position;
  Coordinates start_shift;  // x_n less that position
  Frames frames;
  ContactFrames contacts;
  CoordinateMatrix mass_matrix;                        // M (n x n)
  Coordinates bias;                                    // N v - weight
  std::array<PathValues, kMaxContacts> normal_lever;   // H of each contact's normal, along its path
  std::array<PathValues, kMaxContacts> tangent_lever;  // H of its tangent, where it has friction

  // smooth terms, linearised about the iterate
  CoordinateMatrix iteration_matrix;                // A = M + h theta C + h^2 theta^2 K (n x n), lower half
  Coordinates smooth_residual;                      // R = M (v_{n+1} - v_n) - h loads, without the rows in play
  std::array<CompliantImpulse, kMaxContacts> felt;  // of the felts without mass
  CompliantImpulse finger;                          // of the piston's Kelvin-Voigt element
  std::array<bool, kMaxCoordinates> is_fixed;       // clamped, or prescribed by the drive
  CoordinateMatrix factor;                          // A = L^T D L: 1/D on the diagonal, L below it (n x n)
  Coordinates change;                               // of the end velocity by this linearisation

  // rows in play: those of the one-step problem
  Coordinates free_velocity;               // end velocity without their reactions
  Coordinates free_shift;                  // as end_shift, with that velocity
  std::array<bool, kMaxRows> is_in_play;   // of each row of the RowTable, kept over the Newton iterations
  std::array<int, kMaxRows> place;         // of each row of the RowTable among those in play
  int row_count;                           // m
  std::array<int, kMaxRows> row;           // number in the RowTable of each row in play
  std::array<Coordinates, kMaxRows> half;  // L^-T H of each row in play
  std::array<int, kMaxRows> last;          // coordinate beyond which that is zero
  OneStepProblem problem;
  RowVector impulse;  // r of the rows in play (m)
  RowVector guess;    // last known impulse of every row of the RowTable
};

}  // namespace erard
