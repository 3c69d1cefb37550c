#include "erard/device/rig.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace erard {
namespace {

void require(bool is_met, const char* name, double value, const char* rule) {
  if (!is_met || !std::isfinite(value))
    throw std::invalid_argument(fmt::format("rig: {} = {:g}, must be {}", name, value, rule));
}

RigSettings checked(const RigSettings& rig) {
  require(rig.sub_step > 0, "sub_step", rig.sub_step, "> 0 s");
  require(rig.lever.mass > 0, "lever.mass", rig.lever.mass, "> 0 kg");
  require(rig.lever.dry_friction >= 0, "lever.dry_friction", rig.lever.dry_friction, ">= 0 N");
  require(rig.lever.viscous >= 0, "lever.viscous", rig.lever.viscous, ">= 0 N s/m");
  require(rig.lever.return_stiffness >= 0, "lever.return_stiffness", rig.lever.return_stiffness, ">= 0 N/m");
  require(true, "lever.return_force", rig.lever.return_force, "finite, in N");
  require(rig.lever.depth > 0, "lever.depth", rig.lever.depth, "> 0 m");
  require(rig.finger.stiffness >= 0, "finger.stiffness", rig.finger.stiffness, ">= 0 N/m");
  require(rig.finger.damping >= 0, "finger.damping", rig.finger.damping, ">= 0 N s/m");
  require(rig.sensor.resolution >= 0, "sensor.resolution", rig.sensor.resolution, ">= 0 m");
  require(rig.sensor.noise >= 0, "sensor.noise", rig.sensor.noise, ">= 0 m");
  constexpr double kLongest = 0.1;  // [s] beyond it no loop could be closed
  require(rig.sensor.delay >= 0 && rig.sensor.delay <= kLongest, "sensor.delay", rig.sensor.delay, "0 to 0.1 s");
  const VirtualActuatorSettings& actuator = rig.actuator;
  require(actuator.dead_time >= 0 && actuator.dead_time <= kLongest, "actuator.dead_time", actuator.dead_time,
          "0 to 0.1 s");
  require(actuator.time_constant >= 0, "actuator.time_constant", actuator.time_constant, ">= 0 s");
  require(actuator.limit >= 0, "actuator.limit", actuator.limit, ">= 0 N");
  require(actuator.off_drag >= 0, "actuator.off_drag", actuator.off_drag, ">= 0 N");
  return rig;
}

}  // namespace

Rig::Rig(const RigSettings& settings, Keystroke intended)
    : settings_(checked(settings)),
      intended_(std::move(intended)),
      sensor_(settings.sensor, settings.sub_step),
      actuator_(settings.actuator, settings.sub_step) {
  if (intended_.quantity() != KeystrokeQuantity::position)
    throw std::invalid_argument("rig: the intended motion must be a keystroke of position, this one is of force");
}

Motion Rig::intended_at(double time) const noexcept {
  const Sample sample = intended_.at(time);
  return {sample.value, sample.rate};
}

void Rig::advance(double seconds, double command) noexcept {
  constexpr double kWhole = 1 - 1e-6;  // sums of periods are not whole sub-steps to the last bit
  for (due_ += seconds; due_ >= kWhole * settings_.sub_step; due_ -= settings_.sub_step) sub_step(command);
}

void Rig::sub_step(double command) noexcept {
  const double h = settings_.sub_step;
  const double start = intended_.start() + static_cast<double>(steps_) * h;
  const ActuatorLoad load = actuator_.advance(command);
  state_.lever = advance_lever(settings_.lever, settings_.finger, intended_at(start + h / 2), load, h, state_.lever);
  sensor_.follow(state_.lever.position);
  ++steps_;
  state_.time = static_cast<double>(steps_) * h;
  state_.finger_force = finger_force(settings_.finger, intended_at(start + h), state_.lever);
  state_.actuator_force = actuator_.force();
}

}  // namespace erard
