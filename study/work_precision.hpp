// Error of a stroke against what it costs: the time-stepping schemes that were candidates, all built on step().
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "erard/device/keystroke_input.hpp"
#include "erard/device/simulation.hpp"
#include "study/defaults.hpp"

namespace erard::study {

inline constexpr double kOutputPeriod = 5e-4;  // [s]: a tick at 2 kHz

/// A stroke of the piston, given as a spline, and the windows in which it is judged; all begin at 0.
struct JudgedStroke {
  std::string name;
  Keystroke keystroke;
  double end = 0;     // of the window for the force [s]
  double check = 0;   // of the one that ends before the hammer is caught; 0 without [s]
  double played = 0;  // of the one for the events [s]
};

/// piano, forte, very fast, repetition, and the recordings.
std::vector<JudgedStroke> judged_strokes();
JudgedStroke judged_stroke(const std::string& name);

/// Counts steps, and shows them to the detector of events where there is one.
struct Watch {
  EventDetector* detector = nullptr;
  long steps = 0;
  long unconverged = 0;
  void operator()(const State& state, const StepReport& report, double force) noexcept {
    ++steps;
    unconverged += report.status != StepStatus::converged;
    if (detector != nullptr) detector->observe(state, force);
  }
};

/// A stroke that is being played.
struct Playing {
  const Mechanism* mechanism;
  KeystrokeInput input;
  State state;
  std::unique_ptr<Workspace> work = std::make_unique<Workspace>();
  Watch watch = {};
};

/// A way to advance by one period.
struct Candidate {
  std::string family;             // of one curve in the diagram
  std::string setting;            // which of its points
  double period = kOutputPeriod;  // a multiple of the output's: of steps longer than that [s]
  std::function<void(Playing&)> advance;
};

/// theta scheme with fixed steps of `step` [s].
Candidate fixed_steps(double theta, double step);

/// tick() with these settings.
Candidate ticking(std::string family, std::string setting, const TickSettings& settings);

/// Steps of `calm` [s] at most, that are refused above a surprise and retaken in `refinement`.
TickSettings surprised_steps(double calm, double surprise_limit, int refinement);

/// Fractional-step theta scheme, second order and strongly A-stable, in `count` times three steps a period:
/// (c h, alpha), ((1 - 2c) h, 1 - alpha), (c h, alpha), c = 1 - 1/sqrt 2, alpha = (1 - 2c)/(1 - c): length, weight of the
/// end.       Bristeau, Glowinski & Periaux, Comput. Phys. Rep. 6 (1987); it stands for its relative TR-BDF2 too
Candidate fractional_steps(int count);

/// Richardson: a step h and two of h/2 where all three have the same contacts, their difference / 3 added to the latter.
Candidate extrapolated_steps(int count);

/// What is called converged: `count` theta = 1/2 steps a period with tolerances that nobody can afford.
Candidate converged_steps(int count = 200);

/// What a run left.
struct JudgedRun {
  double period = kOutputPeriod;
  std::vector<double> force;  // after each period, the start first [N]
  std::vector<double> key;    // y, the same [m]
  std::vector<Event> events;
  double steps = 0;      // taken, a tick
  long unconverged = 0;  // steps
  double cost = 0;       // mean of a tick, refused steps included [us]
  double worst = 0;      // the dearest period [us]
};

/// Plays a stroke from rest.
/// @param repeats  further runs that are timed: of each period the least time counts. 0: costs stay 0
JudgedRun play_judged(const ActionFile& action, const JudgedStroke& stroke, const Candidate& candidate,
                      int repeats = 0);

/// Error of the finger force up to `end` [s].
struct ForceError {
  double eta = 0;      // integral |F_ref - F| dt / integral |F_ref| dt, [-]                      thesis (6.3)
  double rms = 0;      // [N]
  double largest = 0;  // [N]
};
ForceError force_error(const JudgedRun& run, const JudgedRun& truth, double end);

/// Error of the events of a stroke. Two are the same when each is the other's nearest of its kind, within 20 ms.
struct EventError {
  int compared = 0;
  int missing = 0;                          // in the run
  int beyond = 0;                           // times that are off by more than 0.25 ms
  double time = 0;                          // the largest, signed: late is positive [s]
  EventKind worst = EventKind::escapement;  // which
  double speed = 0;                         // of the hammer when it meets the string, the largest, relative, signed [-]
  double speed_at = 0;                      // that speed of the converged run [m/s]
};
EventError event_error(const JudgedRun& run, const JudgedRun& truth);

/// Key on the front rail: its extremes that stand out by 5 um, by parabolas through three rows.
struct RailRinging {
  int extremes = 0;
  double frequency = 0;  // of the mean interval [Hz]
  double amplitude = 0;  // half the mean difference of one and the next [m]
};
RailRinging rail_ringing(const JudgedRun& run, double from, double until);

}  // namespace erard::study
