// When a key may be left alone without anybody noticing.
#pragma once

#include <cmath>

#include "erard/haptics/finger.hpp"

namespace erard {

/// What counts as rest. Under dry friction an action does not creep to a stop, it stops: within 0.15 s of the last touch
/// the grand action's coordinates do not change by a bit any more, its rates are below 1e-14 rad/s, the force of the finger
/// moves by less than 1e-16 N a tick, and only felts that were left behind go on relaxing. The bounds stand two
/// decades and more above that noise and are far below what a force could show.
struct SleepSettings {
  bool is_on = true;
  int calm_ticks = 20;         // so many in a row without change: a body at the top of its flight has none for one
  double rate = 1e-12;         // of any coordinate, at most [rad/s] or [m/s]
  double force = 1e-10;        // change of the finger's force since the first calm tick, at most [N]
  double reaction = 1e-12;     // change of any row's reaction in a tick, at most [N], hinges [N m]
  double compression = 1e-14;  // change of any massless felt in a tick, at most [m]
};

/// Whether all rates are those of something at rest.
inline bool is_still(const SleepSettings& settings, const State& state) noexcept {
  for (int i = 0; i < state.v.size(); ++i)
    if (!(std::abs(state.v[i]) <= settings.rate)) return false;
  return true;
}

/// Whether a tick left the state as it was: every coordinate to the last bit, so that a creep too slow for a double is
/// none in the engine either; the rest of the state within the bounds.
inline bool is_unchanged(const SleepSettings& settings, const State& before, const State& after) noexcept {
  if (before.x != after.x || before.time_step != after.time_step || !is_still(settings, after)) return false;
  for (int i = 0; i < after.compression.size(); ++i)
    if (!(std::abs(after.compression[i] - before.compression[i]) <= settings.compression)) return false;
  for (int i = 0; i < after.impulse.size(); ++i)
    if (!(std::abs(after.impulse[i] - before.impulse[i]) <= settings.reaction * after.time_step)) return false;
  return true;
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
