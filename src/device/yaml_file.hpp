// A YAML file as a whole, before anybody looks for keys in it.
#pragma once

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "erard/device/config_text.hpp"
#include "printable.hpp"

namespace erard {

/// Root of the document. Throws InputError "file:line: ..." when there is none.
inline YAML::Node parse_yaml(const ConfigText& config) {
  try {
    return YAML::Load(config.text);
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: is not valid YAML ({}), was the file cut short?", config.name,
                                 error.mark.line + 1, printable(error.msg)));
  }
}

}  // namespace erard
