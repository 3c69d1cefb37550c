// Bad input, told in one sentence.
#pragma once

#include <stdexcept>
#include <string>

namespace erard {

/// What a user gave cannot be used. what() is one sentence with file, line, key, value and the rule, for instance
///   config/action.yaml:41: m_H = -0.01 kg, must be > 0
/// Programs print it to stderr and leave with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace erard
