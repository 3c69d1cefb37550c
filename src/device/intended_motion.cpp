#include "erard/device/intended_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace erard {
namespace {

constexpr double kSpacing =
    1e-3;  // of the samples [s]; a spline through them follows a press of 20 ms within 2e-5 of it

/// From 0 to 1 with least jerk; constant outside. Flash & Hogan, Journal of Neuroscience 5 (1985).
double least_jerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

template <typename Position>
Keystroke sample(double duration, const Position& position) {
  const long count = std::max(2L, std::lround(duration / kSpacing) + 1);
  std::vector<double> times, values;
  for (long i = 0; i < count; ++i) {
    times.push_back(static_cast<double>(i) * kSpacing);
    values.push_back(position(times.back()));
  }
  return {KeystrokeQuantity::position, std::move(times), std::move(values)};
}

void require(bool is_met, const char* name, double value, const char* rule) {
  if (!is_met) throw std::invalid_argument(fmt::format("intended motion: {} = {:g} s, must be {}", name, value, rule));
}

}  // namespace

Keystroke press_and_hold(double depth, double rest, double press, double hold) {
  require(rest >= 0, "rest", rest, ">= 0");
  require(press > 0, "press", press, "> 0");
  require(hold >= 0, "hold", hold, ">= 0");
  return sample(rest + press + hold, [&](double t) { return depth * least_jerk((t - rest) / press); });
}

Keystroke repeated_notes(double depth, double rate_Hz, int count, double travel, double dwell) {
  require(travel > 0, "travel", travel, "> 0");
  require(dwell >= 0, "dwell", dwell, ">= 0");
  const double note = 1 / rate_Hz;
  require(note >= 2 * travel + dwell, "time of a note", note, ">= 2 travel + dwell");
  return sample(count * note, [&](double t) {
    const double since = t - std::floor(t / note + 1e-9) * note;
    return depth * (least_jerk(since / travel) - least_jerk((since - travel - dwell) / travel));
  });
}

}  // namespace erard
