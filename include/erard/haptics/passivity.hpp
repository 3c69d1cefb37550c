// Keeps the joint between the device and the simulated action from giving energy that nobody put in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "erard/haptics/fault.hpp"

namespace erard {

/// Kelvin-Voigt element between the device and the simulated key.                 thesis 5.4.1
/// The thesis's constants are for a finger in a computer; a device has its own, RenderSettings.
struct Coupling {
  double stiffness = 6500;  // a [N/m]                                           thesis Table 3.1
  double damping = 134;     // b [N s/m]
};

struct PassivitySettings {
  bool is_on = true;
  double reserve = 2e-3;           // credit of the joint, at most [J]
  Coupling safe_coupling{500, 1};  // that the device takes whoever holds it; of the drive `key` the damping alone
  double device_damping = 1;       // of the lever and the finger themselves, at least [N s/m]
  double loop_delay = 8e-4;        // from the instant of a sample to the force that it makes [s]
  double sensor_noise = 5e-5;      // rms of a position [m]
  double hold_time = 0.5;          // for which the safe coupling stays, and until the key is let go [s]
};

/// What the joint did in the period that ends now.
struct JointEnergy {
  double way = 0;             // of the device [m]
  double given = 0;           // to the simulated key, integral of F dy [J]
  double stored = 0;          // in the spring of the coupling now, a max(0, Y - y)^2 / 2 [J]
  bool is_held_back = false;  // the force that acted was less than the simulated one
};

/// Observer and controller of passivity in the time domain. B. Hannaford, J.-H. Ryu, IEEE Trans. Robotics and
/// Automation 18(1), 2002. That the reference is the energy of the model, not zero: J.-H. Ryu, C. Preusche,
/// B. Hannaford, G. Hirzinger, IEEE Trans. Control Systems Technology 13(5), 2005. That a held force does exactly force times way:
/// S. Stramigioli, C. Secchi, A. van der Schaft, C. Fantuzzi, IEEE Trans. Robotics 21(4), 2005.
///
/// The action gives back what hammer, key and felts have stored, and more it cannot. What can create energy is the
/// joint between it and the device: samples, delay, held forces, and the element that they drive. Its ports are the
/// device (held force f, way of the sensor) and the simulated key (force F, way y). What went in, did not come out and
/// is not kept,
///   D += f dx + c dx^2 / T + n - integral F dy - d(stored)         D <= reserve
/// never falls in continuous time, where D' = b (Y' - y')^2. Here c dx^2 / T is for the damping of the device and the
/// finger, and n = sigma^2 (3 b / 2 T + a) for the noise of the sensor, which looks like energy made by the joint: the
/// newest sample's error makes a force of a + 3 b / 2 T times itself at most, and is undone by the next one. For 50 um
/// that is 0.16 W; a lever of 60 g against a rigid stop that shakes makes more before it is loud, docs/stability.md.
///
/// Where a limit of the force or a hot winding held it back, f is less than the simulated force: what is missing has not
/// been made by the joint, and comes back as little when the key returns. D stands meanwhile.
///
/// D begins with the reserve. When that is used up, the controller acts:
///   drive `piston`  the coupling becomes the safe one, in the simulation and so for both sides. An element that loses
///                   stiffness loses energy, and one that changes its damping neither gains nor loses any.
///   drive `key`     f = F + b_safe Y'
/// until hold_time is over and the key is let go, where the change back costs nothing.
///
/// To add damping alone, as the first paper does, is no help to the drive `piston`: held for a period and a period
/// late, damping b on a lever of mass m is itself unstable above b = m / T, 120 N s/m for 60 g at 2 kHz. Nor is it to
/// take some of it from the rendered force alone: the simulation goes on with the other, and the difference is
/// energy out of nothing. docs/device.md
class Passivity {
 public:
  static constexpr double kLongestDelay = 3e-3;  // of the loop [s]

  /// Takes account of the last period. @param noise_energy  n [J]
  void observe(const PassivitySettings& settings, double period, double noise_energy, const JointEnergy& now) noexcept {
    const double f = acting_force(settings, period);
    const double gained = f * now.way + settings.device_damping * now.way * now.way / period +
                          (f != 0 ? noise_energy : 0.0) - now.given - (now.stored - stored_);
    stored_ = now.stored;
    if (!now.is_held_back) surplus_ = std::min(surplus_ + gained, settings.reserve);
  }

  /// Decides. @return whether the safe coupling is due from the next period on
  bool act(const PassivitySettings& settings, double period, bool is_let_go) noexcept {
    held_ += period;
    if (surplus_ < 0) {
      is_acting_ = true;
      held_ = 0;
      surplus_ = settings.reserve;
    } else if (is_let_go && held_ >= settings.hold_time) {
      is_acting_ = false;
    }
    return is_acting_;
  }

  /// Begins anew: what the device does has nothing to do with the simulation, or the coupling was exchanged.
  void restart(const PassivitySettings& settings, double stored) noexcept {
    surplus_ = settings.reserve;
    stored_ = stored;
  }

  /// The force that was asked of the actuator this period, as it is to be expected [N].
  void remember(double force) noexcept {
    newest_ = (newest_ + 1) % kMemory;
    force_[newest_] = force;
  }

  bool is_acting() const noexcept { return is_acting_; }
  double surplus() const noexcept { return surplus_; }  // D [J]

 private:
  static constexpr int kMaxDelay = 150;  // periods: the longest delay at 50 kHz
  static constexpr int kMemory = kMaxDelay + 2;

  /// Mean over the period that ends now of the force on the key: it was asked for loop_delay earlier.
  double acting_force(const PassivitySettings& settings, double period) const noexcept {
    const double delay = std::clamp(settings.loop_delay / period, 0.0, double{kMaxDelay});
    const int whole = static_cast<int>(delay);
    const double part = delay - whole;
    return (1 - part) * asked(whole) + part * asked(whole + 1);
  }
  double asked(int ago) const noexcept { return force_[(newest_ - ago + kMemory) % kMemory]; }

  double surplus_ = 0, stored_ = 0, held_ = 0;
  bool is_acting_ = false;
  int newest_ = 0;
  std::array<double, kMemory> force_{};  // [N]
};

}  // namespace erard
