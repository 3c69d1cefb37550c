// What an actuator can make of a force: current [A] to ask for, and the force to expect of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "erard/haptics/fault.hpp"

namespace erard {

enum class ActuatorKind {
  none,        // no model: the force leaves as it is, for a controller that knows its actuator
  voice_coil,  // pushes and pulls
  mr_brake,    // magnetorheological: resists motion, nothing else
};

/// Force upwards on the key, against the finger, is positive, as is the current that makes it.
struct VoiceCoilSettings {
  double force_constant = 8;      // [N/A]
  double max_current = 3;         // [A]
  double continuous_current = 1;  // the winding stands it for ever [A]
  double thermal_time = 30;       // time constant of the winding [s]
};

struct MrBrakeSettings {
  double drag = 0.3;                // without current, against any motion [N]
  double yield_force = 25;          // of the fluid when saturated, besides the drag [N]
  double saturation_current = 0.8;  // scale of the approach to it [A]
  double max_current = 2;           // [A]
  double response_time = 0.005;     // first order, current to yield [s]
  double standstill_speed = 0.002;  // below it the key stands [m/s]
};

struct ActuatorSettings {
  ActuatorKind kind = ActuatorKind::voice_coil;
  VoiceCoilSettings voice_coil;
  MrBrakeSettings mr_brake;
};

struct ActuatorCommand {
  double current = 0;  // to ask for [A]
  double force = 0;    // to expect on the finger, upwards positive [N]
};

/// A winding that warms:
///   F = K I,   |I| <= allowed(u),   tau u' = (I / I_c)^2 - u
/// u is the excess temperature as a part of what the winding stands, I_c what it stands for ever. From u = kFoldFrom on
/// the allowed current goes from I_max to I_c on a straight line, which it reaches at u = 1: u does not exceed 1.
class VoiceCoil {
 public:
  ActuatorCommand command(const VoiceCoilSettings& settings, double period, double force, Fault& faults) noexcept {
    const double cold = std::clamp((1 - heat_) / (1 - kFoldFrom), 0.0, 1.0);
    const double continuous = std::min(settings.continuous_current, settings.max_current);
    const double allowed = continuous + cold * (settings.max_current - continuous);
    double current = force / settings.force_constant;
    if (std::abs(current) > allowed) {
      faults |= allowed < settings.max_current ? Fault::thermal_limited : Fault::current_limited;
      current = std::copysign(allowed, current);
    }
    const double load = current / settings.continuous_current;
    heat_ += period / settings.thermal_time * (load * load - heat_);
    return {current, settings.force_constant * current};
  }

  double heat() const noexcept { return heat_; }  // u, 0 .. 1

 private:
  static constexpr double kFoldFrom = 0.8;
  double heat_ = 0;
};

/// A brake can only take energy:
///   force on the finger = (drag + yield) sign(v),   tau yield' = yield(I) - yield,   yield(I) = Y (1 - exp(-I / I_s))
/// v > 0 downwards. Where the wanted force has the sign of -v it would have to push: the current is 0, and what is left
/// is the drag. Standing still it may hold: it takes any force of the finger up to drag + yield, so what is wanted is
/// what is expected, up to there. It holds in both directions then: a finger that lifts frees the key when the current
/// has gone, some response times later.
class MrBrake {
 public:
  ActuatorCommand command(const MrBrakeSettings& settings, double period, double force, double velocity,
                          Fault& faults) noexcept {
    const bool stands = std::abs(velocity) <= settings.standstill_speed;
    double current = 0;
    if (!stands && force * velocity < 0) {
      faults |= Fault::cannot_push;
    } else {
      current = current_for(settings, std::abs(force) - settings.drag);
      if (current >= settings.max_current) faults |= Fault::current_limited;
      current = std::min(current, settings.max_current);
    }
    const double goal = settings.yield_force * -std::expm1(-current / settings.saturation_current);
    yield_ += (goal - yield_) * -std::expm1(-period / settings.response_time);
    const double resistance = settings.drag + yield_;
    return {current, stands ? std::clamp(force, -resistance, resistance) : std::copysign(resistance, velocity)};
  }

 private:
  /// The inverse of yield(I); infinite beyond saturation.
  static double current_for(const MrBrakeSettings& settings, double yield) noexcept {
    return -settings.saturation_current * std::log1p(-std::clamp(yield / settings.yield_force, 0.0, 1.0));
  }

  double yield_ = 0;  // of the fluid now [N]
};

/// The actuator of one key.
class Actuator {
 public:
  /// @param force     wanted, upwards positive [N]
  /// @param velocity  of the key, downwards positive [m/s]
  ActuatorCommand command(const ActuatorSettings& settings, double period, double force, double velocity,
                          Fault& faults) noexcept {
    switch (settings.kind) {
      case ActuatorKind::voice_coil: return coil_.command(settings.voice_coil, period, force, faults);
      case ActuatorKind::mr_brake: return brake_.command(settings.mr_brake, period, force, velocity, faults);
      case ActuatorKind::none: break;
    }
    return {0, force};
  }

 private:
  VoiceCoil coil_;
  MrBrake brake_;
};

}  // namespace erard
