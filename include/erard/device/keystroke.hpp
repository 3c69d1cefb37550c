// A keystroke as a function of time: what a finger did, from a file to the drive of a simulation.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace erard {

enum class KeystrokeQuantity {
  position,  // column position_m: key or piston position [m], down positive
  force,     // column force_N: force of the finger [N], down positive
};

/// Value and rate of a keystroke at one instant.
struct Sample {
  double value;  // [m] or [N]
  double rate;   // [m/s] or [N/s]
};

/// Natural cubic spline through samples, constant outside them with rate zero: the rate is discontinuous at the first
/// and the last sample only. Straight lines between samples would not do: the rate of Y is multiplied by
/// b = 134 N s/m, and joining samples that way moves the force of a forte stroke by 3.3 %.
class Keystroke {
 public:
  /// @param times   [s], rising, uniform or not
  /// @param values  [m] or [N], one for each time, at least two
  /// Throws std::invalid_argument when the samples are not like that. Cost: linear in their number.
  Keystroke(KeystrokeQuantity quantity, std::vector<double> times, std::vector<double> values);

  /// Value and rate at `time` [s]; the first value at rest when `time` is not a number.
  /// Cost: logarithmic in the number of samples. No allocation.
  Sample at(double time) const noexcept;

  KeystrokeQuantity quantity() const noexcept { return quantity_; }
  std::size_t size() const noexcept { return times_.size(); }
  double start() const noexcept { return times_.front(); }  // [s]
  double end() const noexcept { return times_.back(); }     // [s]
  std::span<const double> times() const noexcept { return times_; }
  std::span<const double> values() const noexcept { return values_; }

 private:
  std::size_t segment(double time) const noexcept;

  KeystrokeQuantity quantity_;
  std::vector<double> times_;
  std::vector<double> values_;
  std::vector<double> curvatures_;  // second derivatives at the samples
};

/// Reads a CSV file with a header that names `t_s` and one of `position_m` and `force_N`, and nothing else; lines that
/// start with `#` are comments.
/// Throws InputError when the file is not like that, when times do not rise, and when a value cannot be meant: positions
/// beyond 0.03 m or faster than 5 m/s, forces beyond 1000 N.
Keystroke read_keystroke(const std::filesystem::path& file);

/// Writes a file that read_keystroke() reads back bit for bit, with `comments` as `#` lines on top. A reader never meets
/// half a file (see OutputFile).
/// Throws InputError when the file cannot be created, std::runtime_error when it cannot be finished.
void write_keystroke(const std::filesystem::path& file, const Keystroke& keystroke,
                     std::span<const std::string> comments = {});

}  // namespace erard
