// A short name that lives in place, so that models can be copied and shared without a heap.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace erard {

/// A thesis name such as "KS+" or "W_Jx"; longer texts are cut to kCapacity characters.
class Name {
 public:
  static constexpr std::size_t kCapacity = 15;

  constexpr Name() noexcept = default;
  constexpr Name(std::string_view text) noexcept {  // NOLINT: names are written as literals everywhere
    for (std::size_t i = 0; i < text.size() && i < kCapacity; ++i) text_[i] = text[i];
  }
  constexpr Name(const char* text) noexcept : Name(std::string_view(text)) {}

  constexpr std::string_view view() const noexcept { return std::string_view(text_.data()); }
  constexpr bool operator==(const Name& other) const noexcept { return text_ == other.text_; }

 private:
  std::array<char, kCapacity + 1> text_{};
};

}  // namespace erard
