#include "erard/device/config_text.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace erard {
namespace {

constexpr std::size_t kMaxYamlBytes = 4u << 20;  // a hundred times the grand action; a pipe without end stops here

}  // namespace

ConfigText read_config(const std::filesystem::path& path, std::string_view what) {
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
  return {path.string(), std::move(text)};
}

}  // namespace erard
