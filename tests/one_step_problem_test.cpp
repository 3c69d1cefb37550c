// The one-step problems of real strokes: solved to the end, and against an exact method.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/lemke.hpp"
#include "support/strokes.hpp"

namespace erard {
namespace {

struct Problem {
  OneStepProblem problem;
  RowVector impulse;
};

/// Every `stride`-th one-step problem of a stroke at the default settings, by default with felts that have a mass: their
/// contacts are rows of the problem too.
std::vector<Problem> collect(const std::string& name, int stride, FeltModel felts = FeltModel::bodies) {
  std::vector<Problem> problems;
  RunSettings settings;
  const Keystroke keystroke = test::keystroke(name);
  settings.tick = test::default_tick();
  settings.duration = keystroke.end();
  int count = 0;
  settings.on_problem = [&](const OneStepProblem& problem, const RowVector& impulse, double) {
    if (count++ % stride == 0) problems.push_back({problem, impulse});
  };
  ActionOptions options;
  options.felts = felts;
  run(test::grand_action(options), keystroke, settings);
  return problems;
}

TEST(OneStepProblem, EveryProblemOfAStrokeIsSolvedToOneInABillionWithAnOfflineLimit) {
  Scheme offline;
  offline.sweep_limit = 1000000;
  offline.sweep_tolerance = 1e-12;
  for (const char* name : {"forte", "repetition"}) {
    double worst = 0;
    int most_sweeps = 0;
    for (Problem& p : collect(name, 1)) {
      const SweepReport report = sweep_gauss_seidel(p.problem, offline, p.impulse);
      most_sweeps = std::max(most_sweeps, report.sweeps);
      worst = std::max(worst, residual(p.problem, p.impulse));
    }
    EXPECT_LT(worst, 1e-9) << name;
    std::printf("%s: worst residual %.1e, most sweeps %d\n", name, worst, most_sweeps);
  }
}

TEST(OneStepProblem, SolutionsObeyEveryLawAndAgreeWithLemke) {
  // random sample, seed 5: 150 problems of each stroke
  Scheme offline;
  offline.sweep_limit = 1000000;
  offline.sweep_tolerance = 1e-12;
  int compared = 0, rays = 0;
  double worst = 0;
  for (const char* name : {"forte", "repetition"}) {
    std::vector<Problem> problems = collect(name, 1);
    std::mt19937 random(5);
    std::shuffle(problems.begin(), problems.end(), random);
    problems.resize(150);
    for (Problem& p : problems) {
      sweep_gauss_seidel(p.problem, offline, p.impulse);
      const auto exact = test::solve_exactly(p.problem);
      if (!exact) {
        ++rays;
        continue;
      }
      ++compared;
      EXPECT_LT(residual(p.problem, *exact), 1e-8);  // Lemke itself: rounding of about 40 pivots
      // impulses are not unique where everything sticks, velocities are
      const RowVector u = p.problem.W * p.impulse + p.problem.q;
      const RowVector v = p.problem.W * *exact + p.problem.q;
      for (int i = 0; i < p.problem.size; ++i) {
        double scale = 0;
        for (int j = 0; j < p.problem.size; ++j)
          if (p.problem.cone[static_cast<std::size_t>(j)].is_angular ==
              p.problem.cone[static_cast<std::size_t>(i)].is_angular)
            scale = std::max(scale, std::abs(p.problem.q[j]));
        worst = std::max(worst, std::abs(u[i] - v[i]) / scale);
      }
    }
  }
  EXPECT_LT(worst, 1e-7);  // both are solved to 1e-9 of their scale; W is ill-conditioned by 1e2 at most
  EXPECT_GE(compared, 200);
  EXPECT_EQ(rays, 0);  // every problem of the sample is compared
  std::printf("compared %d problems with Lemke (%d rays), largest difference of a velocity %.1e of its scale\n",
              compared, rays, worst);
}

TEST(OneStepProblem, DelassusOperatorIsSymmetricWithoutFeltMasses) {
  for (const Problem& p : collect("forte", 100, FeltModel::massless)) {
    const auto W = p.problem.W.topLeftCorner(p.problem.size, p.problem.size);
    EXPECT_LE((W - W.transpose()).cwiseAbs().maxCoeff(),
              1e-12 * W.cwiseAbs().maxCoeff());  // rounding of a few products
  }
}

TEST(OneStepProblem, DelassusOperatorIsSymmetricButForTheFelts) {
  for (const Problem& p : collect("forte", 100)) {
    const auto& W = p.problem.W;
    for (int i = 0; i < p.problem.size; ++i)
      for (int j = 0; j < p.problem.size; ++j)
        // an unloaded felt hangs on its carrier by its mass alone: sqrt(15 mg / 5 g), the jack's at its toe
        EXPECT_NEAR(W(i, j), W(j, i), 0.06 * std::sqrt(W(i, i) * W(j, j)));
  }
}

TEST(OneStepProblem, DefaultLimitLeavesSmallResiduals) {
  for (const auto& [name, felts] :
       {std::pair{"piano", FeltModel::massless}, {"forte", FeltModel::massless}, {"repetition", FeltModel::bodies}}) {
    std::vector<double> residuals;
    for (const Problem& p : collect(name, 1, felts)) residuals.push_back(residual(p.problem, p.impulse));
    std::sort(residuals.begin(), residuals.end());
    const auto quantile = [&](double q) {
      return residuals[static_cast<std::size_t>(q * static_cast<double>(residuals.size() - 1))];
    };
    EXPECT_LT(quantile(0.99), 1e-6) << name;  // what the sweeps are asked for
    EXPECT_LT(quantile(1), 1e-3) << name;     // jammed states that reach the limit
    std::printf("%s: residual median %.1e, 99 %% %.1e, 99.9 %% %.1e, largest %.1e of %zu problems\n", name,
                quantile(0.5), quantile(0.99), quantile(0.999), quantile(1), residuals.size());
  }
}

TEST(OneStepProblem, DefaultSweepLimitCostsLessThanAThousandthOfANewton) {
  for (const auto& [name, end] : {std::pair{"piano", 0.22}, {"forte", 0.142}, {"repetition", 0.8}}) {
    const ActionFile action = test::grand_action();
    TickSettings exact = test::default_tick();
    exact.scheme.sweep_limit = 100000;
    exact.scheme.sweep_tolerance = 1e-11;
    const auto ours = test::play(action, test::keystroke(name));
    const auto difference = test::difference(ours, test::play(action, test::keystroke(name), exact), end);
    EXPECT_LT(difference.rms, 1e-3) << name;
    std::printf("%s: sweep limit and tolerance cost %.1e N rms, %.1e N at most\n", name, difference.rms,
                difference.largest);
  }
}

TEST(OneStepProblem, RecalledFrictionIsTheSolutionThatSweepsFind) {
  // the two differ by the sweep tolerance alone: 1e-6 of the velocities, some 1e-5 N in the finger
  for (const auto& [name, end] : {std::pair{"piano", 0.22}, {"forte", 0.142}, {"repetition", 0.8}}) {
    TickSettings swept = test::default_tick();
    swept.scheme.is_friction_recalled = false;
    const auto ours = test::play(test::grand_action(), test::keystroke(name));
    const auto theirs = test::play(test::grand_action(), test::keystroke(name), swept);
    const auto difference = test::difference(ours, theirs, end);
    EXPECT_LT(difference.rms, 1e-4) << name;
    EXPECT_LT(5 * ours.result.sweeps, 4 * theirs.result.sweeps) << name;  // it does save sweeps
    std::printf("%s: recalled against swept friction %.1e N rms, %.1e N at most; %ld against %ld sweeps\n", name,
                difference.rms, difference.largest, ours.result.sweeps, theirs.result.sweeps);
  }
}

TEST(GaussSeidel, OneSlidingBlockIsSolvedInOneVisit) {
  OneStepProblem problem;
  problem.size = 2;
  problem.W.resize(2, 2);
  problem.W << 2, 0, 0, 2;
  problem.q.resize(2);
  problem.q << -1, 3;
  problem.cone[0] = {ConeKind::half_line, -1, 0, false};
  problem.cone[1] = {ConeKind::friction, 0, 0.3, false};
  RowVector r = RowVector::Zero(2);
  sweep_gauss_seidel(problem, Scheme{}, r);
  EXPECT_DOUBLE_EQ(r[0], 0.5);         // stops the approach of 1 m/s
  EXPECT_DOUBLE_EQ(r[1], -0.3 * 0.5);  // 3 m/s are too fast to be stopped: Coulomb's limit
  EXPECT_LT(residual(problem, r), 1e-15);
}

TEST(GaussSeidel, HingeInsideItsBandStops) {
  OneStepProblem problem;
  problem.size = 1;
  problem.W.setConstant(1, 1, 4.0);
  problem.q.setConstant(1, 0.2);
  problem.cone[0] = {ConeKind::interval, -1, 0.1, true};
  RowVector r = RowVector::Zero(1);
  sweep_gauss_seidel(problem, Scheme{}, r);
  EXPECT_DOUBLE_EQ(r[0], -0.05);
}

TEST(GaussSeidel, ResidualSeesEveryRow) {
  OneStepProblem problem;
  problem.size = 3;
  problem.W = RowMatrix::Identity(3, 3);
  problem.q = RowVector::Constant(3, -1);
  problem.cone[0] = {ConeKind::half_line, -1, 0, false};
  problem.cone[1] = {ConeKind::friction, 0, 0.5, false};
  problem.cone[2] = {ConeKind::interval, -1, 2, true};
  RowVector solution(3);
  solution << 1, 0.5, 1;
  EXPECT_LT(residual(problem, solution), 1e-15);
  for (int i = 0; i < 3; ++i) {
    RowVector r = solution;
    r[i] += 1e-3;
    EXPECT_GT(residual(problem, r), 5e-4) << "row " << i;
  }
}

}  // namespace
}  // namespace erard
