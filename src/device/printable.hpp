// Text from outside, safe to quote in a one-line message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace erard {

/// Control characters become '?', long texts are cut.
inline std::string printable(std::string_view text, std::size_t longest = 60) {
  std::string safe(text.substr(0, longest));
  for (char& c : safe)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text.size() > longest ? safe + "..." : safe;
}

}  // namespace erard
