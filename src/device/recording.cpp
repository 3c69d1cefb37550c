#include "erard/device/recording.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "csv_table.hpp"

namespace erard {

namespace fs = std::filesystem;

namespace {

// ---- the sensor

constexpr double kRestNoise = 45e-6;      // [m] rms where the key rests, fitted to fourth differences: 38 to 47 um
constexpr double kBottomNoise = 0.5e-6;   // [m] where it is down: resolution, 1 um, and little else
constexpr double kNoiseLength = 2e-3;     // [m] over which the noise falls by e on the way down
constexpr double kResolution = 1e-6;      // [m] last digit of key_front_mm
constexpr double kBoundLeeway = 0.05e-6;  // [m] rms by which the curve may miss a bound: less than anything above

// rms noise of a reading [m], in the scale of the recording; see docs/recordings.md for the fit
double noise_at(double reading) { return kBottomNoise + kRestNoise * std::exp(-reading / kNoiseLength); }

// A reading below `rest` is flat there: it says "somewhere in between", whose rms is the width by the root of 12.
double uncertainty_at(double reading, double rest) {
  return reading < rest ? std::max(rest / std::sqrt(12.0), kRestNoise) : noise_at(reading);
}

bool is_clipped(double reading, const ImportSettings& settings) {
  return reading > settings.full_scale - kResolution / 2;
}

// ---- smoothing

// Third difference that the smoother expects, so that a wave of frequency `cutoff`, read with the noise of rest, keeps
// half its amplitude: 1 / (1 + (sigma / J)^2 (2 sin(pi f / rate))^6) = 1/2.
double expected_difference(double cutoff, double rate) {
  return kRestNoise * std::pow(2 * std::sin(std::numbers::pi * cutoff / rate), 3);
}

/// minimise over z:  sum_i w_i (z_i - target_i)^2 + sum_j p_j (z_j+3 - 3 z_j+2 + 3 z_j+1 - z_j)^2
/// Whittaker's smoother with third differences. Samples at rest are no unknowns: z = 0.
class Smoother {
 public:
  /// @param penalties  p, one for each third difference: three fewer than samples
  /// @param is_rest    one for each sample
  Smoother(std::vector<double> penalties, const std::vector<bool>& is_rest)
      : penalties_(std::move(penalties)), unknown_(is_rest.size(), -1) {
    int count = 0;
    for (std::size_t i = 0; i < is_rest.size(); ++i)
      if (!is_rest[i]) unknown_[i] = count++;
    roughness_ = assemble_roughness(count);
    solver_.analyzePattern(roughness_);
  }

  /// The curve for these weights and targets. The corrections leave only the rounding of z itself, so that compilers
  /// which sum in another order agree to the nanometre that is kept.
  std::vector<double> solve(const std::vector<double>& weights, const std::vector<double>& targets) {
    Matrix A = roughness_;
    for (std::size_t i = 0; i < unknown_.size(); ++i)
      if (unknown_[i] >= 0) A.coeffRef(unknown_[i], unknown_[i]) += weights[i];
    solver_.factorize(A);
    if (solver_.info() != Eigen::Success) throw std::runtime_error("the smoothing has no solution");

    std::vector<double> z(unknown_.size(), 0.0);
    constexpr int kPasses = 4;  // each shrinks the error by 1e5 or more
    for (int pass = 0; pass < kPasses; ++pass) add(solver_.solve(residual(z, weights, targets)), z);
    return z;
  }

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  static constexpr std::array<double, 4> kDifference{-1, 3, -3, 1};

  Matrix assemble_roughness(int count) const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(16 * penalties_.size());
    for (std::size_t j = 0; j < penalties_.size(); ++j)
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < 4; ++b)
          if (unknown_[j + a] >= 0 && unknown_[j + b] >= 0)
            entries.emplace_back(unknown_[j + a], unknown_[j + b], penalties_[j] * kDifference[a] * kDifference[b]);
    Matrix K(count, count);
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
  }

