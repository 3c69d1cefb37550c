// Keystrokes over and over on many keys, sampled as a host samples them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "strokes.hpp"

namespace erard::test {

/// What the finger of one key does: nothing, or a stroke every `every` seconds, held where it is at `hold`.
struct Part {
  const Keystroke* keystroke = nullptr;
  double delay = 0;  // [s]
  double every = 1;  // [s]
  double hold = 10;  // [s] after the start of the stroke

  DriveSample at(double time) const noexcept {
    if (keystroke == nullptr || time < delay) return {};
    const double since = std::fmod(time - delay, every);
    const Sample sample = keystroke->at(std::min(since, hold));
    return {sample.value, since < hold ? sample.rate : 0};
  }
};

/// Input of each key at the end of the period that begins now.
inline void sample(const std::vector<Part>& parts, const Keyboard& keyboard, std::vector<DriveSample>& inputs) {
  inputs.resize(parts.size());
  const double end = keyboard.time() + keyboard.settings().period;
  for (std::size_t k = 0; k < parts.size(); ++k) inputs[k] = parts[k].at(end);
}

}  // namespace erard::test
