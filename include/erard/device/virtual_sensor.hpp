// The position sensor of the virtual device.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "erard/device/delay_line.hpp"

namespace erard {

struct VirtualSensorSettings {
  double resolution = 0;   // of one count [m]; 0: none
  double noise = 50e-6;    // standard deviation of each sample, Gaussian, white [m]
  double delay = 0;        // [s], to the nearest sub-step
  std::uint64_t seed = 1;  // of the noise: the same seed gives the same samples
};

class VirtualSensor {
 public:
  VirtualSensor(const VirtualSensorSettings& settings, double sub_step)
      : settings_(settings), delay_(static_cast<int>(std::lround(settings.delay / sub_step))), random_(settings.seed) {}

  /// The lever is here at the end of a sub-step [m].
  void follow(double position) noexcept { delay_.push(position); }

  /// A sample of where it was `delay` ago: noise is added before it is rounded to whole counts [m]
  double measure() noexcept {
    const double position = delay_.oldest() + settings_.noise * error_(random_);
    return settings_.resolution > 0 ? settings_.resolution * std::round(position / settings_.resolution) : position;
  }

 private:
  VirtualSensorSettings settings_;
  DelayLine delay_;
  std::mt19937_64 random_;
  std::normal_distribution<double> error_;
};

}  // namespace erard
