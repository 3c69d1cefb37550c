// Keeps the joint between the device and the simulated action from giving energy that nobody put in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "erard/haptics/fault.hpp"

namespace erard {

struct PassivitySettings {
  bool is_on = true;
  double reserve = 2e-4;       // energy that the joint may be in debt before the controller acts in full [J]
  double safe_damping = 30;    // that the device takes at this rate and delay [N s/m]
  double device_damping = 1;   // of the lever and the finger themselves, at least [N s/m]
  double loop_delay = 5e-4;    // from the instant of a sample to the force it makes on the key [s]
  double sensor_noise = 5e-6;  // rms of a position [m]
  double release_time = 0.5;   // in which the controller lets go, to 1/e [s]
};

/// Energy of the joint in one period.
struct JointEnergy {
  double way = 0;     // of the device since the last sample [m]
  double given = 0;   // to the simulated key during the period, integral of F dy [J]
  double stored = 0;  // in the spring of the coupling now, a max(0, Y - y)^2 / 2 [J]
};

/// Observer and controller of passivity in the time domain. B. Hannaford, J.-H. Ryu, IEEE Trans. Robotics and
/// Automation 18(1), 2002; that the reference is the energy of the model itself, not zero: J.-H. Ryu, C. Preusche,
/// B. Hannaford, G. Hirzinger, IEEE Trans. Control Systems Technology 13(5), 2005; that energy over a period of a held force
/// is exactly force times way: S. Stramigioli, C. Secchi, A. van der Schaft, C. Fantuzzi, IEEE Trans. Robotics 21(4), 2005.
///
/// What gives back its own energy (hammer, key, felts) is the action, and it is passive by itself. What can create energy is the joint: samples, delay, held force, and
/// the Kelvin-Voigt element that they drive. Its ports are the device (held force f, way of the sensor) and the simulated
/// key (force F, way y). What the joint took in and neither gave nor keeps is
///   D += f dx + c dx^2 / T + n - integral F dy - d(stored)              -reserve <= D <= reserve
/// with c dx^2/T for the device's own damping and n = sigma^2 (3/2 b / T + a) for the noise of the sensor, which looks
/// like generated energy. A passive joint has D >= 0, and a coupling in continuous time has D' = b (Y' - y')^2.
///
/// When D < 0, the damping that the coupling shows to the device moves from b to the safe damping,
///   f = F + g (b_safe - b) (Y' - y')        g = max(clamp(-D / reserve, 0, 1), g exp(-T / release_time))
/// which adds damping where the coupling has too little, and takes away where its damping itself is what shakes:
/// damping b on a lever of mass m is unstable above b = m / T with a period of delay, and adding more, as Hannaford and Ryu do, makes it worse.
class Passivity {
 public:
  static constexpr int kMaxDelay = 6;  // periods

  /// Looks at what the last period did. @param allowance  n [J]
  void observe(const PassivitySettings& settings, double period, double allowance, const JointEnergy& now,
               Fault& faults) noexcept {
    const double f = acting_force(settings, period);
    const double gained = f * now.way + settings.device_damping * now.way * now.way / period +
                          (f != 0 ? allowance : 0.0) - now.given - (now.stored - stored_);
    stored_ = now.stored;
    surplus_ = std::clamp(surplus_ + gained, -settings.reserve, settings.reserve);
    const double need = std::max(-surplus_ / settings.reserve, 0.0);
    share_ = std::max(need, share_ * (1 - std::min(period / settings.release_time, 1.0)));
    if (share_ < kNothing) share_ = 0;
    if (share_ > 0) faults |= Fault::passivity_acted;
  }

  /// Begins anew: what the device does at the moment has nothing to do with the simulation.
  void restart(const PassivitySettings& settings, double stored) noexcept {
    surplus_ = settings.reserve;
    stored_ = stored;
  }

  /// The force that was asked of the actuator this period, as it is expected [N].
  void remember(double force) noexcept {
    newest_ = (newest_ + 1) % kMemory;
    force_[newest_] = force;
  }

  double share() const noexcept { return share_; }      // g, 0 .. 1
  double surplus() const noexcept { return surplus_; }  // D [J]

 private:
  static constexpr int kMemory = kMaxDelay + 2;
  static constexpr double kNothing = 1e-3;  // of the share

  /// Mean over the period that ends now of the force that acted on the key: it was asked for loop_delay earlier.
  double acting_force(const PassivitySettings& settings, double period) const noexcept {
    const double delay = std::clamp(settings.loop_delay / period, 0.0, double{kMaxDelay});
    const int whole = static_cast<int>(delay);
    const double part = delay - whole;
    return (1 - part) * asked(whole) + part * asked(whole + 1);
  }
  double asked(int ago) const noexcept { return force_[(newest_ - ago + kMemory) % kMemory]; }

  double surplus_ = 0, stored_ = 0, share_ = 0;
  int newest_ = 0;
  std::array<double, kMemory> force_{};  // [N]
};

}  // namespace erard
