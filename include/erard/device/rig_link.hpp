// The virtual device on the wire: one rig for each key, positions out, forces or currents in.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "erard/device/device_file.hpp"
#include "erard/device/link.hpp"
#include "erard/device/periodic_loop.hpp"
#include "erard/device/rig.hpp"
#include "erard/device/seqlock.hpp"

namespace erard {

struct RigLinkSettings {
  RigSettings rig;            // of every key; the seed of the noise is one more with each
  int keys = 1;               // 1 .. 88
  double period = 5e-4;       // of the samples [s]
  ActuatorSettings actuator;  // whose currents arrive; none: forces do, and the device makes them as they are
  LinkSettings link;
};

/// One period of one key, for people.
struct RigView {
  double time = 0;           // since the first period [s]
  double intended = 0;       // of the finger [m]
  double lever = 0;          // the truth [m]
  double finger_force = 0;   // of the finger on the lever [N]
  double command = 0;        // force that was asked of the actuator last [N]
  double latency = 0;        // of that, since the sample it answers [s]
  bool is_valid = false;     // a command that has not run out is there
  std::int64_t answers = 0;  // commands so far
  std::int64_t blows = 0;    // hammers on strings
  double blow_speed = 0;     // of the last [m/s]
  int faulted = 0;           // keys whose force the host has off or fading
};

/// The work of the rig's loop. Commands act from the instant they arrive until the next one, or until they run out.
class RigLink {
 public:
  /// @param intended  motion of the fingers
  /// Throws InputError, std::invalid_argument or std::runtime_error as Rig, Receiver and Sender do.
  RigLink(const RigLinkSettings& settings, const Keystroke& intended);

  bool operator()(const Period& period) noexcept;

  RigView view() const noexcept { return shared_.load(); }  // of key 0, from slower threads

  /// For the loop's thread: called with each period's view, noexcept; null: nothing.
  using Watcher = void (*)(void* context, const RigView& view) noexcept;
  void watch(Watcher watcher, void* context) noexcept {
    watcher_ = watcher;
    context_ = context;
  }

 private:
  void take_commands(std::int64_t now) noexcept;
  void advance_to(std::int64_t now) noexcept;
  void publish(std::int64_t now) noexcept;
  template <typename Answer>
  void obey(const Answer& answer, const double* command, std::int64_t arrival) noexcept;
  double force_of(double current) const noexcept;

  RigLinkSettings settings_;
  std::vector<Rig> rig_;
  std::vector<double> command_;  // of each key, in force [N]
  Receiver<forces_t> forces_;
  Receiver<actuator_commands_t> currents_;
  Receiver<hammer_event_t> blows_;
  Sender sender_;
  positions_t positions_{};
  std::int64_t start_ns_ = 0, now_ns_ = 0;  // of the first period; up to where the rigs have gone [ns]
  std::int64_t valid_until_ns_ = 0;         // [ns]
  std::int64_t last_sequence_ = 0, host_ = 0;
  Keystroke intended_;
  RigView view_;
  Seqlock<RigView> shared_;
  Watcher watcher_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace erard
