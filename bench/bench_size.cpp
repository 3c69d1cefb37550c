// What the linear part of a step costs as the mechanism grows, by method. Writes size.csv and images/size.svg into a folder,
// and the tables of docs/performance_size.md to the screen:
//   build/release/bin/bench_size [FOLDER]        (default: docs; less than 2 minutes)
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "branch_system.hpp"
#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/sparse/constrained_system.hpp"
#include "erard/sparse/delassus.hpp"
#include "erard/sparse/keyboard.hpp"
#include "growth.hpp"
#include "large_tree.hpp"
#include "played_steps.hpp"
#include "study/figure.hpp"
#include "timing.hpp"

namespace {

using namespace erard;
using namespace erard::bench;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One mechanism: A with rows H, or with constraints G.
struct Problem {
  SparseMatrix A, H, G;
};

struct Measured {
  std::string family, method;
  int size = 0, rows = 0;
  long entries = 0;     // of the factor below the diagonal
  double analysis = 0;  // once [s]
  Times factorise, solve, delassus, noise;

  double shortest() const { return factorise.shortest + solve.shortest + delassus.shortest; }
  double median() const { return factorise.median + solve.median + delassus.median; }
};

/// Times one method. `delassus` may be empty.
void time_parts(Measured& line, const std::function<void()>& factorise, const std::function<void()>& solve,
                const std::function<void()>& delassus) {
  line.factorise = measure(factorise);
  line.noise = measure([] { fixed_work(); }, 2e-3);
  line.solve = measure(solve);
  if (delassus) line.delassus = measure(delassus);
}

void time_dense(const Problem& problem, Measured& line) {
  const MatrixXd A = problem.A, H = problem.H;
  Eigen::LLT<MatrixXd> factor(A.rows());
  const VectorXd b = VectorXd::Ones(A.rows());
  VectorXd x = b;
  MatrixXd Y = H, W(H.cols(), H.cols());
  line.entries = static_cast<long>(A.rows()) * (A.rows() - 1) / 2;
  time_parts(
      line, [&] { factor.compute(A); },
      [&] {
        x = b;
        factor.solveInPlace(x);
      },
      [&] {
        if (H.cols() == 0) return;
        Y = H;
        factor.matrixL().solveInPlace(Y);
        W.noalias() = Y.transpose() * Y;
      });
}

/// The engine's own functions, up to its bounds.
void time_in_place(const Problem& problem, Measured& line) {
  const BranchSystem tree(problem.A);
  const TriangularFactor& shape = tree.factor();
  AncestorTable above;
  above.size = shape.size;
  for (int k = 0; k < shape.size; ++k)
    for (int p = shape.start[k]; p < shape.start[k + 1]; ++p)
      above.list[shape.order[k]][above.count[shape.order[k]]++] = shape.order[shape.row[p]];
  const CoordinateMatrix A = MatrixXd(problem.A);
  const MatrixXd H = problem.H;
  CoordinateMatrix factor = A;
  CoordinateVector x(shape.size);
  MatrixXd Y = H;
  RowMatrix W(H.cols(), H.cols());
  line.entries = static_cast<long>(shape.row.size());
  time_parts(
      line,
      [&] {
        factor = A;
        factorise_branches(above, factor);
      },
      [&] {
        x.setOnes();
        solve_upwards(above, factor, shape.size - 1, x.data());
        solve_downwards(above, factor, x.data());
      },
      [&] {
        Y = H;
        for (int i = 0; i < H.cols(); ++i) {
          solve_upwards(above, factor, shape.size - 1, Y.col(i).data());
          for (int j = 0; j <= i; ++j) {
            double sum = 0;
            for (int k = 0; k < shape.size; ++k) sum += Y(k, i) * factor(k, k) * Y(k, j);
            W(i, j) = W(j, i) = sum;
          }
        }
      });
}

void time_branches(const Problem& problem, Measured& line) {
  const auto start = Clock::now();
  BranchSystem system(problem.A);
  Delassus delassus(system.factor(), problem.H);
  line.analysis = seconds_since(start);
  line.entries = static_cast<long>(system.factor().row.size());
  const VectorXd b = VectorXd::Ones(problem.A.rows());
  VectorXd x = b;
  time_parts(
      line, [&] { system.factorise(problem.A); },
      [&] {
        x = b;
        system.solve(x);
      },
      [&] { delassus.update(system.factor(), problem.H); });
}

void time_ldl(const Problem& problem, Measured& line) {
  const auto start = Clock::now();
  DefiniteSystem system(problem.A);
  Delassus delassus(system.factor(), problem.H);
  line.analysis = seconds_since(start);
  line.entries = system.factor_entries();
  const VectorXd b = VectorXd::Ones(problem.A.rows());
  VectorXd x = b;
  if (system.factorise(problem.A).status != FactorStatus::regular) throw std::runtime_error("LDL: singular");
  time_parts(
      line, [&] { system.factorise(problem.A); },
      [&] {
        x = b;
        system.solve(x);
      },
      [&] { delassus.update(system.factor(), problem.H); });
}

/// Columns of A^-1 H by one solve each: KLU has no halves to share.
void time_klu(const Problem& problem, Measured& line) {
  const auto start = Clock::now();
  ConstrainedSystem system(problem.A, problem.G);
  if (system.factorise(problem.A, problem.G).status != FactorStatus::regular) throw std::runtime_error("KLU: singular");
  line.analysis = seconds_since(start);
  line.entries = system.factor_entries();
  const VectorXd b = VectorXd::Ones(problem.A.rows()), none = VectorXd::Zero(problem.G.cols());
  VectorXd x = b, u = none;
  MatrixXd W(problem.H.cols(), problem.H.cols());
  time_parts(
      line, [&] { system.factorise(problem.A, problem.G); },
      [&] {
        x = b;
        u = none;
        system.solve(x, u);
      },
      [&] {
        for (int j = 0; j < problem.H.cols(); ++j) {
          x = problem.H.col(j);
          system.solve(x, u);
          W.col(j) = problem.H.transpose() * x;
        }
      });
}

void time_dense_lu(const Problem& problem, Measured& line) {
  const auto n = problem.A.rows(), c = problem.G.cols();
  MatrixXd K = MatrixXd::Zero(n + c, n + c);
  K.topLeftCorner(n, n) = problem.A;
  K.topRightCorner(n, c) = problem.G;
  K.bottomLeftCorner(c, n) = problem.G.transpose();
  Eigen::PartialPivLU<MatrixXd> factor(n + c);
  const VectorXd b = VectorXd::Ones(n + c);
  VectorXd x = b;
  line.entries = static_cast<long>(n + c) * (n + c);
  time_parts(
      line, [&] { factor.compute(K); }, [&] { x = factor.solve(b); }, {});
}

/// The grand action at 22 moments of a forte stroke, as often as it takes.
class Keyboards {
 public:
  Keyboards() {
    scheme_.time_step = kCalmStep;
    const ActionFile action = load_action(config_dir() / "grand_action.yaml");
    const Mechanism alone = build_mechanism(action.model);
    const Mechanism carried = build_mechanism(put_on_frame(action.model, {}, 1.0 / 88));
    const auto work = std::make_unique<Workspace>();
    for (const Moment& moment :
         moments_of(alone, scheme_, read_keystroke(config_dir() / "keystrokes" / "forte.csv"), 22)) {
      linearise_first(carried, scheme_, {bench::put_on_frame(moment.state), moment.drive}, *work);
      steps_.push_back(last_linearisation(carried, *work));
    }
  }
  Problem of(int count) const {
    std::vector<ActionStep> actions;
    for (int k = 0; k < count; ++k) actions.push_back(steps_[static_cast<std::size_t>(k) % steps_.size()]);
    const KeyboardStep whole = assemble_keyboard(actions, false);
    const SparseMatrix rows = whole.H.leftCols(std::min<Eigen::Index>(whole.H.cols(), 500));
    return {whole.A, rows, SparseMatrix(whole.A.rows(), 0)};
  }

