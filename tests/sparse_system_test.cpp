// Sparse systems of mechanisms of any size against dense ones, against the engine in place, and where they must refuse.
#include <gtest/gtest.h>
#include <link.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "../bench/branch_system.hpp"
#include "../bench/growth.hpp"
#include "../bench/large_tree.hpp"
#include "erard/mechanics/dynamics.hpp"
#include "erard/solver/branch_factor.hpp"
#include "erard/sparse/constrained_system.hpp"
#include "erard/sparse/delassus.hpp"
#include "support/heap_calls.hpp"

namespace erard {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEps = std::numeric_limits<double>::epsilon();

VectorXd random_vector(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  VectorXd b(n);
  for (int i = 0; i < n; ++i) b[i] = any(random);
  return b;
}

/// Condition after scaling to a unit diagonal, which the errors of Cholesky's method and of L D L^T follow: van der Sluis,
/// Numer. Math. 14, 14 (1969); Higham, Accuracy and Stability (2002), 10.1.
struct Scaled {
  VectorXd scale;  // square roots of the diagonal
  double condition;
};
Scaled scaled_condition(const MatrixXd& A) {
  const VectorXd scale = A.diagonal().cwiseSqrt();
  const MatrixXd unit = scale.cwiseInverse().asDiagonal() * A * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> values(unit, Eigen::EigenvaluesOnly);
  return {scale, values.eigenvalues().maxCoeff() / values.eigenvalues().minCoeff()};
}

/// |a - b| in the metric of the diagonal, relative to |b| in it.
double difference(const VectorXd& a, const VectorXd& b, const VectorXd& scale) {
  return scale.cwiseProduct(a - b).norm() / scale.cwiseProduct(b).norm();
}

SparseMatrix sparse(const MatrixXd& dense) {
  SparseMatrix matrix = dense.sparseView();
  matrix.makeCompressed();
  return matrix;
}

// ---- trees of any size

/// Hinges and slides, as large as the engine takes them.
bench::LargeTree mixed_bush(int size, unsigned seed) {
  bench::LargeTree tree = bench::bush(size, seed);
  for (int i = 0; i < size; i += 3) {
    tree.bodies[i].joint = JointKind::prismatic;
    tree.bodies[i].direction = 0.7 * i;
  }
  tree.touches.clear();  // their points were chosen for the tree of hinges
  return tree;
}

TEST(LargeTree, HasTheMassMatrixOfTheEngine) {
  for (int size = 1; size <= kMaxBodies; ++size) {
    const bench::LargeTree tree = mixed_bush(size, static_cast<unsigned>(size));
    Model model;
    model.body_count = size;
    std::copy(tree.bodies.begin(), tree.bodies.end(), model.bodies.begin());
    const Mechanism mechanism = build_mechanism(model);
    Frames frames;
    ContactFrames contacts;
    CoordinateMatrix M;
    place_bodies(model, tree.x, frames);
    assemble_mass_matrix(mechanism, frames, contacts, M);
    const MatrixXd ours = bench::mass_matrix(tree);
    // the same sums in another order: some 100 roundings
    EXPECT_LT((ours - M).norm(), 100 * kEps * M.norm()) << size;
  }
}

TEST(BranchSystem, HasTheFactorOfTheEngineBitForBit) {
  const bench::LargeTree tree = mixed_bush(kMaxBodies, 3);
  Model model;
  model.body_count = kMaxBodies;
  std::copy(tree.bodies.begin(), tree.bodies.end(), model.bodies.begin());
  const Mechanism mechanism = build_mechanism(model);
  const SparseMatrix A = bench::iteration_matrix(tree);
  CoordinateMatrix factor = MatrixXd(A);
  factorise_branches(mechanism.elimination, factor);
  bench::BranchSystem branch(A);
  branch.factorise(A);
  const TriangularFactor& ours = branch.factor();
  int entries = 0;
  for (int k = 0; k < kMaxBodies; ++k) {
    EXPECT_EQ(1 / ours.diagonal[k], factor(ours.order[k], ours.order[k]));
    for (int p = ours.start[k]; p < ours.start[k + 1]; ++p, ++entries)
      EXPECT_EQ(ours.value[p], factor(ours.order[k], ours.order[ours.row[p]]));
  }
  EXPECT_GT(entries, kMaxBodies);
}

TEST(Growth, FindsTheExponentAndTheCrossoverOfPowerLaws) {
  bench::Growth cube, line;
  for (const double n : {1.0, 3.0, 10.0, 30.0, 100.0, 300.0}) {
    cube.size.push_back(n);
    cube.time.push_back(2e-9 * n * n * n);
    line.size.push_back(n);
    line.time.push_back(8e-7 * n);  // n^2 = 400
  }
  EXPECT_NEAR(bench::exponent(cube, 3), 3, 1e-12);
  EXPECT_NEAR(bench::exponent(line, 3), 1, 1e-12);
  EXPECT_NEAR(bench::crossover(line, cube), 20, 1e-10);
  EXPECT_TRUE(std::isnan(bench::crossover(cube, line)));
}

// ---- positive definite

TEST(DefiniteSystem, SolvesTreesWithContactsAsDenseCholeskyDoes) {
  for (const int size : {1, 2, 3, 6, 12, 40, 150})
    for (unsigned seed = 1; seed <= 5; ++seed)
      for (const auto& tree :
           {bench::bush(size, seed), bench::chain(std::min(size, 40), seed), bench::felt_stack(size)}) {
        const SparseMatrix A = bench::iteration_matrix(tree);
        const MatrixXd dense = A;
        const VectorXd b = random_vector(tree.size(), seed);
        VectorXd x = b, branch = b;
        DefiniteSystem system(A);
        const FactorReport report = system.factorise(A);
        ASSERT_EQ(report.status, FactorStatus::regular) << size << " " << seed << " " << report.least_pivot;
        system.solve(x);
        bench::BranchSystem branches(A);
        branches.factorise(A);
        branches.solve(branch);
        const Scaled scaled = scaled_condition(dense);
        // n eps times condition, of both
        const double tolerance = 2 * (tree.size() + 1) * kEps * scaled.condition;
        const VectorXd expected = dense.llt().solve(b);
        EXPECT_LT(difference(x, expected, scaled.scale), tolerance) << size << " " << seed;
        EXPECT_LT(difference(branch, expected, scaled.scale), tolerance) << size << " " << seed;
      }
}

TEST(DefiniteSystem, AnalysesOnceAndFollowsTheNumbers) {
  bench::LargeTree tree = bench::bush(60, 4);
  SparseMatrix A = bench::iteration_matrix(tree);
  DefiniteSystem system(A);
  for (int k = 0; k < 3; ++k) {
    for (double& x : tree.x) x += 0.3;  // the bodies move, the points of contact too
    for (bench::Touch& touch : tree.touches) touch.loss *= 0.5;
    A = bench::iteration_matrix(tree);
    VectorXd x = random_vector(60, 9);
    const VectorXd b = x;
    ASSERT_EQ(system.factorise(A).status, FactorStatus::regular);
    system.solve(x);
    const Scaled scaled = scaled_condition(A);
    EXPECT_LT(difference(x, MatrixXd(A).llt().solve(b), scaled.scale), 122 * kEps * scaled.condition);
  }
}

TEST(Delassus, IsThatOfTheDenseInverse) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const bench::LargeTree tree = bench::bush(80, seed);
    const SparseMatrix A = bench::iteration_matrix(tree), H = bench::row_directions(tree);
    ASSERT_EQ(H.cols(), 20);
    DefiniteSystem system(A);
    ASSERT_EQ(system.factorise(A).status, FactorStatus::regular);
    Delassus ours(system.factor(), H);
    bench::BranchSystem branches(A);
    branches.factorise(A);
    Delassus of_branches(branches.factor(), H);
    const MatrixXd directions = H;
    const MatrixXd W = directions.transpose() * MatrixXd(A).llt().solve(directions);
    const double tolerance = 162 * kEps * scaled_condition(A).condition * W.diagonal().maxCoeff();
    for (int repeat = 0; repeat < 2; ++repeat) {  // nothing is left from the first time
      EXPECT_LT((ours.update(system.factor(), H) - W).cwiseAbs().maxCoeff(), tolerance);
      EXPECT_LT((of_branches.update(branches.factor(), H) - W).cwiseAbs().maxCoeff(), tolerance);
    }
  }
}

