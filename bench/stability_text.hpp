// What docs/stability.md says between its tables. Figures in braces are computed.
#pragma once

namespace erard::bench {

inline constexpr const char* kHead = R"(# Is the coupling stable?
A device measures its lever, the host pushes a simulated key through a spring and a damper (a, b: thesis 5.4.1), and their
force comes back late to a lever that weighs little. This page says for which a and b that does not shake, chooses, and
tells what the choice costs. All of it is simulated or computed, no device was measured. Regenerate it, in a few minutes of
computing, with

    build/release/bin/bench_stability

- **Chosen: a = {0:g} N/m, b = {1:g} N s/m with the {2}**, in config/device.yaml. Gain margin at least {3:.2f} for
  levers of 60 and 200 g, fingers of 200 to 5000 N/m and 1 to 20 N s/m, one and two periods of delay.
- **The whole pipeline is stable** over these, and against a rigid stop of 5e4 N/m, with 50 um of noise, both actuators, at rest,
  at the let-off and on the key bottom: from the last second but one of ten to the last no command's rms grows by more than a
  factor of {14:.2f}, which noise alone does.
- **The passivity controller acts in 0 % of the periods** but in one corner: a lever of 60 g on the bottom with 15 N, held by a
  stop with no more than 1 N s/m. That loop is unstable; the controller calms it, for as long as the key is held, with a coupling
  of 500 N/m.
- eta of the finger's force (6.3), lever of 60 g, without the pipeline: {4} % piano, {5} % forte. Through it and with the brake:
  the end of [The whole pipeline](#the-whole-pipeline).
- The thesis's a = 6500 N/m, b = 134 N s/m, made for a finger in a computer, shakes a lever of 60 g on the key bottom, from one
  period of delay on. 200 g stand it.
- An observer that knows the device's own force allows a = {6:g}, b = {7:g} with a margin of {8:.2f}, and gives {9} and {10} %.
  It has to be told lever and delay, and shakes against a rigid stop with levers of 200 g too: the pipeline does not have it.

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

inline constexpr const char* kPipeline = R"(
The softer coupling loses more: it lies in series with a finger that has a stiffness of its own. A brake loses more than a
coil: it cannot push, and takes 3 ms to follow. Taking the lever out of the simulated key helps where the lever is heavy.

## The whole pipeline
The same holds through the host's pipeline: watch, parabola, action, passivity, guard, actuator, as config/device.yaml sets them,
50 um of noise. Two things that hide a loop that shakes are left out: keys that stand still have no feedback (`still_zone_m`:
then most of these commands are constant), and the winding stays cold, since a hot one gives a constant force. The host thinks of
one period of delay in both cases. Cells, worst of the fingers: rms of the command above 50 Hz in the last second over that of the
second before / that of the last second [N] / that of the finger's force [N] / share of the periods in which the passivity
controller acted [%].
Two seconds of white noise, 2000 samples each, differ by 2.2 % (one standard deviation); so a ratio up to 1.07 is no growth.

)";

inline constexpr const char* kWithoutPassivity = R"(
The brake's command chatters: 50 um make 0.1 m/s of the rate, which passes for a key that rises, where a brake would have to push
and gets no current. It takes 3 ms to follow, and a finger that keeps still feels 0.01 N of it.

The stop with 1 N s/m, voice coil, without the passivity controller:

)";

inline constexpr const char* kSafe = R"(
So it is needed at 15 N on the bottom, where the punching is stiff, and a lever of 60 g against the stop swings with 150 Hz. There
a force of a that is late by t = 1.6 ms is a negative damping a sin(w t) / w of 4 N s/m against the 1.1 of stop and bearing, and b
is late by a quarter of a turn itself. No damping helps: softness does. Gain margins over all fingers, both stops, levers, delays:

)";

inline constexpr const char* kPipelineFidelity = R"(
So the safe coupling is 500 N/m with 1 N s/m. It gives way: pressed with 3 N the lever is 6 mm deeper than the key, on its own
stop, until the key is let go.

Noise does not set the controller off: it may look like sigma^2 (3 b / 2 T + a) / T = 0.16 W of energy from nothing, which is
allowed for; with the thesis's 134 N s/m it would be 2 W. Nor does a limit: while one, or a hot winding, holds the force back, the
account stands. If it did not, a coil that folds back after eight seconds at 15 N would set the controller off.

What a finger feels through the pipeline, the file as it is; strokes and finger of the section before. Cells: eta [%] / RMS [N] /
speed of the first hammer blow [%] / share of the periods in which the passivity controller acted [%].

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