 private:
  Scheme scheme_;
  std::vector<ActionStep> steps_;
};

Problem problem_of(const LargeTree& tree) {
  return {iteration_matrix(tree), row_directions(tree), closure_directions(tree)};
}

std::vector<Measured> measure_all() {
  using Timer = void (*)(const Problem&, Measured&);
  const std::vector<std::pair<std::string, Timer>> definite{{"in place", time_in_place},
                                                            {"dense", time_dense},
                                                            {"branches", time_branches},
                                                            {"LDL", time_ldl},
                                                            {"KLU", time_klu}};
  const std::vector<std::pair<std::string, Timer>> closed{{"dense LU", time_dense_lu}, {"KLU", time_klu}};
  const Keyboards keyboards;
  struct Family {
    std::string name;
    std::function<Problem(int)> make;  // of about that many coordinates
    const std::vector<std::pair<std::string, Timer>>* methods;
    int smallest, largest;
  };
  const std::vector<Family> families{
      {"bush", [](int n) { return problem_of(bush(n, 1)); }, &definite, 1, 2000},
      {"keyboard", [&](int n) { return keyboards.of(std::max(1, n / 6)); }, &definite, 6, 2000},
      {"felt stack", [](int n) { return problem_of(felt_stack(n)); }, &definite, 1, 2000},
      {"chain", [](int n) { return problem_of(chain(n, 1)); }, &definite, 1, 529},
      {"linkages", [](int n) { return problem_of(linkages(std::max(1, n / 3), 1)); }, &closed, 3, 1200}};
  std::vector<Measured> lines;
  for (const Family& family : families)
    for (const int n : {1, 2, 3, 6, 12, 18, 24, 32, 48, 64, 96, 128, 192, 256, 384, 529, 768, 1200, 2000}) {
      if (n < family.smallest || n > family.largest) continue;
      const Problem problem = family.make(n);
      for (const auto& [method, time] : *family.methods) {
        if (time == time_in_place && (problem.A.rows() > kMaxCoordinates || problem.H.cols() > kMaxRows)) continue;
        Measured line;
        line.family = family.name;
        line.method = method;
        line.size = static_cast<int>(problem.A.rows());
        line.rows = static_cast<int>(family.methods == &closed ? problem.G.cols() : problem.H.cols());
        time(problem, line);
        lines.push_back(line);
      }
    }
  return lines;
}

void write_csv(const std::filesystem::path& file, const std::vector<Measured>& lines) {
  auto out = fmt::output_file(file.string());
  out.print(
      "family,method,coordinates,rows,factor_entries,analysis_us,factorise_min_us,factorise_median_us,solve_min_us,"
      "solve_median_us,delassus_min_us,delassus_median_us,total_min_us,total_median_us,noise_min_us,noise_median_us\n");
  for (const Measured& line : lines) {
    out.print("{},{},{},{},{},{:.3f}", line.family, line.method, line.size, line.rows, line.entries,
              1e6 * line.analysis);
    for (const Times& times : {line.factorise, line.solve, line.delassus})
      out.print(",{:.4f},{:.4f}", 1e6 * times.shortest, 1e6 * times.median);
    out.print(",{:.4f},{:.4f},{:.3f},{:.3f}\n", 1e6 * line.shortest(), 1e6 * line.median(), 1e6 * line.noise.shortest,
              1e6 * line.noise.median);
  }
}

/// family -> method -> time over size
using Curves = std::vector<std::pair<std::string, std::vector<std::pair<std::string, Growth>>>>;

Curves curves_of(const std::vector<Measured>& lines, double (*value)(const Measured&)) {
  Curves curves;
  for (const Measured& line : lines) {
    if (curves.empty() || curves.back().first != line.family) curves.push_back({line.family, {}});
    auto& methods = curves.back().second;
    auto found = std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.first == line.method; });
    if (found == methods.end()) found = methods.insert(methods.end(), {line.method, {}});
    found->second.size.push_back(line.size);
    found->second.time.push_back(value(line));
  }
  return curves;
}

