// The grand action in the middle of a stroke, as one-step problems: what a keyboard is assembled from.
#pragma once

#include <memory>
#include <vector>

#include "erard/device/keystroke.hpp"
#include "erard/erard.hpp"

namespace erard::bench {

/// A step that is about to be made.
struct Moment {
  State state;
  Drive drive;
};

inline Drive drive_between(const Keystroke& keystroke, double from, double to) {
  const Sample a = keystroke.at(from), b = keystroke.at(to);
  return {DriveKind::piston, {a.value, a.rate}, {b.value, b.rate}};
}

/// Plays the keystroke from rest and stops at `count` moments, evenly spread from its start to its end.
inline std::vector<Moment> moments_of(const Mechanism& mechanism, const Scheme& scheme, const Keystroke& keystroke,
                                      int count) {
  const auto work = std::make_unique<Workspace>();
  const double h = scheme.time_step;
  const int steps = static_cast<int>(keystroke.end() / h);
  std::vector<Moment> moments;
  State state = rest_state(mechanism, h);
  for (int k = 0; k < steps && static_cast<int>(moments.size()) < count; ++k) {
    const Drive drive = drive_between(keystroke, k * h, (k + 1) * h);
    if (k * count >= static_cast<int>(moments.size()) * steps) moments.push_back({state, drive});
    step(mechanism, scheme, drive, state, *work);
  }
  return moments;
}

/// The same state of the action on a frame that stands still.
inline State put_on_frame(const State& state) {
  const auto n = state.x.size();
  State lifted = state;
  const auto lift = [n](const CoordinateVector& in, CoordinateVector& out) {
    out.resize(n + 1);
    out << 0.0, in;
  };
  lift(state.x, lifted.x);
  lift(state.v, lifted.v);
  lift(state.acceleration, lifted.acceleration);
  return lifted;
}

/// First linearisation of a step, about its guess.
inline void linearise_first(const Mechanism& mechanism, const Scheme& scheme, const Moment& moment, Workspace& work) {
  predict(mechanism, scheme, moment.drive, moment.state, work);
  place_middle(mechanism, scheme, moment.state, work);
  linearise(mechanism, scheme, moment.drive, moment.state, work);
}

}  // namespace erard::bench
