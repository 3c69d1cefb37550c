// config/device.yaml: how a device is rendered, how the host runs, where its messages come and go.
#pragma once

#include <filesystem>
#include <string>

#include "erard/device/config_text.hpp"
#include "erard/haptics/renderer.hpp"

namespace erard {

inline constexpr double kSlowestRate = 400, kFastestRate = 50000;  // [Hz] design range of the scheme

/// How the host's thread runs.
struct RealTimeSettings {
  int priority = 80;   // SCHED_FIFO, 1 .. 99; 0: ordinary scheduling
  int cpu = -1;        // the thread is bound to; -1: any
  int phase_us = 150;  // from the device's sample to the start of the host's period
};

/// Where messages come from and go to.
struct LinkSettings {
  std::string positions_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string forces_url = "udpm://239.255.76.68:7668?ttl=0";
  std::string positions_channel = "ERARD_POSITIONS";
  std::string forces_channel = "ERARD_FORCES";
};

struct DeviceSettings {
  RenderSettings rendering;
  RealTimeSettings real_time;
  LinkSettings link;
};

/// Reads config/device.yaml or another file of that form; docs/device.md has the keys.
/// Strict: every key is there once, every value within its rule; keys that are not known are refused.
/// Throws InputError with one sentence "file:line: key = value, rule".
DeviceSettings load_device(const std::filesystem::path& file);
DeviceSettings load_device(const ConfigText& config);

}  // namespace erard
