#include "erard/device/report_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace erard {

ReportRows::ReportRows(const Model& model, double start, double period)
    : bodies_(model.body_count), contacts_(model.contact_count), start_(start), period_(period) {
  columns_ = {"input", "y_m", "force_N"};
  const auto add_bodies = [&](const char* form) {
    for (int i = 0; i < bodies_; ++i) columns_.push_back(fmt::format(fmt::runtime(form), model.bodies[i].name.view()));
  };
  const auto add_contacts = [&](const char* form) {
    for (int c = 0; c < contacts_; ++c)
      columns_.push_back(fmt::format(fmt::runtime(form), model.contacts[c].name.view()));
  };
  add_bodies("theta_{}");
  add_bodies("omega_{}");
  add_contacts("delta_{}_m");
  add_contacts("normal_{}_N");
  add_contacts("tangential_{}_N");
  add_bodies("hinge_{}_N_m");
}

void ReportRows::add(const Snapshot& row) {
  if (seen_++ % stride_ != 0) return;
  const auto put = [this](double value) { values_.push_back(static_cast<float>(value)); };
  put(row.input.value);
  put(row.key_position);
  put(row.force);
  for (const auto* part : {&row.angle, &row.rate, &row.compression, &row.normal, &row.tangential, &row.hinge_moment})
    std::for_each(part->begin(), part->end(), put);
  if (count() > kMost) thin();
}

void ReportRows::thin() {
  const std::size_t width = columns_.size();
  const std::size_t rows = count();
  std::size_t kept = 0;
  for (std::size_t row = 0; row < rows; row += 2, ++kept)
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(row * width), width,
                values_.begin() + static_cast<std::ptrdiff_t>(kept * width));
  values_.resize(kept * width);
  stride_ *= 2;
}

std::size_t ReportRows::row_at(double time) const {
  const double row = std::round((time - start_) / (period_ * static_cast<double>(stride_)));
  return static_cast<std::size_t>(std::clamp(row, 0.0, static_cast<double>(count() - 1)));
}

Snapshot ReportRows::snapshot(std::size_t row) const {
  const float* value = values_.data() + row * columns_.size();
  Snapshot result;
  result.time = time(row);
  result.input.value = *value++;
  result.key_position = *value++;
  result.force = *value++;
  const auto take = [&value](int count, std::vector<double>& to) {
    to.assign(value, value + count);
    value += count;
  };
  take(bodies_, result.angle);
  take(bodies_, result.rate);
  take(contacts_, result.compression);
  take(contacts_, result.normal);
  take(contacts_, result.tangential);
  take(bodies_, result.hinge_moment);
  return result;
}

std::vector<float> ReportRows::by_column() const {
  const std::size_t width = columns_.size(), rows = count();
  std::vector<float> result(values_.size());
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < width; ++column) result[column * rows + row] = values_[row * width + column];
  return result;
}

}  // namespace erard
