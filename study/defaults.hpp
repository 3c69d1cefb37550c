// The action and the keystrokes that come with the project.
#pragma once

#include <string>

#include "erard/device/action_file.hpp"
#include "erard/device/config_dir.hpp"
#include "erard/device/keystroke.hpp"

namespace erard::study {

/// config/grand_action.yaml.
inline ActionFile default_action(const ActionOptions& options = {}) {
  return load_action(config_dir() / "grand_action.yaml", options);
}

/// config/keystrokes/NAME.csv.
inline Keystroke default_keystroke(const std::string& name) {
  return read_keystroke(config_dir() / "keystrokes" / (name + ".csv"));
}

}  // namespace erard::study
