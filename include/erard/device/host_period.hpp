// One period of the host: positions in, forces out. START HERE.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "erard/device/device_file.hpp"
#include "erard/device/link.hpp"
#include "erard/device/loop_status.hpp"
#include "erard/device/periodic_loop.hpp"
#include "erard/device/phase_lock.hpp"
#include "erard/device/recorder.hpp"
#include "erard/haptics/renderer.hpp"

namespace erard {

/// What begins a period. Either way one begins in each period of the host's clock: a device that sends faster does not
/// hasten the simulation.
enum class HostPace {
  clock,     // the host's own, kept at the chosen delay behind the device
  messages,  // the arrival of positions, at most half a period before or after the clock, which follows them
};

/// What the real-time thread tells the slower ones, once a period.
struct HostNews {
  FaultCounters faults;                           // messages, or keys times periods
  FaultCounters host_faults;                      // periods
  std::array<std::int64_t, kFaultCount> begun{};  // how often each appeared after a period without it
  Fault now = Fault::none;
  Fault ever = Fault::none;
  bool has_input = false;                             // positions ever came
  bool is_fading = false;                             // at least one force is not all that it should be
  int asleep = 0;                                     // keys
  std::int64_t accepted = 0, lost = 0, overflow = 0;  // messages
  std::int64_t passivity_periods = 0, force_limit_periods = 0, slew_limit_periods = 0, actuator_limit_periods = 0;
  std::int64_t blows = 0;      // on strings
  double largest_force = 0;    // of any key [N]
  double largest_change = 0;   // of a force from one period to the next [N]
  double last_blow_speed = 0;  // of a hammer [m/s]
};

/// One key as it stands, for viewers.
struct KeyView {
  int key = 0;
  std::int64_t time_ns = 0;  // host time [ns]
  std::array<double, kMaxCoordinates> x{};
  std::array<double, kMaxContacts> compression{};  // [m]
  double piston = 0, force = 0;                    // [m], [N]
};

/// A message as the renderer takes it; it looks into `positions`.
PositionMessage position_message(const positions_t& positions) noexcept;

/// Channels of a recording, in order of the recorder's settings.
inline constexpr int kRecordedPositions = 0, kRecordedForces = 1;

/// The work of the real-time loop. No heap, no exception, no lock; the one thing that enters the kernel is sending.
class HostPeriod {
 public:
  /// The parts must outlive it. Publishes once, so that LCM has taken its memory: call it from the real-time thread.
  /// Positions that came before are dropped, uncounted: the action begins with what is so now.
  HostPeriod(const DeviceSettings& settings, Receiver<positions_t>& positions, Sender& sender, Renderer& renderer,
             Recorder& recorder, PeriodicLoop<>& loop, HostPace pace);

  /// @return whether the loop goes on
  bool operator()(const Period& period) noexcept;

  /// From any thread: take no more positions, so that the forces fade as in silence, and end when they are gone.
  void let_go() noexcept { is_to_let_go_.store(true, std::memory_order_relaxed); }

  HostNews news() const noexcept { return news_shared_.load(); }              // from slower threads
  KeyView view() const noexcept { return view_shared_.load(); }               // likewise, another key every time
  DurationHistogram latency() const noexcept { return latency_.snapshot(); }  // sample taken to force sent
  ReceiverCounts received() const noexcept { return positions_.counts() - before_; }

  std::int64_t publisher_id() const noexcept { return publisher_; }

 private:
  void take_positions() noexcept;
  void publish(const PeriodOutput& out) noexcept;
  void publish_commands(const PeriodOutput& out) noexcept;
  void publish_blows(const PeriodOutput& out) noexcept;
  void record(const PeriodOutput& out) noexcept;
  void tell(const Period& period, const PeriodOutput& out) noexcept;
  void show(const Period& period, const PeriodOutput& out) noexcept;
  void steer(const Period& period) noexcept;
  bool is_gone(const PeriodOutput& out) const noexcept;
  template <typename Message>
  void head(Message& message, const PeriodOutput& out) const noexcept;

  const DeviceSettings& settings_;
  Receiver<positions_t>& positions_;
  Sender& sender_;
  Renderer& renderer_;
  Recorder& recorder_;
  PeriodicLoop<>& loop_;
  PhaseLock lock_;
  HostPace pace_;
  std::atomic<bool> is_to_let_go_{false};
  bool is_letting_go_ = false;  // as of this period
  std::int64_t publisher_;
  std::int64_t validity_ns_;

  static constexpr int kRoom = Receiver<positions_t>::kRoom;
  std::array<Arrival<positions_t>, kRoom> arrived_;  // in this period
  std::array<PositionMessage, kRoom> message_;       // what they say
  int arrived_count_ = 0;
  Fault trouble_ = Fault::none;                // of the host, in this period
  std::int64_t position_sequence_ = 0;         // of the newest position that counted
  std::int64_t position_time_ns_ = 0;          // its device time [ns]
  std::int64_t missed_ = 0;                    // periods, as of the last look
  std::int64_t malformed_ = 0, overflow_ = 0;  // messages, likewise
  ReceiverCounts before_;                      // what the receiver did before the first period
  forces_t forces_;
  actuator_commands_t commands_;
  hammer_event_t blow_;
  std::array<double, Renderer::kMaxKeys> force_before_{};  // [N]
  std::array<std::uint8_t, Sender::kLongest> encoded_;
  HostNews news_;
  Seqlock<HostNews> news_shared_;
  Seqlock<KeyView> view_shared_;
  SharedHistogram latency_;
};

}  // namespace erard
