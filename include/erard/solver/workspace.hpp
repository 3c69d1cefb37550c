// Scratch of one step. Nothing here is read before it is written in the same step.
#pragma once

#include "erard/mechanics/dynamics.hpp"
#include "erard/solver/one_step_problem.hpp"

namespace erard {

using DirectionMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxCoordinates, kMaxRows>;

struct Workspace {
  // the iterate: end of the step, and the instant t + theta h at which the smooth terms are taken
  CoordinateVector end_velocity;     // v_{n+1} (n)
  CoordinateVector middle_velocity;  // v_{n+theta} (n)
  CoordinateVector middle_position;  // x_{n+theta} (n)
  CoordinateVector free_velocity;    // end velocity without the reactions (n)
  CoordinateVector end_position;     // x_{n+1} (n)

  // mechanics at the middle
  Frames frames;
  ContactFrames contacts;
  CoordinateMatrix mass_matrix;                // M (n x n)
  CoordinateMatrix iteration_matrix;           // A = M + h theta C + h^2 theta^2 K, then its factors (n x n)
  CoordinateVector bias;                       // N v - weight (n)
  CoordinateVector smooth_residual;            // M (v_{n+1} - v_n) - h loads, without the reactions (n)
  std::array<bool, kMaxCoordinates> is_fixed;  // clamped, or prescribed by the drive

  // rows in play
  DirectionMatrix all_directions;         // H of every row of the RowTable: impulse to generalised impulse
  std::array<bool, kMaxRows> is_in_play;  // of each row of the RowTable, kept over the Newton iterations
  std::array<int, kMaxRows> place;        // of each row of the RowTable among those in play
  int row_count;                          // m
  std::array<int, kMaxRows> row;          // number in the RowTable of each row in play
  DirectionMatrix velocity_per_impulse;   // A^-1 H (n x m)
  OneStepProblem problem;
  RowVector impulse;  // r of the rows in play (m)
  RowVector guess;    // last known impulse of every row of the RowTable

  CoordinateVector scratch;  // (n)
};

}  // namespace erard
