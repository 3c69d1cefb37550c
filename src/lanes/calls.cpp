#include "calls.hpp"

#include "erard/mechanics/felt_law.hpp"
#include "erard/mechanics/frames.hpp"

namespace erard::lanes {
namespace {

double power(double base, double exponent) noexcept { return std::pow(base, exponent); }

void turn(double angle, double* cosine, double* sine) noexcept {
  const Vector2 axis = unit_vector(angle);
  *cosine = axis.x();
  *sine = axis.y();
}

double relax(double time, double stiffness, double exponent, double damping, double compression) noexcept {
  Felt felt;
  felt.stiffness = stiffness;
  felt.exponent = exponent;
  felt.damping = damping;
  return relaxed_compression(felt, compression, time);
}

}  // namespace

const Calls& calls() noexcept {
  static const Calls calls{&tables(), power, turn, relax};
  return calls;
}

}  // namespace erard::lanes