  // Right-hand side of the correction, in long double: the penalties span 1e10, and left up to 8e-8 m of rounding.
  Eigen::VectorXd residual(const std::vector<double>& z, const std::vector<double>& weights,
                           const std::vector<double>& targets) const {
    std::vector<long double> r(z.size());
    for (std::size_t i = 0; i < z.size(); ++i)
      r[i] = static_cast<long double>(weights[i]) * (static_cast<long double>(targets[i]) - z[i]);
    for (std::size_t j = 0; j < penalties_.size(); ++j) {
      long double difference = 0;
      for (std::size_t a = 0; a < 4; ++a) difference += static_cast<long double>(kDifference[a]) * z[j + a];
      for (std::size_t a = 0; a < 4; ++a) r[j + a] -= penalties_[j] * difference * kDifference[a];
    }
    Eigen::VectorXd unknowns(roughness_.rows());
    for (std::size_t i = 0; i < z.size(); ++i)
      if (unknown_[i] >= 0) unknowns[unknown_[i]] = static_cast<double>(r[i]);
    return unknowns;
  }

  void add(const Eigen::VectorXd& correction, std::vector<double>& z) const {
    for (std::size_t i = 0; i < z.size(); ++i)
      if (unknown_[i] >= 0) z[i] += correction[unknown_[i]];
  }

  std::vector<double> penalties_;
  std::vector<int> unknown_;  // index of each sample among the unknowns, or -1
  Matrix roughness_;
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> solver_;  // banded: no fill to avoid
};

struct Terms {
  std::vector<double> weights;
  std::vector<double> targets;
  bool operator==(const Terms&) const = default;
};

double weight_of(double uncertainty) { return 1 / (uncertainty * uncertainty); }

// Every reading as far as it can be trusted; a clipped one stands for a key pressed into the felt of the rail.
Terms trust(const Recording& recording, const ImportSettings& settings) {
  Terms terms{{}, recording.key_front};
  for (double& target : terms.targets)
    if (is_clipped(target, settings)) {
      terms.weights.push_back(weight_of(settings.press));
      target = settings.full_scale + settings.press;
    } else {
      terms.weights.push_back(weight_of(uncertainty_at(target, settings.rest)));
    }
  return terms;
}

/// The smoothest curve that agrees with a recording and stays within its bounds: a clipped reading says "here or
/// beyond", and no key is above its rest. A bound costs (z - bound)^2 / kBoundLeeway^2 on its wrong side, which keeps the
/// whole convex and piecewise quadratic: solve (Newton's method) until no sample changes sides any more. Without a press
/// to aim at, clipped plateaus lie on their bounds, and samples change sides for ever.
class Agreement {
 public:
  Agreement(const Recording& recording, const ImportSettings& settings) : trusted_(trust(recording, settings)) {
    for (double reading : recording.key_front)
      bounds_.push_back(is_clipped(reading, settings) ? settings.full_scale : 0);
  }

  std::vector<double> fit(Smoother& smoother) const {
    Terms terms = trusted_;
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<double> z = smoother.solve(terms.weights, terms.targets);
      Terms next = weigh(z);
      if (next == terms) return z;
      terms = std::move(next);
    }
    throw std::runtime_error("the smoothing does not settle on which side of its bounds the key runs");
  }

 private:
  static constexpr int kMostRounds = 200;  // the recordings at hand need 2 to 23, with presses from 0.01 to 1 mm

  // Weights and targets that stand for the cost on the side of the bounds on which z runs.
  Terms weigh(const std::vector<double>& z) const {
    constexpr double bound_weight = 1 / (kBoundLeeway * kBoundLeeway);
    Terms terms = trusted_;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (z[i] < bounds_[i]) {
        const double weight = terms.weights[i] + bound_weight;
        terms.targets[i] = (terms.weights[i] * terms.targets[i] + bound_weight * bounds_[i]) / weight;
        terms.weights[i] = weight;
      }
    return terms;
  }

  Terms trusted_;
  std::vector<double> bounds_;  // lowest position at each sample [m]
};

// ---- what moves, and how fast

constexpr double kPilotCutoff = 60;      // [Hz] passes a strike blurred by 4 ms, leaves 2 um of the noise of rest
constexpr double kSpeedSpan = 0.005;     // [s] a strike's cutoff holds this long before and after it
constexpr double kDepartureShare = 0.2;  // of `rest`: a movement begins and ends there; two sigma of the noise

