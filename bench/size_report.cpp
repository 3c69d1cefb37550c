#include "size_report.hpp"

#include <fmt/format.h>
#include <fmt/os.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "growth.hpp"
#include "study/figure.hpp"

namespace erard::bench {
namespace {

constexpr double kMicro = 1e6;

/// family -> method -> time over size
struct Method {
  std::string name;
  Growth growth;
};
struct Family {
  std::string name;
  std::vector<Method> methods;

  const Growth* find(const std::string& method) const {
    const auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == method; });
    return found == methods.end() ? nullptr : &found->growth;
  }
};

std::vector<Family> families_of(const std::vector<Measured>& lines, double (*value)(const Measured&)) {
  std::vector<Family> families;
  for (const Measured& line : lines) {
    if (families.empty() || families.back().name != line.family) families.push_back({line.family, {}});
    auto& methods = families.back().methods;
    auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& m) { return m.name == line.method; });
    if (found == methods.end()) found = methods.insert(methods.end(), {line.method, {}});
    found->growth.size.push_back(line.size);
    found->growth.time.push_back(value(line));
  }
  return families;
}

double whole(const Measured& line) { return line.shortest(); }
double factor(const Measured& line) { return line.factorise.shortest; }

std::string power(const Growth& growth) {
  const double p = exponent(growth, 128);
  return std::isnan(p) ? "-" : fmt::format("{:.2f}", p);
}

std::string growth_table(const std::vector<Measured>& lines) {
  const std::vector<Family> all = families_of(lines, whole), factors = families_of(lines, factor);
  std::string text =
      "\n| mechanism | method | factorise grows as n^ | all grows as n^ | all, some 32 coordinates [us] | all, largest "
      "[us] |\n|---|---|---|---|---|---|\n";
  for (std::size_t f = 0; f < all.size(); ++f)
    for (std::size_t m = 0; m < all[f].methods.size(); ++m) {
      const auto& [method, growth] = all[f].methods[m];
      double small = 0;
      for (std::size_t i = 0; i < growth.size.size(); ++i)
        if (growth.size[i] <= 32) small = growth.time[i];
      text += fmt::format("| {} | {} | {} | {} | {:.2f} | {:.3g} at {:.0f} |\n", all[f].name, method,
                          power(factors[f].methods[m].growth), power(growth), kMicro * small,
                          kMicro * growth.time.back(), growth.size.back());
    }
  return text;
}

/// Size from which `one` stays ahead; "-" where it does not up to the largest.
std::string crossover_cell(const Growth* one, const Growth* other) {
  if (one == nullptr || other == nullptr) return "";
  const double size = crossover(*one, *other);
  return std::isnan(size) ? "-" : fmt::format("{:.0f}", size);
}

std::string crossover_table(const std::vector<Measured>& lines) {
  const std::vector<Family> all = families_of(lines, whole);
  const std::pair<const char*, const char*> pairs[] = {
      {"branches", "in place"}, {"LDL", "in place"}, {"branches", "dense"}, {"LDL", "dense"},
      {"KLU", "dense"},         {"LDL", "branches"}, {"KLU", "LDL"},        {"KLU", "dense LU"}};
  std::string text = "\n| from these coordinates on | is faster than |";
  for (const Family& family : all) text += fmt::format(" {} |", family.name);
  text += fmt::format("\n|---|---|{}\n", fmt::join(std::vector<std::string>(all.size(), "---|"), ""));
  for (const auto& [one, other] : pairs) {
    text += fmt::format("| {} | {} |", one, other);
    for (const Family& family : all) text += fmt::format(" {} |", crossover_cell(family.find(one), family.find(other)));
    text += "\n";
  }
  return text;
}

std::string noise_line(const std::vector<Measured>& lines) {
  std::vector<double> shortest, spread;
  for (const Measured& line : lines) {
    shortest.push_back(line.noise.shortest);
    spread.push_back(line.median() / line.shortest());
  }
  const auto [low, high] = std::minmax_element(shortest.begin(), shortest.end());
  return fmt::format(
      "\nNoise: a loop of fixed work beside every measurement took {:.1f} to {:.1f} us at its shortest (median "
      "{:.1f}); the\n"
      "median time of a method is {:.2f} times its shortest in the middle, {:.1f} times at worst.\n",
      kMicro * *low, kMicro * *high, kMicro * times_of(shortest).median, times_of(spread).median,
      *std::max_element(spread.begin(), spread.end()));
}

}  // namespace

void write_csv(const std::filesystem::path& file, const std::vector<Measured>& lines) {
  auto out = fmt::output_file(file.string());
  out.print(
      "family,method,coordinates,rows,factor_entries,analysis_us,factorise_min_us,factorise_median_us,solve_min_us,"
      "solve_median_us,delassus_min_us,delassus_median_us,total_min_us,total_median_us,noise_min_us,noise_median_us\n");
  for (const Measured& line : lines) {
    out.print("{},{},{},{},{},{:.3f}", line.family, line.method, line.size, line.rows, line.entries,
              kMicro * line.analysis);
    for (const Times& times : {line.factorise, line.solve, line.delassus})
      out.print(",{:.4f},{:.4f}", kMicro * times.shortest, kMicro * times.median);
    out.print(",{:.4f},{:.4f},{:.3f},{:.3f}\n", kMicro * line.shortest(), kMicro * line.median(),
              kMicro * line.noise.shortest, kMicro * line.noise.median);
  }
}

void draw_curves(const std::filesystem::path& file, const std::vector<Measured>& lines) {
  std::vector<study::Panel> panels;
  for (const Family& family : families_of(lines, whole)) {
    study::Panel panel;
    panel.title = family.name;
    panel.x = {"coordinates", {1, 2500}, true};
    panel.y = {"shortest time [us]", {0.02, 3e6}, true};
    panel.key = "top left";
    for (const auto& [method, growth] : family.methods) {
      study::Curve curve{method, growth.size, {}, "lines linewidth 2"};
      for (const double time : growth.time) curve.y.push_back(kMicro * time);
      panel.curves.push_back(curve);
    }
    panels.push_back(panel);
  }
  study::draw(file, panels, 2, 520, 360);
}

std::string size_tables(const std::vector<Measured>& lines) {
  return growth_table(lines) + crossover_table(lines) + noise_line(lines);
}

}  // namespace erard::bench
