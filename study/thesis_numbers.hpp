// Printed numbers of the thesis that more than one study starts from.
#pragma once

#include <array>

namespace erard::study::thesis {

// Table 2.1. Index 0 key, 1 whippen with jack and lever, 2 hammer; moments counterclockwise.
inline constexpr double kArm = 0.245;                                        // L, finger from the key's axis [m]
inline constexpr double kL12 = 0.129, kL21 = 0.060;                          // key and whippen, at their contact [m]
inline constexpr double kL23 = 0.080, kL32 = 0.017;                          // whippen and hammer, at theirs [m]
inline constexpr std::array<double, 3> kInertia{3.36e-3, 3.97e-4, 1.65e-4};  // J_i [kg m^2]
inline constexpr std::array<double, 3> kWeight{-0.0155, -0.0103, 0.0133};    // C_wi [N m]
inline constexpr double kKeyDry = 0.012;                                     // C_d1 [N m]
inline constexpr double kAlpha21 = 2.15, kAlpha31 = 10.1;                    // (2.1), as printed [-]

inline constexpr double kDownForce = 0.70, kUpForce = 0.38;  // static test, 2.2 [N]

// the felt of (4.10)
inline constexpr double kFeltStiffness = 1.6e10;  // k [N/m^r]
inline constexpr double kFeltExponent = 2.7;      // r [-]
inline constexpr double kFeltDamping = 5e7;       // b [N s/m^3]

// the whippen's spring, Table 4.12
inline constexpr double kWhippenSpring = 0.0355;     // [N m/rad]
inline constexpr double kWhippenSpringRest = 0.419;  // [rad]

}  // namespace erard::study::thesis