void draw_curves(const std::filesystem::path& file, const Curves& curves) {
  std::vector<study::Panel> panels;
  for (const auto& [family, methods] : curves) {
    study::Panel panel;
    panel.title = family;
    panel.x = {"coordinates", {1, 2500}, true};
    panel.y = {"shortest time [us]", {0.02, 3e6}, true};
    panel.key = "top left";
    for (const auto& [method, growth] : methods) {
      study::Curve curve{method, growth.size, {}, "lines linewidth 2"};
      for (const double time : growth.time) curve.y.push_back(1e6 * time);
      panel.curves.push_back(curve);
    }
    panels.push_back(panel);
  }
  study::draw(file, panels, 2, 520, 360);
}

void print_growth(const Curves& whole, const Curves& factor) {
  fmt::print(
      "| mechanism | method | factorise grows as n^ | all grows as n^ | all, some 32 coordinates [us] | all, largest "
      "[us] |\n|---|---|---|---|---|---|\n");
  for (std::size_t f = 0; f < whole.size(); ++f)
    for (std::size_t m = 0; m < whole[f].second.size(); ++m) {
      const auto& [method, growth] = whole[f].second[m];
      double small = 0;
      for (std::size_t i = 0; i < growth.size.size(); ++i)
        if (growth.size[i] <= 32) small = growth.time[i];
      const auto power = [](const Growth& of) {
        const double p = exponent(of, 128);
        return std::isnan(p) ? std::string("-") : fmt::format("{:.2f}", p);
      };
      fmt::print("| {} | {} | {} | {} | {:.2f} | {:.3g} at {:.0f} |\n", whole[f].first, method,
                 power(factor[f].second[m].second), power(growth), 1e6 * small, 1e6 * growth.time.back(),
                 growth.size.back());
    }
}

