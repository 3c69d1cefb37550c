// A YAML file as a whole, before anybody looks for keys in it.
#pragma once

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "erard/device/error.hpp"
#include "printable.hpp"

namespace erard {

inline constexpr std::size_t kMaxYamlBytes = 4u
                                             << 20;  // a hundred times the grand action; a pipe without end stops here

/// Text of one YAML document. @param what  is expected, with its article: "an action file"
inline std::string read_yaml_text(const std::filesystem::path& path, std::string_view what) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(fmt::format("{}: is a folder, must be {} (YAML)", path.string(), what));
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
  std::string text(kMaxYamlBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxYamlBytes)
    throw InputError(fmt::format("{}: does not end, must be at most {} MiB", path.string(), kMaxYamlBytes >> 20));
  int line = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (c == '\n' && text.compare(i + 1, 3, "---") == 0)
      throw InputError(fmt::format("{}:{}: a second YAML document begins, must hold one", path.string(), line));
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t')
      throw InputError(fmt::format("{}:{}: byte 0x{:02x} is not text, must be {} (YAML)", path.string(), line,
                                   static_cast<unsigned char>(c), what));
  }
  return text;
}

/// Root of the document. Throws InputError "file:line: ..." when there is none.
inline YAML::Node load_yaml(const std::filesystem::path& path, std::string_view what) {
  try {
    return YAML::Load(read_yaml_text(path, what));
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: is not valid YAML ({}), was the file cut short?", path.string(),
                                 error.mark.line + 1, printable(error.msg)));
  }
}

}  // namespace erard
