// A headless run: one action, one keystroke, everything recorded.
#pragma once

#include <functional>
#include <vector>

#include "erard/device/action_file.hpp"
#include "erard/device/duration_histogram.hpp"
#include "erard/device/keystroke.hpp"
#include "erard/haptics/events.hpp"
#include "erard/haptics/tick.hpp"

namespace erard {

/// What one output row shows, at its instant.
struct Snapshot {
  double time = 0;                   // [s]
  DriveSample input;                 // Y, y or F by drive [m] or [N]
  double key_position = 0;           // y [m]
  double force = 0;                  // of the finger [N]
  std::vector<double> angle;         // absolute, of each body [rad]; displacement of a slide [m]
  std::vector<double> rate;          // of the same [rad/s] or [m/s]
  std::vector<double> compression;   // of each contact; minus the gap when open, 0 when out of play [m]
  std::vector<double> normal;        // reaction of each contact, mean over the last internal step [N]
  std::vector<double> tangential;    // friction of the same, on body B along perp(normal); 0 without friction [N]
  std::vector<double> hinge_moment;  // dry friction of each body's joint, at most c_d [N m] or [N]
};

struct RunSettings {
  TickSettings tick;
  double start = 0;                             // [s]
  double duration = 0;                          // [s]
  std::function<void(const Snapshot&)> on_row;  // after each period, and at the start
  std::function<void(const OneStepProblem&, const RowVector&, double time)> on_problem;  // after each internal step
  std::function<bool(double done)> goes_on;  // asked once a period; done in 0..1
};

struct RunResult {
  std::vector<Event> events;
  int events_lost = 0;  // beyond the detector's capacity
  long periods = 0;
  long steps = 0;  // internal
  long linearisations = 0;
  long sweeps = 0;
  long not_converged = 0;       // steps
  bool is_finite = true;        // false: stopped at the first step that was not finite
  bool is_complete = true;      // false: stopped from outside
  double peak_force = 0;        // [N]
  double peak_force_time = 0;   // [s]
  double computing_time = 0;    // of the periods, on_problem included, on_row not [s]
  DurationHistogram tick_time;  // of each period
};

/// Plays the keystroke from the rest state of the action.
RunResult run(const ActionFile& action, const Keystroke& keystroke, const RunSettings& settings);

/// Snapshot of a state.
Snapshot take_snapshot(const Mechanism& mechanism, const State& state, const DriveSample& input, double force);

}  // namespace erard
