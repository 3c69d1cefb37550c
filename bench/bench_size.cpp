// What the linear part of a step costs as the mechanism grows, by method. Writes size.csv and images/size.svg into a folder,
// and the tables to the screen and into a page that has a place for them:
//   build/release/bin/bench_size docs --markdown docs/performance.md        (less than 2 minutes)
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "branch_system.hpp"
#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/device/error.hpp"
#include "erard/sparse/constrained_system.hpp"
#include "erard/sparse/delassus.hpp"
#include "erard/sparse/keyboard.hpp"
#include "large_tree.hpp"
#include "markdown_block.hpp"
#include "played_steps.hpp"
#include "size_report.hpp"

namespace {

using namespace erard;
using namespace erard::bench;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One mechanism: A with rows H, or with constraints G.
struct Problem {
  SparseMatrix A, H, G;
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

/// A tree's own elimination, and W from its factor.
/// @param System  BranchSystem or DefiniteSystem
template <typename System>
void time_tree(const Problem& problem, Measured& line) {
  const auto start = Clock::now();
  System system(problem.A);
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
                                                            {"branches", time_tree<BranchSystem>},
                                                            {"LDL", time_tree<DefiniteSystem>},
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

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool has_page = arguments.size() == 3 && arguments[1] == "--markdown";
  if (arguments.empty() || arguments[0].starts_with("-") || (arguments.size() > 1 && !has_page)) {
    fmt::print(stderr, "usage: bench_size FOLDER [--markdown FILE]\n");
    return 2;
  }
  const std::filesystem::path folder = arguments[0];
  std::optional<MarkdownBlock> page;
  if (has_page) page.emplace(arguments[2], "bench_size");
  const std::vector<Measured> lines = measure_all();
  std::filesystem::create_directories(folder / "images");
  write_csv(folder / "size.csv", lines);
  draw_curves(folder / "images" / "size.svg", lines);
  const std::string text = size_tables(lines);
  if (page) page->replace(text);
  fmt::print("{}", text);
} catch (const erard::InputError& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_size: {}\n", error.what());
  return 1;
}
