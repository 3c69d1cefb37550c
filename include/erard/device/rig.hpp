// The virtual device for one key, with the finger that plays it: lever, sensor, actuator and finger take the place of the
// hardware. Its clock is the caller's: advance() is told how far, so that a program may pace it and a study may not.
#pragma once

#include "erard/device/keystroke.hpp"
#include "erard/device/virtual_actuator.hpp"
#include "erard/device/virtual_lever.hpp"
#include "erard/device/virtual_sensor.hpp"

namespace erard {

struct RigSettings {
  LeverSettings lever;
  VirtualSensorSettings sensor;
  VirtualActuatorSettings actuator;
  FingerSettings finger;
  double sub_step = 2.5e-5;  // 40 kHz [s]; the rigid stop on 60 g swings with 145 Hz, to 5e-5 of its period
};

/// What is so at one instant.
struct RigState {
  double time = 0;            // since the start [s]
  Motion lever;               // the truth, not the sensor's [m], [m/s]
  double finger_force = 0;    // of the finger on the lever, never negative [N]
  double actuator_force = 0;  // see VirtualActuator::force [N]
};

/// Deterministic: the same settings and calls give the same bits.
class Rig {
 public:
  /// Starts with the lever at its upper stop.
  /// @param intended  motion of the finger [m]: where it would go if nothing were in its way
  /// Throws std::invalid_argument with the value and the rule when a setting cannot be, or the keystroke is one of force.
  Rig(const RigSettings& settings, Keystroke intended);

  /// Goes on by `seconds` with the command held: whole sub-steps; the rest is kept for the next call.
  /// @param command  force by which the device is to lift the lever [N]
  void advance(double seconds, double command) noexcept;

  /// A sample of the sensor, now [m]. Each call draws its own noise.
  double measure() noexcept { return sensor_.measure(); }

  const RigState& state() const noexcept { return state_; }
  const RigSettings& settings() const noexcept { return settings_; }

 private:
  void sub_step(double command) noexcept;
  Motion intended_at(double time) const noexcept;

  RigSettings settings_;
  Keystroke intended_;
  VirtualSensor sensor_;
  VirtualActuator actuator_;
  RigState state_;
  long steps_ = 0;
  double due_ = 0;  // told, not yet gone [s]
};

}  // namespace erard
