// A file of settings as text, so that a recording can carry the settings it was made with.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "erard/device/error.hpp"

namespace erard {

struct ConfigText {
  std::string name;  // what complaints call it: its path
  std::string text;
};

/// Reads a YAML file of at most 4 MiB. @param what  is expected, with its article: "an action file"
/// Throws InputError with the place when it cannot be read or is no text.
ConfigText read_config(const std::filesystem::path& file, std::string_view what);

}  // namespace erard
