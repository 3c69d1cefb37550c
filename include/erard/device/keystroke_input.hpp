// A keystroke as the input of tick().
#pragma once

#include "erard/device/keystroke.hpp"
#include "erard/solver/drive.hpp"

namespace erard {

/// Exact at any instant: value and rate of the spline. Must not outlive the keystroke.
struct KeystrokeInput {
  const Keystroke* keystroke;

  DriveSample at(double time) const noexcept {
    const Sample sample = keystroke->at(time);
    return {sample.value, sample.rate};
  }
};

}  // namespace erard
