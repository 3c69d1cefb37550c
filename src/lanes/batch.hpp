// What a batch of keys is made of: their common structure, their numbers, what moves them, how it ended. Known to the
// engine and to every kernel alike, hence without Eigen, whose types look different under other compiler flags.
#pragma once

#include "erard/model/capacity.hpp"
#include "tables.hpp"

namespace erard::lanes {

inline constexpr int kMaxLanes = 8;

/// One body of the structure. Its coordinate has its number: felts with mass, which would have others, are not stepped
/// in lanes.
struct BodyPlan {
  int parent;         // or -1, the ground
  bool is_prismatic;  // else a hinge
  bool is_fixed;      // clamped
  int above_count;    // coordinates above it in the elimination tree, nearest first
  int above[kMaxBodies];
  bool operator==(const BodyPlan&) const = default;
};

/// One contact in play.
struct ContactPlan {
  int number;          // in the model
  int body_a, body_b;  // or -1
  bool is_segment_a, is_segment_b;
  bool is_point_on_b;  // where friction acts
  int row;             // of its normal in the RowTable
  bool has_friction;
  int path_count;  // coordinates of its path, ascending
  int path[kMaxBodies];
  double sign[kMaxBodies];
  bool operator==(const ContactPlan&) const = default;
};

/// Friction of a tangent or of a hinge.
struct FrictionRowPlan {
  int row;          // in the RowTable
  int contact;      // of a tangent, its place in Plan::contact; or -1
  int coordinate;   // of a hinge, or -1
  bool is_angular;  // a hinge that turns
  bool operator==(const FrictionRowPlan&) const = default;
};

inline constexpr int kMaxFrictionRows = kMaxContacts + kMaxBodies;

/// Structure that the keys of a batch share.
struct Plan {
  int body_count;
  int contact_count;       // in play
  int row_count;           // of the RowTable
  int friction_row_count;  // tangents first, then hinges, in the order of the RowTable
  int finger_body;         // or -1
  BodyPlan body[kMaxBodies];
  ContactPlan contact[kMaxContacts];
  FrictionRowPlan friction_row[kMaxFrictionRows];
  bool operator==(const Plan&) const = default;
};

template <typename T>
struct Vector {
  T x, y;
};

template <typename T>
struct BodyNumbers {
  Vector<T> origin, direction, centre;
  T mass, inertia, viscous, stiffness, rest, initial;
  T dry;
};

template <typename T>
struct ShapeNumbers {
  Vector<T> centre, direction;
  T half_length, radius;
};

template <typename T>
struct ContactNumbers {
  ShapeNumbers<T> shape_a, shape_b;
  T friction, stiffness, exponent, damping;
};

/// Parameters of the actions, one lane each.
template <typename T>
struct ActionNumbers {
  Vector<T> gravity;
  T total_mass;
  T finger_arm, finger_stiffness, finger_damping;
  BodyNumbers<T> body[kMaxBodies];
  ContactNumbers<T> contact[kMaxContacts];  // in play
};

/// Numbers of a State. Compressions of the contacts in play alone.
template <typename T>
struct StateNumbers {
  T x[kMaxBodies], v[kMaxBodies], acceleration[kMaxBodies];
  T compression[kMaxContacts];
  T impulse[2 * kMaxContacts + kMaxBodies];  // rows of the RowTable
  T time_step;
};

enum class Push { none, force, piston };

template <typename T>
struct DriveNumbers {
  T from_value, from_rate, to_value, to_rate;
};

/// Part of a Scheme that the lanes look at.
struct Settings {
  double time_step, theta, surprise_limit;
  int newton_limit;
  double newton_tolerance, placement_tolerance;
  bool is_friction_recalled;
  int sweep_limit;
  double sweep_tolerance;
  Push push;
};

/// How the step ended, lane by lane. A lane that is neither taken nor refused is left to the scalar engine.
struct Outcome {
  bool is_taken[kMaxLanes];
  bool is_refused[kMaxLanes];   // by the surprise limit
  bool is_at_limit[kMaxLanes];  // of the linearisations: taken as the best found
  int linearisations[kMaxLanes];
  int sweeps[kMaxLanes];
  unsigned tangents[kMaxLanes];  // bit by bit, in play in the last sweeps; 0 where there were none
  double newton_change[kMaxLanes], surprise[kMaxLanes], sweep_error[kMaxLanes], finger_force[kMaxLanes];
};

/// What the lanes leave to code that handles one number at a time: with it their bits are those of the scalar engine.
struct Calls {
  const Tables* tables;
  double (*power)(double base, double exponent) noexcept;
  void (*turn)(double angle, double* cosine, double* sine) noexcept;
  /// Compression of a felt that is left alone for a while.
  double (*relax)(double time, double stiffness, double exponent, double damping, double compression) noexcept;
};

/// All of one step of a batch. Numbers of lane l stand at [l] of each T.
struct Batch {
  const Plan* plan;
  const Settings* settings;
  const Calls* calls;
  const void* action;   // ActionNumbers<T>
  const void* drive;    // DriveNumbers<T>
  void* state;          // StateNumbers<T>: in start, out end of the step in the lanes taken, of no use in the others
  const bool* is_used;  // of each lane
  Outcome* outcome;
  void* work;  // scratch
};

/// The step for one instruction set.
struct Kernel {
  int lanes;
  unsigned long work_size;  // bytes of scratch, at a multiple of 64
  void (*step)(const Batch& batch) noexcept;
};

const Kernel& kernel_baseline() noexcept;
const Kernel& kernel_avx2() noexcept;
const Kernel& kernel_avx512() noexcept;

}  // namespace erard::lanes
