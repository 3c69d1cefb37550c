#include "erard/device/force_curve.hpp"

#include <fmt/format.h>

#include <cmath>

#include "csv_table.hpp"

namespace erard {
namespace {

/// Value of a curve at rising instants, by straight lines.
class Interpolation {
 public:
  explicit Interpolation(const ForceCurve& curve) : curve_(curve) {}

  double at(double t) {
    while (k_ + 2 < curve_.time.size() && curve_.time[k_ + 1] <= t) ++k_;
    const double part = (t - curve_.time[k_]) / (curve_.time[k_ + 1] - curve_.time[k_]);
    return curve_.force[k_] + part * (curve_.force[k_ + 1] - curve_.force[k_]);
  }

 private:
  const ForceCurve& curve_;
  std::size_t k_ = 0;
};

}  // namespace

ForceCurve read_force_curve(const std::filesystem::path& file) {
  csv::Table<2> table(file, {"t_s", "force_N"}, "must name t_s and force_N", csv::OtherColumns::ignored);
  if (!table.has(0)) table.reject_header("header has no column t_s");
  if (!table.has(1)) table.reject_header("header has no column force_N");
  ForceCurve curve;
  std::array<double, 2> row{};
  while (table.next(row)) {
    if (!curve.time.empty() && row[0] <= curve.time.back())
      table.reject_row(fmt::format("t_s = {} s after {} s, must rise from row to row", row[0], curve.time.back()));
    curve.time.push_back(row[0]);
    curve.force.push_back(row[1]);
  }
  if (curve.time.size() < 2) table.reject_row("the file ends, must have at least two rows");
  return curve;
}

double relative_error(const ForceCurve& reference, const ForceCurve& curve, double end) {
  double error = 0, size = 0;
  double last_time = NAN, last_error = 0, last_size = 0;
  Interpolation ours(curve);
  for (std::size_t i = 0; i < reference.time.size(); ++i) {
    const double t = reference.time[i];
    if (t > end || t < curve.time.front() || t > curve.time.back()) continue;
    const double here_size = std::abs(reference.force[i]);
    const double here_error = std::abs(reference.force[i] - ours.at(t));
    if (!std::isnan(last_time)) {
      error += 0.5 * (t - last_time) * (here_error + last_error);
      size += 0.5 * (t - last_time) * (here_size + last_size);
    }
    last_time = t;
    last_error = here_error;
    last_size = here_size;
  }
  return size > 0 ? error / size : 0;
}

}  // namespace erard
