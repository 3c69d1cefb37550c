// Scratch of one step of a batch, and the few operations that xsimd has no name for.
#pragma once

#include <xsimd/xsimd.hpp>

#include "batch.hpp"

namespace erard::lanes {

template <typename T>
using Mask = typename T::batch_bool_type;

/// The rule of std::max: where the two compare as equal, or not at all, the first. That is what the CPU's own instruction
/// gives when it is asked the other way round.
template <typename T>
T larger(const T& a, const T& b) noexcept {
  return xsimd::max(b, a);
}

template <typename T>
Vector<T> operator+(const Vector<T>& a, const Vector<T>& b) noexcept {
  return {a.x + b.x, a.y + b.y};
}
template <typename T>
Vector<T> operator-(const Vector<T>& a, const Vector<T>& b) noexcept {
  return {a.x - b.x, a.y - b.y};
}
template <typename T>
Vector<T> operator*(const T& s, const Vector<T>& a) noexcept {
  return {s * a.x, s * a.y};
}
template <typename T>
T dot(const Vector<T>& a, const Vector<T>& b) noexcept {
  return a.x * b.x + a.y * b.y;
}
template <typename T>
T cross(const Vector<T>& a, const Vector<T>& b) noexcept {
  return a.x * b.y - a.y * b.x;
}
template <typename T>
Vector<T> perp(const Vector<T>& a) noexcept {
  return {-a.y, a.x};
}

inline constexpr int kMaxPowers = 2 * kMaxContacts * kMaxLanes;

template <typename T>
struct PlacedContact {
  T gap;
  Vector<T> normal, point;
  T normal_lever[kMaxBodies], tangent_lever[kMaxBodies];  // along its path
};

/// What the sweeps of a step have been so far.
template <typename T>
struct Sweeps {
  T count = T(0.0), error = T(0.0);  // error: of the last ones
  Mask<T> is_converged = Mask<T>(false);
  unsigned tangents[kMaxLanes] = {};  // in play in the last ones
};

/// One-step problem of the rows in play alone.
template <typename T>
struct AlikeProblem {
  T W[kMaxFrictionRows * kMaxFrictionRows];  // row by row, without gaps
  T q[kMaxFrictionRows], bound[kMaxFrictionRows];
};

/// As erard::Workspace, which see, for several keys at once.
template <typename T>
struct Work {
  static constexpr int kLanes = static_cast<int>(T::size);

  T end_velocity[kMaxBodies], middle_velocity[kMaxBodies], middle_position[kMaxBodies], end_shift[kMaxBodies];

  T placed_velocity[kMaxBodies], placed_position[kMaxBodies], placed_rate[kMaxBodies], start_shift[kMaxBodies];
  T angle[kMaxBodies], cosine[kMaxBodies], sine[kMaxBodies];
  Vector<T> origin[kMaxBodies], slide[kMaxBodies];
  PlacedContact<T> contact[kMaxContacts];
  T mass_matrix[kMaxBodies][kMaxBodies], bias[kMaxBodies];  // lower half

  T iteration_matrix[kMaxBodies][kMaxBodies], smooth_residual[kMaxBodies];  // lower half
  T felt_impulse[kMaxContacts], felt_loss[kMaxContacts], finger_impulse, finger_loss;
  T factor[kMaxBodies][kMaxBodies], change[kMaxBodies];
  T guess[2 * kMaxContacts + kMaxBodies];

  // felts: the numbers that a linearisation raises to a power, side by side whatever their contact and lane
  int power_count;
  double base[kMaxPowers + kMaxLanes], exponent[kMaxPowers + kMaxLanes], power[kMaxPowers + kMaxLanes];
  int power_of[kMaxPowers];  // of each its place among the numbers of `raised`
  // of each contact the power of its compression at the end, or the middle; then at the start
  T raised[2 * kMaxContacts];
  T end[kMaxContacts];
  Mask<T> is_acting[kMaxContacts], is_start_raised[kMaxContacts];
  bool acts[kMaxContacts];  // in any lane

  // friction of the step before
  Mask<T> is_out[kMaxBodies];
  T load[kMaxBodies];

  // one-step problem
  T half[kMaxFrictionRows][kMaxBodies], row_impulse[kMaxFrictionRows];
  T W[kMaxFrictionRows][kMaxFrictionRows];
  T q[kMaxFrictionRows], bound[kMaxFrictionRows];
  Mask<T> is_in_play[kMaxFrictionRows];
  AlikeProblem<T> alike;

  // of the lanes that are done
  T done_velocity[kMaxBodies], done_shift[kMaxBodies], done_guess[2 * kMaxContacts + kMaxBodies], done_finger;
};

}  // namespace erard::lanes
