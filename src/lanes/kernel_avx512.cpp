#include "step.hpp"

namespace erard::lanes {

const Kernel& kernel_avx512() noexcept {
  static constexpr Kernel kernel = kernel_of<xsimd::batch<double, xsimd::avx512f>>();
  return kernel;
}

}  // namespace erard::lanes
