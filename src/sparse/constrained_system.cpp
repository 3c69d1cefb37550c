#include "erard/sparse/constrained_system.hpp"

#include <klu.h>

#include <cmath>
#include <new>
#include <stdexcept>

#include "pattern.hpp"

namespace erard {

struct ConstrainedSystem::Parts {
  int n = 0, c = 0;
  std::vector<int> a_start, a_row, g_start, g_row;  // patterns of A and G
  std::vector<int> start, row;                      // pattern of the whole, by columns
  std::vector<double> value;                        // scaled
  std::vector<int> a_place, g_place, gt_place;      // where entries of A, G and G^T stand in it
  std::vector<int> diagonal;                        // where A's diagonal stands in A (n), -1: nowhere
  std::vector<double> scale;                        // (n + c)
  std::vector<double> load;                         // scratch of solve() (n + c)
  klu_common common{};
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
  int pivot_choices = 0;

  ~Parts() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  void arrange();
  bool set_values(const double* A, const double* G) noexcept;
  FactorReport report() noexcept;
};

/// The whole matrix by columns: A above G^T, then G.
void ConstrainedSystem::Parts::arrange() {
  const auto total = static_cast<std::size_t>(n + c);
  a_place.resize(a_row.size());
  g_place.resize(g_row.size());
  gt_place.resize(g_row.size());
  diagonal.assign(static_cast<std::size_t>(n), -1);
  start.assign(total + 1, 0);
  std::vector<int> count(total, 0);
  for (int j = 0; j < n; ++j) count[j] = a_start[j + 1] - a_start[j];
  for (const int i : g_row) ++count[i];
  for (int j = 0; j < c; ++j) count[n + j] = g_start[j + 1] - g_start[j];
  for (std::size_t j = 0; j < total; ++j) start[j + 1] = start[j] + count[j];
  row.resize(static_cast<std::size_t>(start.back()));
  value.resize(row.size());

  std::vector<int> next(start.begin(), start.end() - 1);
  const auto put = [&](int i, int j) { return row[next[j]] = i, next[j]++; };
  for (int j = 0; j < n; ++j)
    for (int p = a_start[j]; p < a_start[j + 1]; ++p) {
      a_place[p] = put(a_row[p], j);
      if (a_row[p] == j) diagonal[j] = p;
    }
  for (int j = 0; j < c; ++j)
    for (int p = g_start[j]; p < g_start[j + 1]; ++p) {
      gt_place[p] = put(n + j, g_row[p]);
      g_place[p] = put(g_row[p], n + j);
    }
}

/// @return whether all is finite
bool ConstrainedSystem::Parts::set_values(const double* A, const double* G) noexcept {
  for (int i = 0; i < n; ++i) {
    const double own = diagonal[i] < 0 ? 0.0 : std::abs(A[diagonal[i]]);
    scale[i] = own > 0 ? 1 / std::sqrt(own) : 1.0;
  }
  for (int j = 0; j < c; ++j) {
    double square = 0;
    for (int p = g_start[j]; p < g_start[j + 1]; ++p) square += std::pow(scale[g_row[p]] * G[p], 2);
    scale[n + j] = square > 0 ? 1 / std::sqrt(square) : 1.0;
  }
  double sum = 0;
  for (int j = 0; j < n; ++j)
    for (int p = a_start[j]; p < a_start[j + 1]; ++p)
      sum += std::abs(value[a_place[p]] = scale[j] * scale[a_row[p]] * A[p]);
  for (int j = 0; j < c; ++j)
    for (int p = g_start[j]; p < g_start[j + 1]; ++p)
      sum += std::abs(value[g_place[p]] = value[gt_place[p]] = scale[n + j] * scale[g_row[p]] * G[p]);
  return std::isfinite(sum);
}

/// The smallest pivot by the largest, and whose it is.
FactorReport ConstrainedSystem::Parts::report() noexcept {
  if (numeric == nullptr || common.status != KLU_OK)
    return {FactorStatus::singular, 0, common.singular_col < n + c ? common.singular_col : -1};
  const auto* pivot = static_cast<const double*>(numeric->Udiag);
  double largest = 0, smallest = std::numeric_limits<double>::infinity();
  int at = 0;
  for (int k = 0; k < n + c; ++k) {
    const double size = std::abs(pivot[k]);
    if (!std::isfinite(size)) return {FactorStatus::not_finite, 0, symbolic->Q[k]};
    largest = std::max(largest, size);
    if (size < smallest) {
      smallest = size;
      at = k;
    }
  }
  const double part = smallest / largest;
  return {part < least_regular_pivot(n + c) ? FactorStatus::singular : FactorStatus::regular, part, symbolic->Q[at]};
}

ConstrainedSystem::ConstrainedSystem(const SparseMatrix& A, const SparseMatrix& G) : parts_(std::make_unique<Parts>()) {
  require_square_pattern(A);
  if (G.rows() != A.rows() || !G.isCompressed())
    throw std::invalid_argument("ConstrainedSystem: G must have a row for each coordinate and be compressed");
  Parts& own = *parts_;
  own.n = static_cast<int>(A.rows());
  own.c = static_cast<int>(G.cols());
  own.a_start.assign(A.outerIndexPtr(), A.outerIndexPtr() + own.n + 1);
  own.a_row.assign(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros());
  own.g_start.assign(G.outerIndexPtr(), G.outerIndexPtr() + own.c + 1);
  own.g_row.assign(G.innerIndexPtr(), G.innerIndexPtr() + G.nonZeros());
  own.scale.resize(static_cast<std::size_t>(own.n + own.c));
  own.load.resize(static_cast<std::size_t>(own.n + own.c));
  own.arrange();
  klu_defaults(&own.common);
  own.common.scale = 0;  // scaled by ourselves, on both sides
  own.symbolic = klu_analyze(own.n + own.c, own.start.data(), own.row.data(), &own.common);
  if (own.symbolic == nullptr) throw std::bad_alloc();  // what else it can refuse was looked at above
}

ConstrainedSystem::~ConstrainedSystem() = default;
ConstrainedSystem::ConstrainedSystem(ConstrainedSystem&&) noexcept = default;
ConstrainedSystem& ConstrainedSystem::operator=(ConstrainedSystem&&) noexcept = default;

FactorReport ConstrainedSystem::factorise(const SparseMatrix& A, const SparseMatrix& G) noexcept {
  constexpr double kLeastGrowth = 1e-3;  // largest entry by largest of U, columnwise: three digits are let go
  Parts& own = *parts_;
  if (!is_pattern(A, own.a_start, own.a_row) || G.rows() != own.n || G.cols() != own.c || !G.isCompressed() ||
      !std::equal(own.g_start.begin(), own.g_start.end(), G.outerIndexPtr()) ||
      !std::equal(own.g_row.begin(), own.g_row.end(), G.innerIndexPtr()))
    return {};
  if (!own.set_values(A.valuePtr(), G.valuePtr())) return {FactorStatus::not_finite, 0, -1};
  int* start = own.start.data();
  int* row = own.row.data();
  double* value = own.value.data();
  if (own.numeric != nullptr && klu_refactor(start, row, value, own.symbolic, own.numeric, &own.common) == 1) {
    const FactorReport report = own.report();
    if (report.status == FactorStatus::regular &&
        klu_rgrowth(start, row, value, own.symbolic, own.numeric, &own.common) == 1 &&
        own.common.rgrowth > kLeastGrowth)
      return report;
  }
  klu_free_numeric(&own.numeric, &own.common);
  own.numeric = klu_factor(start, row, value, own.symbolic, &own.common);
  ++own.pivot_choices;
  const FactorReport report = own.report();
  if (report.status != FactorStatus::regular) klu_free_numeric(&own.numeric, &own.common);
  return report;
}

void ConstrainedSystem::solve(Eigen::Ref<Eigen::VectorXd> b, Eigen::Ref<Eigen::VectorXd> u) noexcept {
  Parts& own = *parts_;
  for (int i = 0; i < own.n; ++i) own.load[i] = own.scale[i] * b[i];
  for (int j = 0; j < own.c; ++j) own.load[own.n + j] = own.scale[own.n + j] * u[j];
  klu_solve(own.symbolic, own.numeric, own.n + own.c, 1, own.load.data(), &own.common);
  for (int i = 0; i < own.n; ++i) b[i] = own.scale[i] * own.load[i];
  for (int j = 0; j < own.c; ++j) u[j] = -own.scale[own.n + j] * own.load[own.n + j];
}

int ConstrainedSystem::coordinates() const noexcept { return parts_->n; }
int ConstrainedSystem::constraints() const noexcept { return parts_->c; }
int ConstrainedSystem::factor_entries() const noexcept {
  return parts_->numeric == nullptr ? 0 : parts_->numeric->lnz + parts_->numeric->unz + parts_->numeric->nzoff;
}
int ConstrainedSystem::pivot_choices() const noexcept { return parts_->pivot_choices; }

}  // namespace erard
