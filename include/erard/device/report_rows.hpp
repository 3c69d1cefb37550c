// The rows of a run, kept small enough for a page.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "erard/device/simulation.hpp"

namespace erard {

/// Keeps the snapshots of a run in single precision. A run longer than kMost rows keeps every second, fourth ... row.
class ReportRows {
 public:
  static constexpr std::size_t kMost = 8001;  // 2.7 MB in the page with the 63 columns of the grand action

  /// @param period  between two rows [s]; @param start  time of the first [s]
  ReportRows(const Model& model, double start, double period);

  void add(const Snapshot& row);

  std::size_t count() const { return columns_.empty() ? 0 : values_.size() / columns_.size(); }
  std::size_t stride() const { return stride_; }  // rows of the run per row kept
  double start() const { return start_; }         // [s]
  double period() const { return period_; }       // of the run [s]
  double time(std::size_t row) const { return start_ + static_cast<double>(row * stride_) * period_; }
  const std::vector<std::string>& columns() const { return columns_; }  // names as in trajectory.csv, and the frictions

  std::size_t row_at(double time) const;  // the nearest, within the run; at least one row must be there
  Snapshot snapshot(std::size_t row) const;

  /// All values, column after column, as 32-bit floats of this machine's order (little-endian wherever erard is built).
  std::vector<float> by_column() const;

 private:
  void thin();

  int bodies_ = 0, contacts_ = 0;
  double start_ = 0, period_ = 0;
  std::size_t stride_ = 1, seen_ = 0;
  std::vector<std::string> columns_;
  std::vector<float> values_;  // row after row
};

}  // namespace erard
