#include "erard/device/keystroke.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "csv_table.hpp"
#include "erard/device/output_file.hpp"

namespace erard {

namespace fs = std::filesystem;

namespace {

constexpr double kLongestTravel = 0.03;     // [m] three times the dip of a key
constexpr double kHighestSpeed = 5;         // [m/s] keys reach 1 m/s, hammers 7
constexpr double kHighestForce = 1000;      // [N] fingers reach 50
constexpr double kShortestInterval = 1e-6;  // [s] a microsecond: no sensor is faster
constexpr double kLatestTime = 86400;       // [s] a day

// Second derivatives at the samples of the natural cubic spline: zero at the ends, and inside
//   h_l M_l + 2 (h_l + h_r) M + h_r M_r = 6 ((y_r - y) / h_r - (y - y_l) / h_l)
// with h the intervals on the left and the right. Diagonally dominant: elimination needs no pivots (Thomas).
std::vector<double> spline_curvatures(const std::vector<double>& times, const std::vector<double>& values) {
  const std::size_t count = times.size();
  std::vector<double> M(count, 0.0);
  std::vector<double> upper(count, 0.0);
  double largest = 0;
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double left = times[i] - times[i - 1];
    const double right = times[i + 1] - times[i];
    const double bend = 6 * ((values[i + 1] - values[i]) / right - (values[i] - values[i - 1]) / left);
    const double pivot = 2 * (left + right) - left * upper[i - 1];
    upper[i] = right / pivot;
    M[i] = (bend - left * M[i - 1]) / pivot;
  }
  for (std::size_t i = count - 1; i-- > 1;) {
    M[i] -= upper[i] * M[i + 1];
    largest = std::max(largest, std::abs(M[i]));
  }

  // a spline rings into a rest, four times less at each sample: what is below rounding is rest, not 1e-300
  for (double& curvature : M)
    if (std::abs(curvature) < largest * 1e-17) curvature = 0;
  return M;
}

const char* column_of(KeystrokeQuantity quantity) {
  return quantity == KeystrokeQuantity::position ? "position_m" : "force_N";
}

using KeystrokeTable = csv::Table<3>;
constexpr std::size_t kTime = 0, kPosition = 1, kForce = 2;

KeystrokeTable open_table(const fs::path& file) {
  return {file, {"t_s", "position_m", "force_N"}, "must name t_s and one of position_m and force_N"};
}

KeystrokeQuantity find_quantity(KeystrokeTable& table) {
  if (!table.has(kTime)) table.reject_header("header has no column t_s");
  if (table.has(kPosition) && table.has(kForce)) table.reject_header("header has both position_m and force_N");
  if (!table.has(kPosition) && !table.has(kForce)) table.reject_header("header has neither position_m nor force_N");
  return table.has(kPosition) ? KeystrokeQuantity::position : KeystrokeQuantity::force;
}

void check_time(KeystrokeTable& table, const std::vector<double>& times, double time) {
  if (std::abs(time) > kLatestTime)
    table.reject_row(fmt::format("t_s = {} s, must be within +-{} s (a day)", time, kLatestTime));
  if (!times.empty() && time - times.back() < kShortestInterval)
    table.reject_row(fmt::format("t_s = {} s after {} s, must rise by {} s or more from row to row", time, times.back(),
                                 kShortestInterval));
}

void check_position(KeystrokeTable& table, double position) {
  if (std::abs(position) > kLongestTravel)
    table.reject_row(
        fmt::format("position_m = {} m, must be within +-{} m; positions are in metres, this looks like "
                    "millimetres",
                    position, kLongestTravel));
}

void check_speed(KeystrokeTable& table, double interval, double rise) {
  const double speed = rise / interval;
  if (std::abs(speed) > kHighestSpeed)
    table.reject_row(fmt::format("position_m rises at {:.4g} m/s from the row before, must be within +-{} m/s", speed,
                                 kHighestSpeed));
}

void check_force(KeystrokeTable& table, double force) {
  if (std::abs(force) > kHighestForce)
    table.reject_row(fmt::format("force_N = {} N, must be within +-{} N", force, kHighestForce));
}

// One line each: a comment that ran on would be read as a row.
std::string comment_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text.empty() ? "#\n" : "# " + text + "\n";
}

}  // namespace

Keystroke::Keystroke(KeystrokeQuantity quantity, std::vector<double> times, std::vector<double> values)
    : quantity_(quantity), times_(std::move(times)), values_(std::move(values)) {
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (times_.size() != values_.size() || times_.size() < 2)
    throw std::invalid_argument("a keystroke needs two samples or more, and a value for each time");
  if (!std::all_of(times_.begin(), times_.end(), is_finite) || !std::all_of(values_.begin(), values_.end(), is_finite))
    throw std::invalid_argument("the samples of a keystroke must be finite");
  if (std::adjacent_find(times_.begin(), times_.end(), std::greater_equal<>()) != times_.end())
    throw std::invalid_argument("the times of a keystroke must rise");
  curvatures_ = spline_curvatures(times_, values_);
}

// Index of the sample at the left of `time`, which lies within the samples.
std::size_t Keystroke::segment(double time) const noexcept {
  const auto right = std::upper_bound(times_.begin() + 1, times_.end() - 1, time);
  return static_cast<std::size_t>(std::distance(times_.begin(), right)) - 1;
}

Sample Keystroke::at(double time) const noexcept {
  if (!(time >= times_.front())) return {values_.front(), 0};  // also when it is not a number
  if (time > times_.back()) return {values_.back(), 0};

  const std::size_t i = segment(time);
  const double h = times_[i + 1] - times_[i];
  const double A = (times_[i + 1] - time) / h;
  const double B = (time - times_[i]) / h;
  const double M0 = curvatures_[i];
  const double M1 = curvatures_[i + 1];
  return {A * values_[i] + B * values_[i + 1] + ((A * A - 1) * A * M0 + (B * B - 1) * B * M1) * h * h / 6,
          (values_[i + 1] - values_[i]) / h + ((3 * B * B - 1) * M1 - (3 * A * A - 1) * M0) * h / 6};
}

Keystroke read_keystroke(const fs::path& file) {
  KeystrokeTable table = open_table(file);
  const KeystrokeQuantity quantity = find_quantity(table);
  const bool is_position = quantity == KeystrokeQuantity::position;

  std::vector<double> times, values;
  std::array<double, 3> row{};
  while (table.next(row)) {
    const double time = row[kTime];
    const double value = row[is_position ? kPosition : kForce];
    check_time(table, times, time);
    if (is_position) {
      check_position(table, value);
      if (!times.empty()) check_speed(table, time - times.back(), value - values.back());
    } else {
      check_force(table, value);
    }
    times.push_back(time);
    values.push_back(value);
  }
  if (times.size() < 2)
    table.reject_row(fmt::format("the file ends after {} of its rows, must have two or more", times.size()));
  return {quantity, std::move(times), std::move(values)};
}

void write_keystroke(const fs::path& file, const Keystroke& keystroke, std::span<const std::string> comments) {
  OutputFile output(file);
  for (const std::string& comment : comments) output.write(comment_line(comment));
  output.write(fmt::format("t_s,{}\n", column_of(keystroke.quantity())));
  for (std::size_t i = 0; i < keystroke.size(); ++i)
    output.write(fmt::format("{},{}\n", keystroke.times()[i], keystroke.values()[i]));  // shortest text that reads back
  output.commit();
}

}  // namespace erard
