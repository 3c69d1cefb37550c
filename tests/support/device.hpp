// A renderer with a device in front of it that always sends what it is told.
#pragma once

#include <vector>

#include "erard/haptics/renderer.hpp"
#include "strokes.hpp"

namespace erard::test {

/// Settings under which nothing but the simulation shapes the force: exact rate, no noise, no actuator; and the
/// thesis's coupling, with which strokes are simulated.
inline RenderSettings exact_rendering(int keys = 1) {
  RenderSettings settings;
  settings.keys = keys;
  settings.track.estimator = {RateEstimatorKind::sliding_polynomial, 3, 2, 0, 0};
  settings.coupling = {6500, 134};
  settings.passivity.sensor_noise = 0;
  settings.track.still_zone = 3e-5;
  settings.actuator.kind = ActuatorKind::none;
  return settings;
}

class Device {
 public:
  Device(const ActionFile& action, const RenderSettings& settings)
      : renderer(action.model, action.roles, settings),
        period_(std::llround(settings.tick.period * 1e9)),
        positions_(static_cast<std::size_t>(settings.keys)) {}

  /// A period with all keys at one position. @return key 0
  const KeyOutput& play(double position) {
    positions_.assign(positions_.size(), position);
    return send(positions_).key[0];
  }
  const PeriodOutput& send(const std::vector<double>& positions) {
    const PositionMessage message{publisher, sequence++, time_, positions};
    return period(&message);
  }
  /// A period without a message.
  const PeriodOutput& silence() { return period(nullptr); }
  const PeriodOutput& period(const PositionMessage* message) {
    const PeriodOutput& out = renderer.period({time_ + 150'000, std::span(message, message != nullptr ? 1 : 0)});
    time_ += period_;
    return out;
  }
  void rest(double seconds, double position = 0) {
    for (double t = 0; t < seconds; t += renderer.settings().tick.period) play(position);
  }
  /// Neither messages nor periods.
  void pause(double seconds) { time_ += std::llround(seconds * 1e9); }
  std::int64_t time() const { return time_; }

  Renderer renderer;
  std::uint64_t publisher = 1;
  std::int64_t sequence = 1;

 private:
  std::int64_t period_;             // [ns]
  std::int64_t time_ = 1000000000;  // of the device [ns]
  std::vector<double> positions_;
};

}  // namespace erard::test
