// What bench_size measured, for people.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "timing.hpp"

namespace erard::bench {

/// One method on one mechanism.
struct Measured {
  std::string family, method;
  int size = 0, rows = 0;
  long entries = 0;     // of the factor below the diagonal
  double analysis = 0;  // once [s]
  Times factorise, solve, delassus, noise;

  double shortest() const { return factorise.shortest + solve.shortest + delassus.shortest; }
  double median() const { return factorise.median + solve.median + delassus.median; }
};

void write_csv(const std::filesystem::path& file, const std::vector<Measured>& lines);

/// Shortest time against coordinates, a panel a family, as SVG.
void draw_curves(const std::filesystem::path& file, const std::vector<Measured>& lines);

/// Growth, crossovers and noise as Markdown. `lines`: methods of one family at one size together, sizes ascending.
std::string size_tables(const std::vector<Measured>& lines);

}  // namespace erard::bench
