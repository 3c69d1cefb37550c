// Keys in the lanes of vector registers, where this build has them (erard::lanes).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "erard/haptics/keyboard.hpp"

namespace erard::bench {

/// Who advances a keyboard in lanes.
class Lanes {
 public:
  virtual ~Lanes() = default;
  virtual void tick(std::span<const DriveSample> inputs) noexcept = 0;
};

/// What this CPU has, the least first, of "sse2", "avx2", "avx512"; empty when this build has no lanes.
std::vector<std::string> lane_names();

/// @param name  one of lane_names()
std::unique_ptr<Lanes> make_lanes(Keyboard& keyboard, const std::string& name);

}  // namespace erard::bench
