// What docs/stability.md says between its tables. Figures in braces are computed.
#pragma once

namespace erard::bench {

inline constexpr const char* kHead = R"(# Is the coupling stable?
A device measures its lever, the host pushes a simulated key through a spring and a damper (a, b: thesis 5.4.1), and their
force comes back late to a lever that weighs little. This page says for which a and b that does not shake, chooses, and
tells what the choice costs. All of it is simulated or computed, no device was measured. Regenerate it, in two minutes of
computing, with

    build/release/bin/bench_stability

- **The thesis's a = 6500 N/m, b = 134 N s/m shakes a lever of 60 g** on the key bottom, from one period of delay on, with
  both estimators of the map that see positions alone. 200 g stand it.
- **Chosen: a = {0:g} N/m, b = {1:g} N s/m with the {2}.** Gain margin at least {3:.2f} for levers of 60 and
  200 g, fingers of 200 to 5000 N/m and 1 to 20 N s/m, one and two periods of delay. eta of the finger's force (6.3),
  lever of 60 g: {4} % piano, {5} % forte.
- An observer that knows the device's own force allows a = {6:g}, b = {7:g} with a margin of {8:.2f}, and gives {9} and {10} %.
  It has to know lever and delay, and is worse against a rigid stop; the pipeline does not have it yet.
- Held by something rigid (5e4 N/m, 1 N s/m) the chosen coupling is stable on a lever of 200 g and not on one of 60 g; with
  the observer neither is. What the passivity controller makes of a rigid stop is not measured here.

## The loop
    lever     m y'' = -(d + d_f) y' - k y - f      d = 0.1 N s/m of its bearing; k, d_f of a finger that stays where it is
    actuator  tau f' + f = u(k - n)                held for a period T = 0.5 ms; tau = 0.3 ms, a coil; n periods of delay
    command   u(k) = a Y(k) + b V(k)               the key lies on its bottom and does not give way: a rigid virtual key

Y and V are the sample and the estimate of its rate. Lever, finger and actuator under a held command are solved exactly,
y = -P(z) u; with the estimator's answers to impulses the loop is 1 + A(z) - Ku(z) = 0, A = z^-n P (a Hyy + b Hvy), Ku what an
observer makes of the commands it is told (0 for all others). Stable: no turn round 0 along the unit circle (Nyquist). *Gain
margin*: the factor by which the force may be larger or smaller than commanded; without an observer also that of a and b
together. `study/coupling_loop.hpp` has it in full.

A delay t of the force of b turns it from damping to its opposite above the frequency pi / 2t, so b is limited by
b < about (pi / 2) m / t with t = (n + 1/2) T + tau + the estimator's delay. From below it is limited by a: a force of a that is
late by t is a negative damping a t, which b and the finger have to cover. A stiff, little damped lever (the rigid stop) swings so
fast that b itself is late by a quarter of a turn, and helps no more.

## Map
Lines: edges of the linear region, finger 1000 N/m, 5 N s/m. Points: the same loop simulated (the virtual rig, the engine with
its key clamped, 20 N, 2 um of noise, no dry friction) for four seconds: dots are quiet, crosses shake (above 5 N RMS). Circles:
the three couplings of this page. {11} of {12} points agree with the lines; those that do not have a margin of at most {13:.2f}.

![Stable region of a and b for two levers and two delays](images/stability.svg)

The known pair a = 6500, b = 134, rate by backward difference. *Key bottom* is that of the action, pressed with 15 N:

)";

inline constexpr const char* kMargins = R"(
## Margins
The least over fingers of 200, 1000 and 5000 N/m, 1 to 20 N s/m. *Rigid stop*: 5e4 N/m with 1 or 20 N s/m. The last column is
what 50 um of noise make of the command in the worst of these fingers, by the linear model. Told the other delay, or a
heavier lever, only an observer notices.

)";

inline constexpr const char* kHolding = R"(
## Holding still
Ten seconds in one place, with the whole action, dry friction of 0.05 N, 50 um of noise. Each cell is the worst of five
fingers (200 to 5000 N/m): rms of the command above 50 Hz in the last second over that of the second before / that of the last
second [N] / that of the finger's force [N]. Two seconds of the same noise differ by a few per cent; what grows, or stands above
the noise of the table before, is not stable. Growth alone would not do: a limit cycle at the actuator's limit does not grow.

)";

inline constexpr const char* kHoldingBrake = R"(
The same with an MR brake. It takes energy and never gives any, and cannot shake a finger that keeps still: the command is
noisy, the finger feels nothing of it.

)";

inline constexpr const char* kHoldingStop = R"(
The same against a rigid stop, voice coil, worst of 1 and 20 N s/m. Dry friction hides the instability while the noise is small
against it:

)";

inline constexpr const char* kFidelity = R"(
## What it costs
A finger of 1000 N/m and 5 N s/m plays the stroke that the action alone played with the thesis's finger: its intended motion is
X with k (X - y) + d (X' - y') = F, so on an ideal device it would feel just that F. Cells: eta [%] / RMS [N] / speed of the
first hammer blow [%]. One period of delay, 50 um of noise. *Lighter key*: the lever's mass is taken out of the simulated key,
but for a tenth of the key's own inertia; a mass that is there need not be rendered, and no acceleration has to be measured.

)";

inline constexpr const char* kPassivity = R"(
The softer coupling loses more: it lies in series with a finger that has a stiffness of its own. A brake loses more than a
coil: it cannot push, and takes 3 ms to follow. Taking the lever out of the simulated key helps where the lever is heavy.

## What the passivity controller does
The host's whole pipeline, sensor noise of 5 um, ten seconds, finger of 1000 N/m: rms of the command above 50 Hz [N] / part of the
periods in which the controller acted. While it acts the coupling is its safe one, not the one in the column; what it has
calmed it so far keeps until the key is let go. On the bottom at 15 N it acts although nothing shakes without it. Its other
settings are those of config/device.yaml.

)";

inline constexpr const char* kRemedies = R"(
## What else makes room
Stable b for a = 6500 N/m, backward difference, lever of 60 g, finger of 1000 N/m and 5 N s/m. The
coil keeps its 0.3 ms at every rate; but for that everything scales with m / T.

)";

inline constexpr const char* kLimits = R"(
## Limits
- A rigid key, or a free mass for a key, is not the worst in every case. With the observer, b = 134 and a lever of 60 g at two
  periods, a linear margin of 2.5 goes with a simulated bottom that shakes with 7 N at 15 N: key and punching swing together. So a
  choice has to pass the ten seconds above too, and b = 90 does.
- Adaptive windows are not linear and have no margin here; their long windows, which noise at rest calls for, are the latest.
- The finger has no mass, which is the harder case, and does not tire, twitch or answer.
- The lever's play, the coil's amplifier and a sensor on another place than the force are not modelled.
)";

}  // namespace erard::bench
