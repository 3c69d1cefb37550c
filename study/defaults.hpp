// The action and the keystrokes that come with the project.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/device/keystroke.hpp"

namespace erard::study {

inline std::filesystem::path default_action_file() { return config_dir() / "grand_action.yaml"; }
inline ActionFile default_action(const ActionOptions& options = {}) {
  return load_action(default_action_file(), options);
}

/// config/keystrokes/NAME.csv.
inline Keystroke default_keystroke(const std::string& name) {
  return read_keystroke(config_dir() / "keystrokes" / (name + ".csv"));
}

/// A number of the action by its name in the file. Throws std::invalid_argument when it has none of that name.
inline double parameter(const ActionFile& action, const std::string& name) {
  for (const Parameter& p : action.parameters)
    if (p.name == name) return p.value;
  throw std::invalid_argument("the action has no parameter " + name);
}

}  // namespace erard::study
