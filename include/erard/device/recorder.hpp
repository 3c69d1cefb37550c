// Remembers what went in and out of the real-time loop: the newest periods always, a whole session when asked.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "erard/device/event_log.hpp"
#include "erard/device/event_ring.hpp"

namespace erard {

struct RecorderSettings {
  std::vector<std::string> channels{};    // of the events, 1 to 63 characters; push() names them by their place
  std::size_t largest_event = 1024;       // [B]
  std::size_t history_events = 20'000;    // the newest ones, saved on a fault: 5 s of two events a period at 2 kHz
  std::size_t events_after_fault = 2000;  // how many of them come after it
  std::filesystem::path fault_folder{};   // of fault_1.lcmlog ...; empty: faults are not saved
  std::filesystem::path session_file{};   // everything from now on; empty: no recording
  std::string session{};                  // text, put first into each file: what it takes to repeat the session
};

struct RecorderStatus {
  std::int64_t events = 0;    // in the session's file, those of the recorder included
  std::int64_t bytes = 0;     // of them
  std::int64_t lost = 0;      // overwritten before the writer came to them
  std::int64_t refused = 0;   // larger than the largest, or on no channel
  int faults_saved = 0;       // files
  bool is_recording = false;  // a session
  std::string trouble;        // why recording or saving stopped; empty: none
};

/// The real-time thread pushes; a thread of ordinary priority, which looks every 50 ms, writes to the disk. The
/// real-time thread never waits for it: an event costs a copy. Memory is twice the history, taken at the start.
///
/// When the writer falls behind by more than the memory holds, events are lost: counted, and marked in the file where
/// they are missing. When the disk refuses, the recording stops, the file keeps what is whole, status() says so, and
/// the loop does not notice. Files are LCM logs with these channels beside the host's own:
///   ERARD_SESSION  first of all: "erard session 1", newline, the session's text
///   ERARD_LOST     "lost: N", where N events are missing
///   ERARD_END      "lost: N" altogether; last of all, when the recording ended in good order
class Recorder {
 public:
  static constexpr const char* kSession = "ERARD_SESSION";
  static constexpr const char* kLost = "ERARD_LOST";
  static constexpr const char* kEnd = "ERARD_END";

  /// Make it before the thread becomes real-time: the writer inherits the CPUs of who makes it. Throws InputError when
  /// a file cannot be made or a channel's name is of no use.
  explicit Recorder(RecorderSettings settings);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// From the real-time thread. @param channel  place in the settings' channels
  void push(int channel, std::int64_t time_ns, std::span<const std::byte> data) noexcept;
  template <class Record>
  void push_record(int channel, std::int64_t time_ns, const Record& record) noexcept {
    static_assert(std::is_trivially_copyable_v<Record>);
    push(channel, time_ns, std::as_bytes(std::span(&record, 1)));
  }

  /// From the real-time thread: have the history saved, once events_after_fault more have come or a second has passed.
  /// Faults until then are the same fault.
  void report_fault() noexcept;

  /// Ends the recording in good order; after it nothing is pushed.
  void finish();

  RecorderStatus status() const;  // from any slower thread

 private:
  static constexpr std::uint64_t kNoFault = ~std::uint64_t{0};

  void work() noexcept;
  void record_new_events(bool is_last);
  void save_fault(bool is_last);
  void write_history(std::uint64_t end);
  std::int64_t copy_events(EventLogWriter& log, std::uint64_t begin, std::uint64_t end);
  void publish();

  RecorderSettings settings_;
  EventRing ring_;
  std::atomic<std::int64_t> refused_{0};
  std::atomic<std::uint64_t> fault_{kNoFault};  // events pushed when it was reported

  // the writer's own
  std::unique_ptr<EventLogWriter> log_;
  RingEvent event_;
  std::uint64_t next_ = 0;  // event to be recorded
  std::int64_t lost_ = 0;
  int looks_since_fault_ = 0;
  int faults_saved_ = 0;
  std::string trouble_;

  mutable std::mutex mutex_;  // between slow threads
  std::condition_variable wake_;
  bool is_over_ = false;
  RecorderStatus status_;
  std::thread writer_;
};

/// The session's text, from the first event of a recording. Throws InputError when that is something else, or of
/// another version. @param file  for the message
std::string session_text(const LogEvent& first, const std::filesystem::path& file);

}  // namespace erard