TEST(DefiniteSystem, ReportsABodyWithoutInertia) {
  bench::LargeTree tree = bench::bush(30, 1);
  std::vector<bool> has_child(30, false);
  for (const Body& body : tree.bodies)
    if (body.parent != kGround) has_child[static_cast<std::size_t>(body.parent)] = true;
  int leaf = 29;
  while (has_child[static_cast<std::size_t>(leaf)]) --leaf;
  tree.touches.clear();
  tree.bodies[leaf].mass = tree.bodies[leaf].inertia = 0;
  const SparseMatrix A = bench::iteration_matrix(tree);
  const FactorReport report = DefiniteSystem(A).factorise(A);
  EXPECT_EQ(report.status, FactorStatus::singular);
  EXPECT_EQ(report.coordinate, leaf);
}

TEST(DefiniteSystem, ReportsTwoHingesThatAreOne) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    bench::LargeTree tree = bench::chain(12, seed);
    tree.pull = 0;
    const auto i = 3 + seed % 7;
    tree.bodies[i].mass = tree.bodies[i].inertia =
        0;  // a link without mass and length: only the sum of two angles counts
    tree.bodies[i + 1].origin = {0, 0};
    const SparseMatrix A = bench::iteration_matrix(tree);
    const FactorReport report = DefiniteSystem(A).factorise(A);
    EXPECT_EQ(report.status, FactorStatus::singular) << seed << ": " << report.least_pivot;
    tree.bodies[i].inertia = 1e-9;  // a thousandth of a thousandth of a gram ten centimetres away: regular
    const SparseMatrix B = bench::iteration_matrix(tree);
    EXPECT_EQ(DefiniteSystem(B).factorise(B).status, FactorStatus::regular) << seed;
  }
}

