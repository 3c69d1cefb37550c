// A number as the thesis prints it beside what its own definition gives.
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace erard::study {

struct Recomputed {
  std::string quantity;
  double printed = 0;
  double computed = 0;
  std::string why;  // of a difference

  /// computed / printed - 1; 0 where both are infinite.
  double difference() const noexcept { return printed == computed ? 0 : computed / printed - 1; }

  /// A printed number counts as contradicted from 2 % on.
  bool is_contradicted() const noexcept { return std::abs(difference()) > 0.02; }
};

}  // namespace erard::study
