#include "step.hpp"

namespace erard::lanes {

const Kernel& kernel_avx2() noexcept {
  static constexpr Kernel kernel = kernel_of<xsimd::batch<double, xsimd::fma3<xsimd::avx2>>>();
  return kernel;
}

}  // namespace erard::lanes
