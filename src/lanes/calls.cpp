#include "calls.hpp"

#include "erard/mechanics/felt_law.hpp"
#include "erard/mechanics/frames.hpp"

namespace erard::lanes {
namespace {

void turn(int count, int lanes, const bool* is_wanted, const double* angle, double* cosine, double* sine) noexcept {
  for (int l = 0; l < lanes; ++l) {
    if (!is_wanted[l]) continue;
    for (int i = l; i < count * lanes; i += lanes) {
      const Vector2 axis = unit_vector(angle[i]);
      cosine[i] = axis.x();
      sine[i] = axis.y();
    }
  }
}

void power(int count, const double* base, const double* exponent, double* result) noexcept {
  for (int i = 0; i < count; ++i) result[i] = base[i] > 0 ? std::pow(base[i], exponent[i]) : 0.0;
}

void relax(int count, double time, const double* stiffness, const double* exponent, const double* damping,
           const double* compression, double* left) noexcept {
  for (int i = 0; i < count; ++i) {
    left[i] = 0;
    if (!(compression[i] > 0)) continue;
    Felt felt;
    felt.stiffness = stiffness[i];
    felt.exponent = exponent[i];
    felt.damping = damping[i];
    left[i] = relaxed_compression(felt, compression[i], time);
  }
}

}  // namespace

const Calls kCalls{turn, power, relax};

}  // namespace erard::lanes