TEST(DefiniteSystem, ReportsPivotsThatAreOnlyRounding) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const MatrixXd B = random_vector(9 * 10, seed).reshaped(9, 10);  // ten coordinates, nine of them with a mass
    const SparseMatrix A = sparse(B.transpose() * B);
    const FactorReport report = DefiniteSystem(A).factorise(A);
    EXPECT_EQ(report.status, FactorStatus::singular) << seed << ": " << report.least_pivot;
  }
}

TEST(DefiniteSystem, ReportsWhatIsNotPositiveDefinite) {
  const SparseMatrix indefinite = sparse(MatrixXd{{1, 2}, {2, 1}});
  EXPECT_EQ(DefiniteSystem(indefinite).factorise(indefinite).status, FactorStatus::singular);
  const SparseMatrix negative = sparse(MatrixXd{{-1, 0.5}, {0.5, -1}});
  EXPECT_EQ(DefiniteSystem(negative).factorise(negative).status, FactorStatus::singular);
}

TEST(DefiniteSystem, ReportsNumbersThatAreNone) {
  SparseMatrix A = bench::iteration_matrix(bench::bush(20, 2));
  DefiniteSystem system(A);
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (int p = 0; p < A.nonZeros(); ++p) {
      SparseMatrix B = A;
      B.valuePtr()[p] = wrong;
      const SparseMatrix mirrored = B.transpose();
      for (int q = 0; q < B.nonZeros(); ++q)
        if (mirrored.valuePtr()[q] != A.valuePtr()[q] && !std::isfinite(mirrored.valuePtr()[q]))
          B.valuePtr()[q] = wrong;
      EXPECT_NE(system.factorise(B).status, FactorStatus::regular) << wrong << " at " << p;
    }
  EXPECT_EQ(system.factorise(A).status, FactorStatus::regular);  // and nothing of it stays
}

