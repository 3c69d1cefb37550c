// When a key may be left alone without anybody noticing.
#pragma once

#include <cmath>

#include "erard/haptics/finger.hpp"
#include "erard/mechanics/state.hpp"

namespace erard {

/// What counts as rest: for a while nothing differs from what it was at its first instant by more than this. Under dry
/// friction an action does not creep to a stop, it stops: the grand action's angles keep every bit then, its felts, where
/// they have mass, jitter by 1e-18 m, rates by 1e-14 rad/s, the force of the finger by 1e-15 N; only felts that were left
/// behind go on relaxing. The bounds stand above that noise and far below what a force could show.
struct SleepSettings {
  bool is_on = true;
  int calm_ticks = 20;         // long enough: a body at the top of its flight has no rate for one
  double rate = 1e-12;         // of any coordinate, the first and quickest look [rad/s] or [m/s]
  double coordinate = 1e-17;   // change of any; of those above 0.07, less than one bit [rad] or [m]
  double force = 1e-10;        // the same, of the finger [N]
  double reaction = 1e-11;     // of any row [N], hinges [N m]
  double compression = 1e-13;  // of any massless felt [m]

  /// Lets the creep of the solver count as rest. One-step problems are solved to a tolerance, and of some rests, one in
  /// six, that leaves 1e-11 to 5e-10 rad/s at which things creep that should stick; by the bounds above they never sleep.
  /// By these all do, and forces differ by up to 1e-6 N from those without sleep.
  static SleepSettings eager() noexcept { return {true, 20, 1e-8, 1e-10, 1e-7, 1e-6, 1e-9}; }
};

/// Whether all rates are those of something at rest.
inline bool is_still(const SleepSettings& settings, const State& state) noexcept {
  for (int i = 0; i < state.v.size(); ++i)
    if (!(std::abs(state.v[i]) <= settings.rate)) return false;
  return true;
}

/// Whether no element of two vectors differs by more than `bound`; false where one is not a number.
template <typename Vector>
bool is_near(const Vector& one, const Vector& other, double bound) noexcept {
  for (int i = 0; i < one.size(); ++i)
    if (!(std::abs(one[i] - other[i]) <= bound)) return false;
  return true;
}

/// Whether two states of one mechanism, some time apart, are the same rest.
inline bool is_same_rest(const SleepSettings& settings, const State& one, const State& other) noexcept {
  return one.time_step == other.time_step && is_near(one.x, other.x, settings.coordinate) &&
         is_near(one.compression, other.compression, settings.compression) &&
         is_near(one.impulse, other.impulse, settings.reaction * one.time_step);
}

/// Whether two samples are the same drive.
inline bool is_same(const DriveSample& one, const DriveSample& other) noexcept {
  return one.value == other.value && one.rate == other.rate;
}

/// A piston in the air does nothing, wherever it is there. Its element gives no force while
///   a Y + b Y' <= a y + b y' - margin                                            thesis 5.4.1
/// and the line between two such samples does not either. The right side is `air` of a key at rest.
inline double piston_load(const Finger& finger, const DriveSample& piston) noexcept {
  return finger.stiffness * piston.value + finger.damping * piston.rate;
}
inline double air_load(const Model& model, const State& state) noexcept {
  constexpr double kMargin = 1e-9;  // [N], b y' of a key that rests is below 1e-10
  return piston_load(model.finger, {key_position(model, state), key_velocity(model, state)}) - kMargin;
}

}  // namespace erard
