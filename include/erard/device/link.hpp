// The link between device, host and viewers: LCM messages, where they go, under what names. docs/lcm.md has the rest.
#pragma once

#include "erard/actuator_commands_t.hpp"
#include "erard/action_state_t.hpp"
#include "erard/device/receiver.hpp"
#include "erard/device/sender.hpp"
#include "erard/forces_t.hpp"
#include "erard/hammer_event_t.hpp"
#include "erard/host_status_t.hpp"
#include "erard/positions_t.hpp"

namespace erard {

/// What the device sends, and what the host sends: two groups, so that nobody is woken by what he sent himself.
inline constexpr const char* kDeviceUrl = "udpm://239.255.76.67:7667?ttl=0";
inline constexpr const char* kHostUrl = "udpm://239.255.76.68:7668?ttl=0";

// on the device's address
inline constexpr const char* kPositionsChannel = "ERARD_POSITIONS";  // positions_t
// on the host's address
inline constexpr const char* kForcesChannel = "ERARD_FORCES";               // forces_t
inline constexpr const char* kActuatorChannel = "ERARD_ACTUATOR_COMMANDS";  // actuator_commands_t
inline constexpr const char* kStatusChannel = "ERARD_HOST_STATUS";          // host_status_t
inline constexpr const char* kHammerChannel = "ERARD_HAMMER_EVENTS";        // hammer_event_t
inline constexpr const char* kStateChannel = "ERARD_ACTION_STATE";          // action_state_t

}  // namespace erard