TEST(DefiniteSystem, ReportsAnotherPattern) {
  const SparseMatrix A = bench::iteration_matrix(bench::bush(20, 2)), B = bench::iteration_matrix(bench::chain(20, 2));
  EXPECT_EQ(DefiniteSystem(A).factorise(B).status, FactorStatus::other_pattern);
}

TEST(DefiniteSystem, JudgesPivotsWithoutUnits) {
  const SparseMatrix A = bench::iteration_matrix(bench::bush(40, 5));
  DefiniteSystem system(A);
  const FactorReport before = system.factorise(A);
  SparseMatrix B = A;
  for (int j = 0; j < B.cols(); ++j)  // powers of 2, which round nothing: each coordinate in a unit of its own
    for (int p = B.outerIndexPtr()[j]; p < B.outerIndexPtr()[j + 1]; ++p)
      B.valuePtr()[p] *= std::ldexp(1.0, 3 * (j % 5) + 3 * (B.innerIndexPtr()[p] % 5));
  const FactorReport after = system.factorise(B);
  EXPECT_EQ(before.least_pivot, after.least_pivot);
  EXPECT_EQ(before.coordinate, after.coordinate);
}

TEST(DefiniteSystem, RefusesPatternsThatAreNone) {
  EXPECT_THROW(DefiniteSystem(SparseMatrix(0, 0)), std::invalid_argument);
  EXPECT_THROW(DefiniteSystem(SparseMatrix(2, 3)), std::invalid_argument);
  EXPECT_THROW(DefiniteSystem(sparse(MatrixXd{{1, 2}, {0, 1}})), std::invalid_argument);
  EXPECT_THROW(DefiniteSystem(sparse(MatrixXd{{1, 2}, {2, 0}})), std::invalid_argument);
}

// ---- closed chains

/// dv of the closed chain by coordinates that keep the loops closed: dv = Z (Z^T A Z)^-1 Z^T b, u = 0.
VectorXd reduced_solution(const MatrixXd& A, const MatrixXd& G, const VectorXd& b) {
  const MatrixXd Z = Eigen::FullPivLU<MatrixXd>(G.transpose()).kernel();
  return Z * (Z.transpose() * A * Z).ldlt().solve(Z.transpose() * b);
}

/// Condition of the closed chain's system in the scaling that ConstrainedSystem uses.
double scaled_condition(const MatrixXd& A, const MatrixXd& G) {
  const VectorXd scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const auto n = A.rows(), c = G.cols();
  MatrixXd K = MatrixXd::Zero(n + c, n + c);
  K.topLeftCorner(n, n) = scale.asDiagonal() * A * scale.asDiagonal();
  K.topRightCorner(n, c) = (scale.asDiagonal() * G).colwise().normalized();
  K.bottomLeftCorner(c, n) = K.topRightCorner(n, c).transpose();
  const auto values = Eigen::JacobiSVD<MatrixXd>(K).singularValues();
  return values[0] / values[n + c - 1];
}

TEST(ConstrainedSystem, MovesLinkagesAsTheirReducedCoordinatesDo) {
  for (const int count : {1, 2, 5, 12})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const bench::LargeTree tree = bench::linkages(count, seed);
      const SparseMatrix A = bench::iteration_matrix(tree), G = bench::closure_directions(tree);
      ConstrainedSystem system(A, G);
      ASSERT_EQ(system.factorise(A, G).status, FactorStatus::regular) << count << " " << seed;
      const VectorXd b = random_vector(tree.size(), seed);
      VectorXd dv = b, r = VectorXd::Zero(2 * count);
      system.solve(dv, r);
      // LU without growth errs by some n eps times the condition; factor 10 for a growth that partial pivots allow
      const double tolerance = 10 * (tree.size() + 2 * count) * kEps * scaled_condition(MatrixXd(A), MatrixXd(G));
      const VectorXd scale = MatrixXd(A).diagonal().cwiseSqrt();
      EXPECT_LT(difference(dv, reduced_solution(A, G, b), scale), tolerance) << count << " " << seed;
      const VectorXd loads = b + G * r;
      EXPECT_LT((A * dv - loads).cwiseQuotient(scale).norm(), tolerance * loads.cwiseQuotient(scale).norm());
      EXPECT_LT((G.transpose() * dv).norm(), tolerance * dv.norm() * MatrixXd(G).norm());
    }
}

