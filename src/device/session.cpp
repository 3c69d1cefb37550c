#include "erard/device/session.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "erard/version.hpp"

namespace erard {
namespace {

DriveKind drive_of(const std::string& name) {
  if (name == "piston") return DriveKind::piston;
  if (name == "key") return DriveKind::key;
  throw InputError(fmt::format("--drive {}: is not known, must be piston or key", name));
}

ActuatorKind actuator_of(const std::string& name) {
  if (name == "voice-coil") return ActuatorKind::voice_coil;
  if (name == "mr") return ActuatorKind::mr_brake;
  if (name == "none") return ActuatorKind::none;
  throw InputError(fmt::format("--actuator {}: is not known, must be voice-coil, mr or none", name));
}

template <typename T>
std::optional<T> optional_value(const YAML::Node& node) {
  return node ? std::optional<T>(node.as<T>()) : std::nullopt;
}

}  // namespace

DeviceSettings load_device(const Session& session) {
  const DeviceOverrides& set = session.overrides;
  DeviceSettings settings = load_device(session.device);
  RenderSettings& rendering = settings.rendering;
  if (set.keys) {
    if (*set.keys < 1 || *set.keys > Renderer::kMaxKeys)
      throw InputError(fmt::format("--keys = {}, must be 1 to {}", *set.keys, Renderer::kMaxKeys));
    rendering.keys = *set.keys;
  }
  if (set.drive) rendering.tick.drive = drive_of(*set.drive);
  if (set.rate_Hz) {
    if (!(*set.rate_Hz >= kSlowestRate && *set.rate_Hz <= kFastestRate))
      throw InputError(fmt::format("--rate = {}, must be {} to {} Hz", *set.rate_Hz, kSlowestRate, kFastestRate));
    rendering.tick.set_rate(*set.rate_Hz);
  }
  if (set.actuator) rendering.actuator.kind = actuator_of(*set.actuator);
  return settings;
}

SessionParts load_session(const Session& session) {
  SessionParts parts{load_device(session), {}};
  ActionOptions options;
  options.damper = session.damper;
  parts.action = load_action(session.action, options);
  if (parts.action.model.finger.body == kGround)
    throw InputError(fmt::format("{}: has no finger, must have one to be played", session.action.name));
  return parts;
}

std::string to_text(const Session& session) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "erard" << YAML::Value << std::string(kVersion);
  const auto put = [&out](const char* key, const auto& value) {
    if (value) out << YAML::Key << key << YAML::Value << *value;
  };
  put("keys", session.overrides.keys);
  if (session.overrides.rate_Hz)
    out << YAML::Key << "rate_Hz" << YAML::Value << fmt::format("{}", *session.overrides.rate_Hz);  // to the last bit
  put("drive", session.overrides.drive);
  put("actuator", session.overrides.actuator);
  out << YAML::Key << "damper" << YAML::Value << session.damper;
  for (const auto& [key, file] : {std::pair{"device", &session.device}, {"action", &session.action}})
    out << YAML::Key << key << YAML::Value << YAML::BeginMap << YAML::Key << "name" << YAML::Value << file->name
        << YAML::Key << "text" << YAML::Value << YAML::DoubleQuoted << file->text << YAML::EndMap;
  out << YAML::EndMap;
  return out.c_str();
}

Session session_from_text(const std::string& text, const std::string& file) {
  try {
    const YAML::Node root = YAML::Load(text);
    const auto version = root["erard"].as<std::string>();
    if (version != kVersion)
      throw InputError(fmt::format("{}: was recorded by erard {}, must be by {}: another version computes other bits",
                                   file, version, kVersion));
    const auto config = [&root](const char* key) {
      return ConfigText{root[key]["name"].as<std::string>(), root[key]["text"].as<std::string>()};
    };
    return {config("device"),
            config("action"),
            {optional_value<int>(root["keys"]), optional_value<double>(root["rate_Hz"]),
             optional_value<std::string>(root["drive"]), optional_value<std::string>(root["actuator"])},
            root["damper"].as<bool>()};
  } catch (const YAML::Exception&) {
    throw InputError(
        fmt::format("{}: does not begin with the settings of a session, must be a recording of erard-device", file));
  }
}

}  // namespace erard
