// When the hammer hits the string, and how fast: what a synthesiser wants to know.
#pragma once

#include <cmath>
#include <limits>

#include "erard/haptics/events.hpp"

namespace erard {

/// One blow on the string.
struct HammerEvent {
  int key = 0;
  double time = 0;   // end of the internal step that saw the force, on the keyboard's clock [s]
  double speed = 0;  // of the centre of the hammer's head in the step before [m/s]
};

/// Finds blows from step to step, as EventDetector does, which keeps the history of one key besides.
class HammerWatch {
 public:
  static constexpr double kLockOut = 0.010;  // [s] between two blows; shorter ones are one

  /// Looks at the state after one internal step. @return whether a blow began
  bool observe(const Mechanism& mechanism, const ActionRoles& roles, const State& state) noexcept {
    if (roles.string < 0 || roles.hammer == kGround) return false;
    const int row = mechanism.normal_row[roles.string];
    const bool touches = row >= 0 && state.impulse[row] > 0;
    const bool is_blow = touches && !touched_ && state.time - last_ > kLockOut;
    touched_ = touches;
    if (is_blow) {
      last_ = state.time;
      blow_speed_ = speed_;
    }
    speed_ = head_speed(mechanism.model, roles, state);
    return is_blow;
  }

  double speed() const noexcept { return blow_speed_; }  // of the last blow [m/s]

 private:
  static double head_speed(const Model& model, const ActionRoles& roles, const State& state) noexcept {
    double rate = 0;
    for (int j = roles.hammer; j != kGround; j = model.bodies[j].parent)
      if (model.bodies[j].joint == JointKind::hinge) rate += state.v[j];
    const Contact& string = model.contacts[roles.string];
    return std::abs(rate) * (string.body_a == roles.hammer ? string.shape_a : string.shape_b).centre.norm();
  }

  bool touched_ = false;
  double last_ = -std::numeric_limits<double>::infinity();  // [s]
  double speed_ = 0, blow_speed_ = 0;
};

}  // namespace erard
