#include "study/section.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace erard::study {

std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string text = fmt::format("| {} |\n", fmt::join(head, " | "));
  for (std::size_t i = 0; i < head.size(); ++i) text += "|---";
  text += "|\n";
  for (const auto& row : rows) text += fmt::format("| {} |\n", fmt::join(row, " | "));
  return text;
}

bool Recomputed::is_contradicted() const noexcept { return std::abs(difference()) > kContradiction; }

std::vector<Contradiction> contradictions_of(const std::vector<Recomputed>& all) {
  std::vector<Contradiction> contradictions;
  for (const Recomputed& r : all)
    if (r.is_contradicted())
      contradictions.push_back(
          {r.quantity, three_digits(r.printed), three_digits(r.computed), signed_percent(r.difference()), r.why});
  return contradictions;
}

std::string table(const std::vector<Contradiction>& contradictions) {
  std::vector<std::vector<std::string>> rows;
  for (const Contradiction& c : contradictions)
    rows.push_back({c.quantity, c.printed, c.computed, c.difference, c.why});
  return table({"quantity", "printed", "computed", "difference", "why"}, rows);
}

std::string table_of_confirmed(const std::vector<Recomputed>& all) {
  std::vector<std::vector<std::string>> rows;
  for (const Recomputed& r : all)
    if (!r.is_contradicted())
      rows.push_back({r.quantity, three_digits(r.printed), three_digits(r.computed), signed_percent(r.difference())});
  return table({"quantity", "printed", "computed", "difference"}, rows);
}

std::string fixed(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const double unit = std::pow(10, digits);
  return fmt::format("{:.{}f}", std::round(value * unit) / unit + 0.0, digits);
}

std::string three_digits(double value) { return std::isinf(value) ? "infinite" : fmt::format("{:.3g}", value); }

std::string signed_percent(double share) {
  return std::abs(share) < 5e-4 ? "0.0 %" : fmt::format("{:+.1f} %", 100 * share);
}

std::string percent(double share) { return fixed(100 * share, std::abs(share) < 0.0995 ? 1 : 0); }

}  // namespace erard::study
