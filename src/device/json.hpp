// The little JSON that the report needs. Safe inside <script>: no '<' leaves this file.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

#include "erard/model/body.hpp"

namespace erard::json {

/// A quoted string. '<', '>' and '&' become \u escapes, so that no text can end a script element or open a comment;
/// bytes that are not UTF-8 are left to the browser, which shows a replacement sign.
inline std::string text(std::string_view raw) {
  std::string out = "\"";
  for (const char c : raw) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || c == '<' || c == '>' || c == '&') {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(code));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

/// A number, or null where JSON has none.
inline std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.9g}", value) : "null"; }

inline std::string flag(bool value) { return value ? "true" : "false"; }

inline std::string pair(const Vector2& v) { return fmt::format("[{:.6g},{:.6g}]", v.x(), v.y()); }

/// "[a,b,c]" from value_of(i) of each element.
template <typename List, typename ValueOf>
std::string list(const List& elements, ValueOf&& value_of) {
  std::string out = "[";
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (i > 0) out += ',';
    out += value_of(elements[i]);
  }
  return out + "]";
}

/// Base64, RFC 4648.
inline std::string base64(const unsigned char* data, std::size_t size) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t left = size - i;
    const unsigned triple = static_cast<unsigned>(data[i]) << 16U |
                            (left > 1 ? static_cast<unsigned>(data[i + 1]) << 8U : 0U) |
                            (left > 2 ? static_cast<unsigned>(data[i + 2]) : 0U);
    out += kDigits[triple >> 18U & 63U];
    out += kDigits[triple >> 12U & 63U];
    out += left > 1 ? kDigits[triple >> 6U & 63U] : '=';
    out += left > 2 ? kDigits[triple & 63U] : '=';
  }
  return out;
}

}  // namespace erard::json
