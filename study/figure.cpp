#include "study/figure.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace erard::study {
namespace {

/// Text inside double quotes of a gnuplot script.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

/// Labels at 1, 2, 5 of each decade of a range of less than three, where gnuplot's own would be too few.
std::string one_two_five(const std::pair<double, double>& range) {
  if (range.first <= 0 || range.second >= 1e3 * range.first) return "autofreq";
  std::string labels;
  for (double decade = std::pow(10, std::floor(std::log10(range.first))); decade <= range.second; decade *= 10)
    for (const double part : {1., 2., 5.}) labels += fmt::format("{}{:g}", labels.empty() ? "(" : ",", part * decade);
  return labels + ")";
}

void add_axis(std::string& script, const char* name, const Axis& axis) {
  script += fmt::format("set {}label {}\n", name, quoted(axis.label));
  script += fmt::format("{} logscale {}\n", axis.is_logarithmic ? "set" : "unset", name);
  const bool has_small_decades = axis.is_logarithmic && axis.range.first > 0 && axis.range.first < 1e-3;
  script += fmt::format("set format {} '{}'\n", name, has_small_decades ? "10^{%T}" : "% h");
  script += fmt::format("set {}tics {}\n", name, axis.is_logarithmic ? one_two_five(axis.range) : "autofreq");
  if (axis.range.first == axis.range.second)
    script += fmt::format("set {}range [*:*]\n", name);
  else
    script += fmt::format("set {}range [{}:{}]\n", name, axis.range.first, axis.range.second);
}

void add_panel(std::string& script, const Panel& panel) {
  script += fmt::format("set title {}\nset key {}\n", quoted(panel.title), panel.key);
  add_axis(script, "x", panel.x);
  add_axis(script, "y", panel.y);
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    script += fmt::format("{} '-' using 1:2 with {} {}", i == 0 ? "plot" : ",", curve.style,
                          curve.label.empty() ? "notitle" : "title " + quoted(curve.label));
  }
  script += '\n';
  for (const Curve& curve : panel.curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      script += std::isfinite(curve.y[i]) ? fmt::format("{:.6g} {:.6g}\n", curve.x[i], curve.y[i]) : "\n";
    script += "e\n";
  }
}

}  // namespace

void draw(const std::filesystem::path& svg, const std::vector<Panel>& panels, int columns, int width, int height) {
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  std::string script = fmt::format(
      "set terminal svg size {},{} dynamic background '#ffffff' font 'sans-serif,12'\nset output {}\n"
      "set grid lc rgb '#dddddd'\nset multiplot layout {},{}\n",
      columns * width, rows * height, quoted(svg.string()), rows, columns);
  for (const Panel& panel : panels) add_panel(script, panel);
  script += "unset multiplot\n";

  std::FILE* gnuplot = popen("gnuplot", "w");
  if (gnuplot == nullptr) throw std::runtime_error("gnuplot cannot be started");
  const bool is_written = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  if (pclose(gnuplot) != 0 || !is_written)
    throw std::runtime_error(fmt::format("gnuplot could not draw {}; is it installed?", svg.string()));
}

}  // namespace erard::study
