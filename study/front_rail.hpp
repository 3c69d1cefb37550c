// The key on the front rail punching: how fast it should ring by thesis (6.1), (6.2), and how fast it does.
#pragma once

#include <string>
#include <vector>

#include "erard/device/action_file.hpp"

namespace erard::study {

/// The felt of the front rail about a steady force.
struct LinearRail {
  double compression = 0;  // delta [m]
  double stiffness = 0;    // k_lin [N/m]
};

/// delta = (F / k)^(1/r),  k_lin = k r delta^(r-1)                                 thesis (4.4), (6.1)
LinearRail linear_rail(double force) noexcept;

/// k_lin at a given compression [N/m]; the thesis rounds delta before it goes on.
double rail_stiffness(double compression) noexcept;

/// f_lin = sqrt(k_lin / m_eq) / (2 pi) [Hz]                                        thesis (6.2)
double ringing_frequency(double stiffness, double mass) noexcept;

/// m_eq = k_lin / (2 pi f)^2 [kg]: the mass at the rail that rings with that frequency.
double ringing_mass(double stiffness, double frequency) noexcept;

inline constexpr double kKeyMassAtRail = 0.062;  // m_eq without the player, thesis 6.4.1 [kg]

/// What a mass at the finger weighs at the rail, where the key's inertia J_1 weighs 62 g [kg].
double mass_at_rail(double mass) noexcept;

/// Mean interval of the maxima of a value that oscillates, as a frequency.
/// A maximum counts when the value, averaged over three samples, falls by `prominence` on both sides of it; its
/// time is that of the parabola through three of these. The average takes out kinks of a millisecond that contacts leave.
struct Oscillation {
  double frequency = 0;        // [Hz]; 0 with fewer than two maxima
  std::vector<double> maxima;  // times [s]
};
Oscillation find_oscillation(const std::vector<double>& time, const std::vector<double>& value, double prominence);

/// The finger force of a recorded stroke from the check of the hammer to the release of the key.
/// @param keystroke  name in config/keystrokes; @param release [s]
struct StrokeOscillation {
  Oscillation oscillation;
  double plateau = 0;  // finger force at the release [N]
  double rail = 0;     // reaction of the front rail at the release [N]
  double check = 0;    // of the backcheck [N]
  std::vector<double> time, force;
};
StrokeOscillation stroke_oscillation(const std::string& keystroke, double release);

/// The key held on the rail by a steady force, the hammer free of the backcheck, a mass riding on it at the finger, and
/// the force raised by a tenth: how the reaction of the rail rings.
struct HeldKey {
  double mass = 0;       // of the player, at the finger [kg]
  double rail = 0;       // reaction of the rail after the rise [N]
  double frequency = 0;  // from its extremes, 0 when it does not swing over [Hz]
  double predicted = 0;  // thesis (6.2) with that reaction, the key's inertia and the mass [Hz]
};
HeldKey ring_held_key(double force, double mass);

}  // namespace erard::study