std::vector<double> fit_pilot(const Recording& recording, const ImportSettings& settings) {
  const std::size_t count = recording.key_front.size();
  const double expected = expected_difference(kPilotCutoff, recording.rate);
  const Terms terms = trust(recording, settings);
  return Smoother(std::vector<double>(count - 3, weight_of(expected)), std::vector<bool>(count, false))
      .solve(terms.weights, terms.targets);
}

// A movement goes beyond `rest` and lasts from where the pilot leaves the noise to where it comes back into it.
std::vector<bool> find_rests(const std::vector<double>& pilot, double rest) {
  const double departure = kDepartureShare * rest;
  std::vector<bool> is_rest(pilot.size(), true);
  for (std::size_t i = 0; i < pilot.size();) {
    std::size_t end = i + 1;
    if (pilot[i] > departure) {
      while (end < pilot.size() && pilot[end] > departure) ++end;
      if (*std::max_element(pilot.begin() + static_cast<std::ptrdiff_t>(i),
                            pilot.begin() + static_cast<std::ptrdiff_t>(end)) > rest)
        std::fill(is_rest.begin() + static_cast<std::ptrdiff_t>(i), is_rest.begin() + static_cast<std::ptrdiff_t>(end),
                  false);
    }
    i = end;
  }
  return is_rest;
}

// One penalty for each third difference: the cutoff follows the highest speed of the pilot nearby.
std::vector<double> choose_penalties(const std::vector<double>& pilot, double rate, const ImportSettings& settings) {
  const std::size_t count = pilot.size();
  const auto span = static_cast<std::size_t>(std::lround(kSpeedSpan * rate));
  std::vector<double> penalties(count - 3);
  for (std::size_t j = 0; j < penalties.size(); ++j) {
    double speed = 0;
    for (std::size_t i = j > span ? j - span : 0; i + 1 < std::min(count, j + 4 + span); ++i)
      speed = std::max(speed, std::abs(pilot[i + 1] - pilot[i]) * rate);
    const double cutoff =
        std::clamp(settings.fast_cutoff * speed / settings.fast_speed, settings.slow_cutoff, settings.fast_cutoff);
    penalties[j] = weight_of(expected_difference(cutoff, rate));
  }
  return penalties;
}

// ---- checks

using RecordingTable = csv::Table<3>;
constexpr std::size_t kTime = 0, kKeyFront = 1, kHammer = 2;

constexpr double kMillimetre = 1e-3;
constexpr double kLowestRate = 400, kHighestRate = 50e3;  // [Hz] slower hides strikes, faster is no key sensor
constexpr double kJitter = 0.05;                          // of an interval: what rounded time stamps may differ
constexpr double kLongestReading = 0.03;                  // [m] three times the dip of a key
constexpr std::size_t kFewestSamples = 20;                // twice the nine of peak_speed()

void check_reading(RecordingTable& table, const char* column, double reading) {
  if (std::abs(reading) > kLongestReading)
    table.reject_row(fmt::format("{} = {} mm, must be within +-{} mm", column, reading / kMillimetre,
                                 kLongestReading / kMillimetre));
}

void check_row(RecordingTable& table, const Recording& recording, double time, double reading) {
  const std::vector<double>& times = recording.times;
  check_reading(table, "key_front_mm", reading);
  if (times.empty()) return;

  const double interval = time - times.back();
  const double first = times.size() > 1 ? times[1] - times[0] : interval;
  if (!(first >= 1 / kHighestRate && first <= 1 / kLowestRate))
    table.reject_row(fmt::format("t_s = {} s after {} s, must rise by {} to {} s ({} to {} Hz)", time, times.back(),
                                 1 / kHighestRate, 1 / kLowestRate, kLowestRate, kHighestRate));
  if (std::abs(interval - first) > kJitter * first)
    table.reject_row(fmt::format("t_s = {} s after {} s, must rise by {:.6g} s as between the first two rows", time,
                                 times.back(), first));
}