void print_crossovers(const Curves& whole, const Curves& factor) {
  fmt::print("\n| mechanism | from here on | is faster than | factorise | all |\n|---|---|---|---|---|\n");
  const auto text = [](const Growth& one, const Growth& other) {
    const double size = crossover(one, other);
    return std::isnan(size) ? fmt::format("not up to {:.0f}", std::min(one.size.back(), other.size.back()))
                            : fmt::format("{:.0f}", size);
  };
  for (std::size_t f = 0; f < whole.size(); ++f)
    for (std::size_t a = 0; a < whole[f].second.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        fmt::print("| {} | {} | {} | {} | {} |\n", whole[f].first, whole[f].second[a].first, whole[f].second[b].first,
                   text(factor[f].second[a].second, factor[f].second[b].second),
                   text(whole[f].second[a].second, whole[f].second[b].second));
}

void print_noise(const std::vector<Measured>& lines) {
  std::vector<double> shortest, spread;
  for (const Measured& line : lines) {
    shortest.push_back(line.noise.shortest);
    spread.push_back(line.median() / line.shortest());
  }
  const auto [low, high] = std::minmax_element(shortest.begin(), shortest.end());
  fmt::print(
      "\nNoise: the shortest time of a loop of fixed work beside every measurement was {:.1f} to {:.1f} us (median "
      "{:.1f}); the median time of a method is {:.2f} times its shortest in the middle, {:.1f} times at worst.\n",
      1e6 * *low, 1e6 * *high, 1e6 * times_of(shortest).median, times_of(spread).median,
      *std::max_element(spread.begin(), spread.end()));
}

}  // namespace

int main(int argc, char** argv) try {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "docs";
  const auto start = Clock::now();
  const std::vector<Measured> lines = measure_all();
  std::filesystem::create_directories(folder / "images");
  write_csv(folder / "size.csv", lines);
  const Curves whole = curves_of(lines, [](const Measured& line) { return line.shortest(); });
  const Curves factor = curves_of(lines, [](const Measured& line) { return line.factorise.shortest; });
  draw_curves(folder / "images" / "size.svg", whole);
  print_growth(whole, factor);
  print_crossovers(whole, factor);
  print_noise(lines);
  fmt::print("Took {:.0f} s.\n", seconds_since(start));
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_size: {}\n", error.what());
  return 1;
}
