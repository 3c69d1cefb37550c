#include "study/coupling_loop.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numbers>
#include <stdexcept>

namespace erard::study {
namespace {

using Complex = std::complex<double>;
using Matrix = Eigen::MatrixXd;

/// exp(A), by the series of A / 2^k, squared k times.
Matrix exponential(Matrix A) {
  int squarings = 0;
  while (A.cwiseAbs().rowwise().sum().maxCoeff() > 0.25) A /= 2, ++squarings;
  Matrix sum = Matrix::Identity(A.rows(), A.cols()), term = sum;
  for (int i = 1; i <= 14; ++i) {  // 0.25^15 / 15! = 1e-21
    term = term * A / i;
    sum += term;
  }
  for (int i = 0; i < squarings; ++i) sum = sum * sum;
  return sum;
}

/// Lever and actuator from one command to the next: x = (y, y', f), x+ = A x + B u.
struct Plant {
  Eigen::Matrix3d A;
  Eigen::Vector3d B;
};
Plant plant_of(const LoopCase& loop, double period) {
  constexpr double kAtOnce = 1e-6;  // [s] a lag that is none; 1/500 of a period
  const double tau = std::max(loop.actuator_lag, kAtOnce), m = loop.lever_mass;
  Matrix rate = Matrix::Zero(4, 4);
  rate(0, 1) = 1;
  rate.row(1) << -loop.finger.stiffness / m, -(loop.finger.damping + loop.lever_viscous) / m, -1 / m, 0;
  rate.row(2) << 0, 0, -1 / tau, 1 / tau;
  const Matrix all = exponential(rate * period);
  return {all.topLeftCorner<3, 3>(), all.topRightCorner<3, 1>()};
}

/// Piston after an impulse on the position, or on the command, at time 0: a sample a period.
std::vector<DriveSample> impulse_answer(PistonEstimator estimator, double position, double command) {
  constexpr std::size_t kLongest = 1000, kQuiet = 64;  // as long as the longest window
  constexpr double kOver = 1e-12;                      // of the largest
  estimator.reset(0);
  std::vector<DriveSample> answer;
  double largest_value = 0, largest_rate = 0;
  for (std::size_t quiet = 0; quiet < kQuiet;) {
    if (answer.size() > kLongest) throw std::invalid_argument("an estimator whose answer to an impulse does not end");
    const bool is_first = answer.empty();
    answer.push_back(estimator.update(is_first ? position : 0));
    estimator.sent(is_first ? command : 0);
    const double value = std::abs(answer.back().value), rate = std::abs(answer.back().rate);
    largest_value = std::max(largest_value, value);
    largest_rate = std::max(largest_rate, rate);
    quiet = value <= kOver * largest_value && rate <= kOver * largest_rate ? quiet + 1 : 0;
  }
  answer.resize(answer.size() - kQuiet);
  return answer;
}

/// Angles round half of the unit circle: a decade of them in 400, which goes round a resonance of 1 % damping in eight.
std::vector<double> angles() {
  constexpr double kFirst = 1e-4;  // [rad] 0.03 Hz at 2 kHz, below all that swings here
  constexpr int kDecade = 400;
  std::vector<double> angles;
  const int count = static_cast<int>(kDecade * std::log10(std::numbers::pi / kFirst));
  for (int i = 0; i < count; ++i) angles.push_back(kFirst * std::pow(10, static_cast<double>(i) / kDecade));
  angles.push_back(std::numbers::pi);
  return angles;
}

}  // namespace

CouplingLoop::CouplingLoop(const LoopCase& loop, double period, const PistonEstimator& estimator)
    : virtual_mass_(loop.virtual_mass) {
  const Plant plant = plant_of(loop, period);
  const std::vector<DriveSample> of_sample = impulse_answer(estimator, 1, 0),
                                 of_command = impulse_answer(estimator, 0, 1);
  for (const double angle : angles()) {
    const Complex z = std::polar(1.0, angle);
    const Eigen::Matrix3cd resolvent = z * Eigen::Matrix3cd::Identity() - plant.A.cast<Complex>();
    const Complex push = resolvent.partialPivLu().solve(plant.B.cast<Complex>())[0];  // -P
    points_.push_back({angle, -push * std::pow(z, -loop.delay_periods), answer_at(of_sample, z),
                       answer_at(of_command, z), Complex(0, angle / period)});
  }
}

CouplingLoop::Answer CouplingLoop::answer_at(const std::vector<DriveSample>& impulse, Complex z) {
  Answer sum;
  Complex power = 1;
  const Complex earlier = 1.0 / z;
  for (const DriveSample& sample : impulse) {
    sum.value += sample.value * power;
    sum.rate += sample.rate * power;
    power *= earlier;
  }
  return sum;
}

Complex CouplingLoop::command(const Point& point, const Answer& piston, const Coupling& coupling) const {
  const Complex rigid = coupling.stiffness * piston.value + coupling.damping * piston.rate;
  if (std::isinf(virtual_mass_)) return rigid;
  const Complex inertia = virtual_mass_ * point.s * point.s;
  return rigid * inertia / (inertia + coupling.damping * point.s + coupling.stiffness);
}

double CouplingLoop::gain_margin(const Coupling& coupling, double most) const {
  double least = most, gone_round = 0;
  Complex sum_before, ratio_before;
  for (const Point& point : points_) {
    const Complex rest = 1.0 - command(point, point.of_command, coupling);
    const Complex A = command(point, point.of_sample, coupling) * point.plant;
    const Complex sum = rest + A, ratio = A / rest;
    const bool is_first = &point == &points_.front();
    gone_round += std::arg(is_first ? sum : sum / sum_before);
    if (!is_first && ratio_before.imag() * ratio.imag() <= 0 && ratio_before.imag() != ratio.imag()) {
      const double part = ratio_before.imag() / (ratio_before.imag() - ratio.imag());
      const double factor = -1 / (ratio_before.real() + part * (ratio.real() - ratio_before.real()));
      if (factor > 0) least = std::min(least, std::max(factor, 1 / factor));
    }
    sum_before = sum;
    ratio_before = ratio;
  }
  const bool is_stable = std::abs(gone_round) < std::numbers::pi / 2;  // it ends real: at a multiple of pi
  return is_stable ? least : 0;
}

CouplingLoop::Band CouplingLoop::stable_damping(double stiffness) const {
  constexpr double kFirst = 0.1, kLast = 2000, kRatio = 1.01;  // [N s/m], [N s/m], [-]
  Band band;
  for (double b = kFirst; b < kLast; b *= kRatio) {
    const bool is_stable_here = is_stable({stiffness, b});
    if (!is_stable_here && band.largest > 0) break;
    if (!is_stable_here) continue;
    if (band.least == 0) band.least = b;
    band.largest = b;
  }
  return band;
}

double CouplingLoop::noise_gain(const Coupling& coupling) const {
  if (!is_stable(coupling)) return HUGE_VAL;
  const auto density = [&](const Point& point) {
    const Complex Ky = command(point, point.of_sample, coupling), Ku = command(point, point.of_command, coupling);
    return std::norm(Ky / (1.0 + Ky * point.plant - Ku));
  };
  double integral = points_.front().angle * density(points_.front());
  for (std::size_t i = 1; i < points_.size(); ++i)
    integral += (points_[i].angle - points_[i - 1].angle) * (density(points_[i]) + density(points_[i - 1])) / 2;
  return std::sqrt(integral / std::numbers::pi);
}

}  // namespace erard::study
