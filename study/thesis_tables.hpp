// Tables 4.1 and 5.2 of the thesis and its equation (4.11), recomputed from their definitions.
#pragma once

#include <array>
#include <string>

#include "erard/device/action_file.hpp"
#include "study/section.hpp"

namespace erard::study {

// ---- Table 4.1: how much the bodies bend, each taken as a clamped beam of wood

struct ClampedBeam {
  const char* body;
  double length, width, height;  // L, b, h [m]
  double force;                  // F [N]
  double printed_deflection;     // delta / L [-]
  double printed_period;         // 1 / (f_1 tau) [-]
  const char* why_deflection;    // the print differs from (4.1)
  const char* why_period;        // and from (4.2)
};

/// The six rows as printed.
const std::array<ClampedBeam, 6>& table_4_1();

/// delta / L = F L^2 / (3 E I), I = b h^3 / 12, E = 1e10 Pa                          thesis (4.1)
double relative_deflection(const ClampedBeam& beam) noexcept;

/// f_1 = 1.875^2 / (2 pi L^2) sqrt(E I / (rho b h)), rho = 1000 kg/m3 [Hz]           thesis (4.2)
double first_frequency(const ClampedBeam& beam) noexcept;

/// 1 / (f_1 tau), tau = 0.05 s
double relative_period(const ClampedBeam& beam) noexcept;

/// Forces at whippen and knuckle that hold F at the finger in balance, through the lever arms of Table 2.1 alone [N].
struct LeverForces {
  double whippen = 0;  // F L / l12
  double knuckle = 0;  // F L / (alpha_31 l32)
};
LeverForces lever_forces(double finger_force) noexcept;

// ---- Table 5.2: dry friction against weight

/// Upsilon = 2 pi sqrt(c_d / (m g l)); infinite without m g l                      thesis (5.7)
/// @param dry c_d [N m]; @param weight_moment m g l [N m]
double upsilon(double dry, double weight_moment) noexcept;

/// The six bodies from the parameters of the action; m g l of the whippen with jack and lever on it, as when it
/// moves. The frictions of whippen, hammer and damper were derived from this table: only the key is a test of it.
std::array<Recomputed, 6> table_5_2(const ActionFile& action);

// ---- (4.11): energy stored in a felt against energy lost in it

struct FeltEnergies {
  double compression = 0;  // largest d [m]
  double stored = 0;       // W_elastic at the largest compression [J]
  double lost = 0;         // W_viscous until then [J]
  double work = 0;         // done on the felt until then [J]

  double ratio() const noexcept { return stored / lost; }
};

/// The felt of (4.10) pressed to `compression` [m] at even speed in `duration` [s], by the engine's felt law.
FeltEnergies press_felt(double compression, double duration);

/// The front rail punching from its first touch to its first greatest compression in a stroke of the finger,
/// config/keystrokes/<name>.csv.
FeltEnergies front_rail_energies(const ActionFile& action, const std::string& keystroke);

/// Every printed number of Tables 4.1 and 5.2, of the lever ratios, (4.11), (6.1) and (6.2) beside its computed value.
std::vector<Recomputed> recompute_tables(const ActionFile& action);

Section thesis_tables_section(const Pictures& pictures);

}  // namespace erard::study