void check_range(const char* option, double value, double low, double high, double unit, const char* unit_name) {
  if (!(value >= low && value <= high))
    throw InputError(fmt::format("{} = {:.6g} {}, must be within {:.6g} and {:.6g} {}", option, value / unit, unit_name,
                                 low / unit, high / unit, unit_name));
}

void check_settings(const ImportSettings& settings, double rate) {
  check_range("--dip", settings.dip, 0.001, 0.03, 1, "m");
  check_range("--full-scale", settings.full_scale, 0.001, kLongestReading, kMillimetre, "mm");
  check_range("--rest", settings.rest, kResolution, settings.full_scale / 4, kMillimetre, "mm");
  check_range("--press", settings.press, kResolution, settings.full_scale / 4, kMillimetre, "mm");
  check_range("--fast-cutoff", settings.fast_cutoff, 1, rate / 2, 1, "Hz");
  check_range("--slow-cutoff", settings.slow_cutoff, 1, settings.fast_cutoff, 1, "Hz");
  check_range("--fast-speed", settings.fast_speed, 1e-3, 10, 1, "m/s");
}

void check_full_scale(const Recording& recording, const ImportSettings& settings, const fs::path& file) {
  const auto highest = std::max_element(recording.key_front.begin(), recording.key_front.end());
  if (*highest > settings.full_scale + kResolution / 2)
    csv::reject(file, fmt::format("key_front_mm = {:.6g} mm at {:.6g} s, must be within --full-scale = {:.6g} mm",
                                  *highest / kMillimetre,
                                  recording.times[static_cast<std::size_t>(highest - recording.key_front.begin())],
                                  settings.full_scale / kMillimetre));
}

void check_movement(const std::vector<bool>& is_rest, const Recording& recording, const ImportSettings& settings,
                    const fs::path& file) {
  if (!is_rest.front())
    csv::reject(file, fmt::format("key_front_mm starts at {:.4g} mm, must start at rest, below {:.4g} mm",
                                  recording.key_front.front() / kMillimetre, settings.rest / kMillimetre));
  if (std::find(is_rest.begin(), is_rest.end(), false) == is_rest.end())
    csv::reject(file, fmt::format("key_front_mm never leaves its rest, must exceed {:.4g} mm; it is in millimetres",
                                  settings.rest / kMillimetre));
}

// ---- figures

double rms_residual(const std::vector<double>& z, const std::vector<double>& readings, double low, double high) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < z.size(); ++i)
    if (readings[i] >= low && readings[i] < high) {
      sum += (z[i] - readings[i]) * (z[i] - readings[i]);
      ++count;
    }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

ImportFigures measure(const Recording& recording, const ImportSettings& settings, const std::vector<double>& z,
                      const std::vector<bool>& is_rest, const Keystroke& keystroke) {
  const std::vector<double>& readings = recording.key_front;
  ImportFigures figures;
  figures.sample_count = static_cast<int>(z.size());
  std::vector<double> as_sensed = z;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (is_clipped(readings[i], settings)) ++figures.clipped_count;
    if (is_rest[i]) ++figures.rest_count;
    if (i > 0 && is_rest[i - 1] && !is_rest[i] && ++figures.movement_count == 1) figures.onset = recording.times[i - 1];
    figures.deepest_press = std::max(figures.deepest_press, z[i] - settings.full_scale);
    figures.peak_rate =
        std::max(figures.peak_rate, keystroke.at(recording.times[i]).rate * settings.full_scale / settings.dip);
    as_sensed[i] = std::min(z[i], settings.full_scale);
  }
  figures.residual_low = rms_residual(z, readings, settings.rest, settings.full_scale / 3);
  figures.residual_high = rms_residual(z, readings, settings.full_scale / 3, settings.full_scale - kResolution / 2);
  figures.recorded_speed = peak_speed(readings, recording.rate);
  figures.kept_speed = peak_speed(as_sensed, recording.rate);
  return figures;
}

}  // namespace