TEST(ConstrainedSystem, ReachesTheVelocitiesAskedFor) {
  const bench::LargeTree tree = bench::linkages(3, 7);
  const SparseMatrix A = bench::iteration_matrix(tree), G = bench::closure_directions(tree);
  ConstrainedSystem system(A, G);
  ASSERT_EQ(system.factorise(A, G).status, FactorStatus::regular);
  const VectorXd u = random_vector(6, 1);
  VectorXd dv = VectorXd::Zero(10), r = u;
  system.solve(dv, r);
  const double tolerance = 160 * kEps * scaled_condition(MatrixXd(A), MatrixXd(G));
  EXPECT_LT((G.transpose() * dv - u).norm(), tolerance * MatrixXd(G).norm() * dv.norm());
  EXPECT_LT((A * dv - G * r).norm(), tolerance * MatrixXd(A).norm() * dv.norm());
}

TEST(ConstrainedSystem, WithoutConstraintsIsTheTree) {
  const bench::LargeTree tree = bench::bush(30, 7);
  const SparseMatrix A = bench::iteration_matrix(tree), none(30, 0);
  ConstrainedSystem system(A, none);
  ASSERT_EQ(system.factorise(A, none).status, FactorStatus::regular);
  VectorXd dv = random_vector(30, 2), nothing(0);
  const VectorXd expected = MatrixXd(A).llt().solve(dv);
  system.solve(dv, nothing);
  const Scaled scaled = scaled_condition(A);
  EXPECT_LT(difference(dv, expected, scaled.scale), 300 * kEps * scaled.condition);
}

TEST(ConstrainedSystem, ReportsConstraintsThatRepeatEachOther) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const bench::LargeTree tree = bench::linkages(3, seed);
    const SparseMatrix A = bench::iteration_matrix(tree);
    MatrixXd G = bench::closure_directions(tree);
    G.conservativeResize(Eigen::NoChange, 7);
    G.col(6) = 0.3 * G.col(2) - 1.7 * G.col(3);
    const SparseMatrix repeated = sparse(G);
    ConstrainedSystem system(A, repeated);
    EXPECT_EQ(system.factorise(A, repeated).status, FactorStatus::singular) << seed;
    EXPECT_EQ(system.factorise(A, repeated).status, FactorStatus::singular) << seed;  // asked again
  }
}

TEST(ConstrainedSystem, ReportsConstraintsThatActOnNothing) {
  const bench::LargeTree tree = bench::linkages(2, 1);
  const SparseMatrix A = bench::iteration_matrix(tree);
  MatrixXd G = bench::closure_directions(tree);
  G.col(1).setZero();
  const SparseMatrix empty = sparse(G);  // no entry at all
  EXPECT_EQ(ConstrainedSystem(A, empty).factorise(A, empty).status, FactorStatus::singular);
  SparseMatrix zeros = bench::closure_directions(tree);  // entries of zero
  for (int p = zeros.outerIndexPtr()[1]; p < zeros.outerIndexPtr()[2]; ++p) zeros.valuePtr()[p] = 0;
  EXPECT_EQ(ConstrainedSystem(A, zeros).factorise(A, zeros).status, FactorStatus::singular);
}

TEST(ConstrainedSystem, ReportsMoreConstraintsThanCoordinates) {
  const SparseMatrix A = bench::iteration_matrix(bench::chain(3, 1));
  const SparseMatrix G = sparse(MatrixXd::Random(3, 4));
  EXPECT_EQ(ConstrainedSystem(A, G).factorise(A, G).status, FactorStatus::singular);
}

