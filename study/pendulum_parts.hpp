// What the tables and the pictures of the pendulum study share.
#pragma once

#include <string>
#include <vector>

#include "study/figure.hpp"
#include "study/pendulum.hpp"

namespace erard::study {

/// A scheme as it appears in the section.
struct PendulumContestant {
  std::string name;
  PendulumScheme scheme;
  int limit;          // of the search for the steps needed
  std::string style;  // of its curves
};

/// The second reading of the thesis's linearly implicit scheme, and the ramp without that linearisation.
inline constexpr EulerScheme kLinearlyImplicitFriction{FrictionLaw::linearised, Gravity::at_start};
inline constexpr EulerScheme kImplicitFriction{FrictionLaw::regularised, Gravity::at_start};

inline const PendulumContestant kExplicitRow{"regularised, explicit (5.18)", ExplicitEuler{}, 5000,
                                             "lines lw 1 lc rgb '#9467bd'"};
inline const PendulumContestant kLinearlyImplicitRow{"regularised, linearly implicit (5.26)", kLinearlyImplicit, 10000,
                                                     "lines lw 2 lc rgb '#d62728'"};
inline const PendulumContestant kFrictionOnlyRow{"linearly implicit, gravity explicit", kLinearlyImplicitFriction,
                                                 10000, "lines lw 1 lc rgb '#ff7f0e'"};
inline const PendulumContestant kImplicitFrictionRow{"regularised, friction fully implicit", kImplicitFriction, 2000,
                                                     "lines lw 2 lc rgb '#e377c2'"};
inline const PendulumContestant kProjectedRow{"projected (5.46)", kProjected, 2000, "lines lw 2 lc rgb '#1f77b4'"};
inline const PendulumContestant kEngineEulerRow{"engine, theta 1", EngineScheme{1}, 2500,
                                                "lines lw 1 lc rgb '#8c564b'"};
inline const PendulumContestant kEngineMiddleRow{"engine, theta 1/2", EngineScheme{0.5}, 500,
                                                 "lines lw 2 lc rgb '#2ca02c'"};

/// In the order of the tables.
inline const std::vector<PendulumContestant> kPendulumContestants{
    kExplicitRow,  kLinearlyImplicitRow, kFrictionOnlyRow, kImplicitFrictionRow,
    kProjectedRow, kEngineEulerRow,      kEngineMiddleRow};

inline constexpr double kOnePercent = 0.01;           // of the 1 rad from which it is let go [rad]
inline constexpr PendulumState kThrownStart{1, -10};  // Figure 5.7

/// The pictures of the section, each an SVG file.
void draw_pendulum_at_a_glance(const std::filesystem::path& svg);  // Figures 5.9 and 5.10
void draw_pendulum_errors(const std::filesystem::path& svg);       // Figure 5.10 for the bodies of the action
void draw_pendulum_rest(const std::filesystem::path& svg);         // sticking angle and the minute after
void draw_pendulum_cases(const std::filesystem::path& svg);        // Figures 5.3 to 5.8

/// What thesis 5.1 and 5.2 say and what does not come out so. (Upsilon of the bodies: thesis_tables.)
struct PendulumClaims {
  std::vector<Contradiction> numbers;
  std::vector<std::vector<std::string>> statements;  // where, printed, computed, why
};
PendulumClaims check_pendulum_claims();

}  // namespace erard::study