Recording read_recording(const fs::path& file) {
  RecordingTable table(file, {"t_s", "key_front_mm", "hammer_sensor_mm"},
                       "must name t_s, key_front_mm and at most hammer_sensor_mm beside them");
  if (!table.has(kTime)) table.reject_header("header has no column t_s");
  if (!table.has(kKeyFront)) table.reject_header("header has no column key_front_mm");

  Recording recording;
  std::array<double, 3> row{};
  while (table.next(row)) {
    const double reading = row[kKeyFront] * kMillimetre;
    check_row(table, recording, row[kTime], reading);
    recording.times.push_back(row[kTime]);
    recording.key_front.push_back(reading);
    if (!table.has(kHammer)) continue;
    check_reading(table, "hammer_sensor_mm", row[kHammer] * kMillimetre);
    recording.hammer.push_back(row[kHammer] * kMillimetre);
  }
  const std::size_t count = recording.times.size();
  if (count < kFewestSamples)
    table.reject_row(fmt::format("the file ends after {} rows of data, must have {} or more", count, kFewestSamples));
  recording.rate = static_cast<double>(count - 1) / (recording.times.back() - recording.times.front());
  return recording;
}

Import import_recording(const Recording& recording, const ImportSettings& settings, const fs::path& file) {
  check_settings(settings, recording.rate);
  check_full_scale(recording, settings, file);

  const std::vector<double> pilot = fit_pilot(recording, settings);
  const std::vector<bool> is_rest = find_rests(pilot, settings.rest);
  check_movement(is_rest, recording, settings, file);
  Smoother smoother(choose_penalties(pilot, recording.rate, settings), is_rest);
  const std::vector<double> z = Agreement(recording, settings).fit(smoother);

  // to the model's scale, and to the nanometre: 1e-6 m/s of rate
  std::vector<double> positions(z.size());
  for (std::size_t i = 0; i < z.size(); ++i)
    positions[i] = std::round(z[i] * settings.dip / settings.full_scale * 1e9) / 1e9 + 0.0;  // + 0.0: no -0
  Keystroke keystroke(KeystrokeQuantity::position, recording.times, std::move(positions));
  const ImportFigures figures = measure(recording, settings, z, is_rest, keystroke);
  return {std::move(keystroke), figures};
}

double peak_speed(const std::vector<double>& positions, double rate) {
  constexpr std::array<double, 4> kSlope{126, 193, 142, -86};  // / 1188: Savitzky and Golay 1964, cubic, nine points
  double peak = 0;
  for (std::size_t i = 4; i + 4 < positions.size(); ++i) {
    double slope = 0;
    for (std::size_t k = 1; k <= 4; ++k) slope += kSlope[k - 1] * (positions[i + k] - positions[i - k]);
    peak = std::max(peak, slope / 1188 * rate);
  }
  return peak;
}

std::vector<std::string> describe_import(const ImportSettings& settings, const ImportFigures& figures,
                                         const std::string& command) {
  constexpr double mm = kMillimetre;
  return {
      "command: " + command,
      fmt::format(
          "conversion: position_m = smoothed key_front_mm x {:.6g} m / {:.6g} mm on the times of the recording; "
          "at rest exactly 0",
          settings.dip, settings.full_scale / mm),
      fmt::format("settings: rest {:.4g} mm, cutoff {:.4g} Hz rising with the speed to {:.4g} Hz at {:.4g} m/s, press "
                  "{:.4g} mm",
                  settings.rest / mm, settings.slow_cutoff, settings.fast_cutoff, settings.fast_speed,
                  settings.press / mm),
      fmt::format("samples: {}, of them {} at rest and {} clipped, in {} movements, the first from {:.4f} s",
                  figures.sample_count, figures.rest_count, figures.clipped_count, figures.movement_count,
                  figures.onset),
      fmt::format(
          "in the recording's scale: rms change {:.4f} mm below {:.3f} mm and {:.4f} mm above, pressed {:.3f} mm "
          "beyond the clip",
          figures.residual_low / mm, settings.full_scale / 3 / mm, figures.residual_high / mm,
          figures.deepest_press / mm),
      fmt::format(
          "in the recording's scale: peak speed over 9 samples {:.3f} m/s, recorded {:.3f} m/s; peak rate {:.3f} "
          "m/s",
          figures.kept_speed, figures.recorded_speed, figures.peak_rate),
  };
}

}  // namespace erard
