// Plots of the studies, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace erard::study {

struct Curve {
  std::string label;            // empty: not in the key
  std::vector<double> x, y;     // of equal length; a NaN breaks the line
  std::string style = "lines";  // gnuplot: lines, points, linespoints, steps, with its options ("lines dashtype 2")
};

struct Axis {
  std::string label;                      // quantity and unit
  std::pair<double, double> range{0, 0};  // equal ends: as the data are
  bool is_logarithmic = false;
};

/// One pair of axes.
struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves;
  std::string key = "top right";  // where gnuplot puts the key
};

/// Draws panels side by side, row by row, into an SVG file. Of lines only the points are drawn whose absence would show.
/// @param width, height  of one panel [px]
/// Throws std::runtime_error when gnuplot is not installed or fails.
void draw(const std::filesystem::path& svg, const std::vector<Panel>& panels, int columns = 1, int width = 640,
          int height = 400);

}  // namespace erard::study
