#include "study/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
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

/// A point in pixels, but for where the axes begin; not finite where it is not shown.
struct Place {
  double x = 0, y = 0;
};
struct Scale {
  Axis axis;
  double pixels;     // of the axis
  double low, high;  // its ends

  double place(double value) const {
    const auto at = [this](double v) { return axis.is_logarithmic ? std::log(v) : v; };
    return pixels * (at(value) - at(low)) / (at(high) - at(low));
  }
};

Scale scale_of(const Axis& axis, double pixels, const std::vector<Curve>& curves, std::vector<double> Curve::*values) {
  Scale scale{axis, pixels, axis.range.first, axis.range.second};
  if (scale.low != scale.high) return scale;
  scale.low = INFINITY, scale.high = -INFINITY;
  for (const Curve& curve : curves)
    for (const double v : curve.*values)
      if (std::isfinite(v)) scale.low = std::min(scale.low, v), scale.high = std::max(scale.high, v);
  return scale;
}

/// Marks the points between `first` and `last` that a polygon through those marked would miss by more than can be seen
/// (Ramer, Douglas, Peucker).
void mark_corners(const std::vector<Place>& at, std::size_t first, std::size_t last, std::vector<bool>& is_kept) {
  constexpr double kInvisible = 0.2;  // [px]
  const double dx = at[last].x - at[first].x, dy = at[last].y - at[first].y, length = std::hypot(dx, dy);
  std::size_t farthest = first;
  double distance = kInvisible;
  for (std::size_t i = first + 1; i < last; ++i) {
    const double x = at[i].x - at[first].x, y = at[i].y - at[first].y;
    const double off = length > 0 ? std::abs(x * dy - y * dx) / length : std::hypot(x, y);
    if (off > distance) farthest = i, distance = off;
  }
  if (farthest == first) return;
  is_kept[farthest] = true;
  mark_corners(at, first, farthest, is_kept);
  mark_corners(at, farthest, last, is_kept);
}

/// The points of a curve that its picture needs: of lines the corners, of the rest all.
std::vector<bool> needed_points(const Curve& curve, const Scale& x, const Scale& y) {
  std::vector<bool> is_kept(curve.x.size(), true);
  if (curve.style.rfind("lines ", 0) != 0 && curve.style != "lines") return is_kept;
  std::vector<Place> at;
  for (std::size_t i = 0; i < curve.x.size(); ++i) at.push_back({x.place(curve.x[i]), y.place(curve.y[i])});
  const auto is_finite = [&at](std::size_t i) { return std::isfinite(at[i].x) && std::isfinite(at[i].y); };
  for (std::size_t first = 0; first < at.size(); ++first) {
    if (!is_finite(first)) continue;
    std::size_t last = first;
    while (last + 1 < at.size() && is_finite(last + 1)) ++last;
    for (std::size_t i = first + 1; i < last; ++i) is_kept[i] = false;
    mark_corners(at, first, last, is_kept);
    first = last;
  }
  return is_kept;
}

void add_data(std::string& script, const Curve& curve, const Scale& x, const Scale& y) {
  const std::vector<bool> is_needed = needed_points(curve, x, y);
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    if (is_needed[i])
      script += std::isfinite(curve.y[i]) ? fmt::format("{:.6g} {:.6g}\n", curve.x[i], curve.y[i]) : "\n";
  script += "e\n";
}

/// End of the white space that starts at `at`.
std::size_t skip_space(const std::string& text, std::size_t at) {
  return std::min(text.find_first_not_of(" \n\r\t", at), text.size());
}

/// Without the groups in which gnuplot changes its pen and draws nothing.
std::string drop_empty_groups(const std::string& text) {
  const std::string open = "<g fill=\"none\"", close = "</g>";
  std::string kept;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t group = std::min(text.find(open, at), text.size());
    kept.append(text, at, group - at);
    if (group == text.size()) break;
    const std::size_t inside = skip_space(text, std::min(text.find('>', group), text.size() - 1) + 1);
    const bool is_empty = text.compare(inside, close.size(), close) == 0;
    at = is_empty ? skip_space(text, inside + close.size()) : inside;
    if (!is_empty) kept.append(text, group, inside - group);
  }
  return kept;
}

/// Paths with a tenth of a pixel where gnuplot writes hundredths: M12.34,5.67 becomes M12.3,5.6.
std::string shorten_points(const std::string& text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::string kept;
  bool is_point = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == 'M' || c == 'L')
      is_point = true;
    else if (!is_digit(c) && c != '.' && c != ',')
      is_point = false;
    const bool is_hundredth = is_point && i >= 2 && is_digit(c) && is_digit(text[i - 1]) && text[i - 2] == '.';
    if (!is_hundredth) kept += c;
  }
  return kept;
}

/// Takes out what gnuplot writes and nobody sees.
void tidy(const std::filesystem::path& svg) {
  std::string text;
  {
    std::ifstream in(svg);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  std::ofstream(svg) << shorten_points(drop_empty_groups(text));
}

void add_panel(std::string& script, const Panel& panel, int width, int height) {
  script += fmt::format("set title {}\nset key {}\n", quoted(panel.title), panel.key);
  add_axis(script, "x", panel.x);
  add_axis(script, "y", panel.y);
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    script += fmt::format("{} '-' using 1:2 with {} {}", i == 0 ? "plot" : ",", curve.style,
                          curve.label.empty() ? "notitle" : "title " + quoted(curve.label));
  }
  script += '\n';
  const Scale x = scale_of(panel.x, width, panel.curves, &Curve::x);
  const Scale y = scale_of(panel.y, height, panel.curves, &Curve::y);
  for (const Curve& curve : panel.curves) add_data(script, curve, x, y);
}

}  // namespace

void draw(const std::filesystem::path& svg, const std::vector<Panel>& panels, int columns, int width, int height) {
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  std::string script = fmt::format(
      "set terminal svg size {},{} dynamic background '#ffffff' font 'sans-serif,12'\nset output {}\n"
      "set grid lc rgb '#dddddd'\nset multiplot layout {},{}\n",
      columns * width, rows * height, quoted(svg.string()), rows, columns);
  for (const Panel& panel : panels) add_panel(script, panel, width, height);
  script += "unset multiplot\n";

  std::FILE* gnuplot = popen("gnuplot", "w");
  if (gnuplot == nullptr) throw std::runtime_error("gnuplot cannot be started");
  const bool is_written = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  if (pclose(gnuplot) != 0 || !is_written)
    throw std::runtime_error(fmt::format("gnuplot could not draw {}; is it installed?", svg.string()));
  tidy(svg);
}

}  // namespace erard::study
