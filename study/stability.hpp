// Which couplings a device may render with: settings that are compared, margins over everything that a device may meet,
// and simulated maps that check the linear ones.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "study/device_fidelity.hpp"
#include "study/hold.hpp"

namespace erard::study {

inline constexpr double kPeriod = 5e-4;           // [s] 2 kHz
inline constexpr double kCoilLag = 3e-4;          // [s] a coil of 1 mH and 3 ohm
inline constexpr double kNoise = 50e-6;           // rms of a cheap sensor [m]
inline constexpr double kFineNoise = 5e-6;        // of a good one [m]
inline constexpr double kLevers[] = {0.06, 0.2};  // [kg]
inline constexpr FingerSettings kFingers[] = {{200, 1}, {200, 20}, {1000, 5}, {5000, 1}, {5000, 20}};
inline constexpr FingerSettings kStops[] = {kRigidStop, {5e4, 20}};  // a lever held by something rigid

/// An estimator, made for a lever and a delay, and a coupling.
struct LoopSetting {
  std::string name;
  std::function<PistonEstimator(double lever_mass, int delay_periods)> estimator;
  Coupling coupling;
};

/// The thesis's coupling with the least estimator there is.
LoopSetting plain_setting();
/// What is stable everywhere with an estimator that sees positions alone.
LoopSetting cautious_setting();
/// What is with the observer.
LoopSetting observed_setting();
/// Estimators by themselves, for maps.
LoopSetting with_coupling(LoopSetting setting, const Coupling& coupling);

/// Smallest gain margin over the fingers.
double least_margin(const LoopSetting& setting, double lever_mass, int delay, std::span<const FingerSettings> fingers);
/// The same with a virtual key that is a free mass of 20, 60 or 150 g.
double least_margin_on_masses(const LoopSetting& setting, double lever_mass, int delay);
/// The same where the host thinks of another delay or another lever than there are.
double least_margin_misled(const LoopSetting& setting, double lever_mass, int delay, double told_mass, int told_delay);
/// Largest rms of the command over the fingers for noise on the position [N], by the linear model.
double noise_force(const LoopSetting& setting, double lever_mass, int delay, double noise);

/// The simulated loop of a setting. Cheap sensor, voice coil, lever with dry friction unless they are changed.
ClosedLoopSettings loop_of(const LoopSetting& setting, double lever_mass, int delay, const FingerSettings& finger);

/// The same with the host's whole pipeline. Two things that would hide a loop that shakes are left out: keys that stand
/// still have no feedback, so none may, and the winding stays cold, since a hot one holds a constant force. The host thinks of
/// one period of delay, as its file says, whatever there is.
/// @param device  of config/device.yaml
ClosedLoopSettings pipeline_loop(const RenderSettings& device, ActuatorKind actuator, double lever_mass, int delay,
                                 const FingerSettings& finger);

/// The action with its key clamped: the linear model's virtual key.
ActionFile with_rigid_key(ActionFile action);

/// Whether a hold of 20 N on a rigid key stays quiet, without dry friction and with noise of 2 um: command above 50 Hz
/// below 5 N rms after three seconds.
bool is_quiet_on_rigid_key(const ActionFile& rigid, const LoopSetting& setting, double lever_mass, int delay);
/// The same with 15 N on the bottom of the action itself.
bool is_quiet_on_bottom(const ActionFile& action, const LoopSetting& setting, double lever_mass, int delay);

}  // namespace erard::study