TEST(ConstrainedSystem, ChoosesPivotsAnewWhereTheKeptOnesAreLost) {
  // two slides of 1 kg, pinned to the ground by constraint 0 along one of them and moved by constraint 1 along both
  const SparseMatrix A = sparse(MatrixXd{{1, 0.5}, {0.5, 1}});
  const auto directions = [](double first, double second) {
    SparseMatrix G = sparse(MatrixXd{{1, 1}, {1, 1}});
    G.valuePtr()[0] = first;
    G.valuePtr()[1] = second;
    return G;
  };
  const SparseMatrix along_x = directions(1, 1e-10), along_y = directions(1e-10, 1);
  ConstrainedSystem system(A, along_x);
  int choices = 0;
  for (const SparseMatrix& G : {along_x, along_y, along_x}) {
    ASSERT_EQ(system.factorise(A, G).status, FactorStatus::regular);
    VectorXd dv{{0.3, -0.7}}, r{{0.0, 2.0}};
    system.solve(dv, r);
    // as many constraints as coordinates: they alone say how it moves; kept pivots of 1e-10 would leave 1e-6
    const VectorXd expected = MatrixXd(G).transpose().fullPivLu().solve(VectorXd{{0.0, 2.0}});
    EXPECT_LT((dv - expected).norm(), 100 * kEps);
    choices = std::max(choices, system.pivot_choices());
  }
  EXPECT_GT(choices, 1);
}

TEST(ConstrainedSystem, ReportsNumbersThatAreNoneAndAnotherPattern) {
  const bench::LargeTree tree = bench::linkages(2, 1);
  const SparseMatrix A = bench::iteration_matrix(tree), G = bench::closure_directions(tree);
  ConstrainedSystem system(A, G);
  SparseMatrix wrong = G;
  wrong.valuePtr()[3] = std::nan("");
  EXPECT_EQ(system.factorise(A, wrong).status, FactorStatus::not_finite);
  EXPECT_EQ(system.factorise(A, sparse(MatrixXd::Ones(7, 4))).status, FactorStatus::other_pattern);
  EXPECT_EQ(system.factorise(A, G).status, FactorStatus::regular);
}

// ---- what every step would do

TEST(SparseSystems, UseNoHeapOnceAnalysed) {
  const bench::LargeTree tree = bench::bush(200, 3), closed = bench::linkages(20, 3);
  const SparseMatrix A = bench::iteration_matrix(tree), H = bench::row_directions(tree);
  const SparseMatrix K = bench::iteration_matrix(closed), G = bench::closure_directions(closed);
  DefiniteSystem system(A);
  Delassus delassus(system.factor(), H);
  ConstrainedSystem constrained(K, G);
  constrained.factorise(K, G);  // chooses pivots, on the heap
  VectorXd b = random_vector(200, 1), c = random_vector(61, 1), u = random_vector(40, 1);
  const long before = heap_calls;
  const FactorStatus definite = system.factorise(A).status;
  system.solve(b);
  delassus.update(system.factor(), H);
  const FactorStatus kept = constrained.factorise(K, G).status;
  constrained.solve(c, u);
  const long calls = heap_calls - before;
  EXPECT_EQ(calls, 0);
  EXPECT_EQ(definite, FactorStatus::regular);
  EXPECT_EQ(kept, FactorStatus::regular);
  EXPECT_EQ(constrained.pivot_choices(), 1);
}

TEST(SparseSystems, LoadNothingOfSuiteSparseThatIsUnderGpl) {
  std::string libraries;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* all) {
        *static_cast<std::string*>(all) += std::string(info->dlpi_name) + "\n";
        return 0;
      },
      &libraries);
  EXPECT_NE(libraries.find("libklu"), std::string::npos) << libraries;
  for (const char* name : {"libcholmod", "libumfpack", "libspqr"})
    EXPECT_EQ(libraries.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace erard
