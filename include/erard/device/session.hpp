// What it takes to repeat a session of the host: its settings and its action, as text.
#pragma once

#include <optional>
#include <string>

#include "erard/device/action_file.hpp"
#include "erard/device/device_file.hpp"

namespace erard {

/// What a command line may change of the device file.
struct DeviceOverrides {
  std::optional<int> keys;              // 1 .. 88
  std::optional<double> rate_Hz;        // 400 .. 50000
  std::optional<std::string> drive;     // piston, key
  std::optional<std::string> actuator;  // voice-coil, mr, none
};

struct Session {
  ConfigText device, action;
  DeviceOverrides overrides;
  bool damper = true;
};

/// The session, ready to run.
struct SessionParts {
  DeviceSettings settings;
  ActionFile action;
};

/// Throws InputError with the place, file or option, and the rule.
SessionParts load_session(const Session& session);
DeviceSettings load_device(const Session& session);  // the settings alone

/// As YAML: the version of erard, what was set, both files whole.
std::string to_text(const Session& session);

/// Throws InputError when the text is no session. @param file  that it came from, for the message
Session session_from_text(const std::string& text, const std::string& file);

}  // namespace erard
