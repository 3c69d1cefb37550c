// The actuator of the virtual device: what becomes of a commanded force.
#pragma once

#include <algorithm>
#include <cmath>

#include "erard/device/delay_line.hpp"
#include "erard/device/virtual_lever.hpp"

namespace erard {

enum class VirtualActuatorKind {
  voice_coil,  // pushes and pulls
  mr_brake,    // magnetorheological fluid: resists sliding, at rest and in motion, and never moves anything
};

struct VirtualActuatorSettings {
  VirtualActuatorKind kind = VirtualActuatorKind::voice_coil;
  double time_constant = 0.0003;  // of the first-order answer: inductance over resistance, or the fluid's [s]
  double dead_time = 0;           // before it [s], to the nearest sub-step
  double limit = 30;              // of the force: the current's or the fluid's saturation [N]
  double off_drag = 0;            // by which an unpowered brake resists [N]

  /// Coils of 1 mH and 3 ohm settle in 0.3 ms; fluids take 1 to 10 ms and drag when off.
  static VirtualActuatorSettings voice_coil() noexcept { return {}; }
  static VirtualActuatorSettings mr_brake() noexcept { return {VirtualActuatorKind::mr_brake, 0.003, 0.0005, 30, 0.1}; }
};

/// Command to load, sub-step by sub-step: dead time, limit, first-order lag solved exactly for a held command.
class VirtualActuator {
 public:
  VirtualActuator(const VirtualActuatorSettings& settings, double sub_step)
      : settings_(settings), dead_(static_cast<int>(std::lround(settings.dead_time / sub_step))) {
    const double ratio = settings.time_constant > 0 ? sub_step / settings.time_constant : HUGE_VAL;
    kept_at_end_ = std::exp(-ratio);
    kept_in_mean_ = std::isinf(ratio) ? 0 : -std::expm1(-ratio) / ratio;
  }

  /// @param command  force, positive where it lifts the lever [N]; a brake takes what is negative for 0
  /// @return mean load of the sub-step
  ActuatorLoad advance(double command) noexcept {
    const bool is_brake = settings_.kind == VirtualActuatorKind::mr_brake;
    const double least = is_brake ? 0 : -settings_.limit;
    const double target = std::clamp(dead_.push(command), least, settings_.limit);
    const double mean = target + kept_in_mean_ * (force_ - target);
    force_ = target + kept_at_end_ * (force_ - target);
    return is_brake ? ActuatorLoad{0, settings_.off_drag + mean} : ActuatorLoad{mean, 0};
  }

  /// Now: of a voice coil its push, up positive; of a brake the grip its field gives [N].
  double force() const noexcept { return force_; }

 private:
  VirtualActuatorSettings settings_;
  DelayLine dead_;
  double kept_at_end_, kept_in_mean_;  // shares of what it was before
  double force_ = 0;
};

}  // namespace erard
