// Timing of grand actions as published: travel time, key bottom, free flight, repetition.
#pragma once

#include <array>
#include <vector>

namespace erard::study {

enum class Touch {
  pressed,  // the finger starts on the key
  struck,   // it arrives with speed
};

/// t = factor v^exponent + offset [s], v: maximum hammer speed [m/s].
struct TimingCurve {
  double factor = 0;    // [s (m/s)^-exponent]
  double exponent = 0;  // [-]
  double offset = 0;    // [s]

  double at(double hammer_speed) const noexcept;
};

/// One instrument; each quantity for pressed and struck touch.
struct PublishedGrand {
  const char* name;
  std::array<TimingCurve, 2> travel;  // finger meets key to hammer meets string
  std::array<TimingCurve, 2> bottom;  // key bottom after hammer meets string
  std::array<TimingCurve, 2> flight;  // hammer free to hammer meets string
};

/// Goebl, Bresin and Galembo, "Touch and temporal behavior of grand piano actions", J. Acoust. Soc. Am. 118(2), 2005,
/// Figures 6 and 7, Table I: power curves through 2300 tones of five keys on three grands. The softest tones had
/// 0.18 m/s, the loudest 6.8; pressed tones seldom exceed 4 to 5 m/s. The constants are taken from notes that quote the paper.
/// The curve for key bottom of the Yamaha, struck, crosses zero at 4.3 m/s, where the paper speaks of 1.4 to 3.8 m/s.
const std::array<PublishedGrand, 3>& published_grands();

/// Least and greatest over the three instruments.
struct Band {
  double low = 0, high = 0;
};
Band published_travel(Touch touch, double hammer_speed);
Band published_bottom(Touch touch, double hammer_speed);
Band published_flight(Touch touch, double hammer_speed);

/// Askenfelt and Jansson, J. Acoust. Soc. Am. 88(1), 1990: key bottom after hammer meets string, piano and forte.
struct PublishedPoint {
  double hammer_speed;  // [m/s]
  double time;          // [s]
};
inline constexpr std::array<PublishedPoint, 2> kAskenfeltBottom{{{1, 0.012}, {5, -0.003}}};

}  // namespace erard::study
