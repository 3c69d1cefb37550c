#include "step.hpp"

namespace erard::lanes {

const Kernel& kernel_baseline() noexcept {
  static constexpr Kernel kernel = kernel_of<xsimd::batch<double, xsimd::sse2>>();
  return kernel;
}

}  // namespace erard::lanes
