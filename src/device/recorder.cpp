#include "erard/device/recorder.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <string_view>
#include <utility>

#include "erard/device/error.hpp"
#include "erard/device/monotonic_clock.hpp"
#include "erard/device/output_file.hpp"

namespace erard {
namespace {

constexpr auto kLook = std::chrono::milliseconds(50);
constexpr int kLooksAfterFault = 20;  // 1 s: the loop may have ended with the fault
constexpr int kMostFaultFiles = 20;   // a fault that comes again and again does not fill the disk
constexpr std::string_view kTitle = "erard session ";
constexpr std::string_view kVersionOfFile = "1";

RecorderSettings checked(RecorderSettings settings) {
  for (const std::string& channel : settings.channels)
    if (channel.empty() || channel.size() > 63)
      throw InputError(fmt::format("channel = \"{}\", must have 1 to 63 characters", channel));
  settings.events_after_fault = std::min(settings.events_after_fault, settings.history_events);
  return settings;
}

std::unique_ptr<EventLogWriter> begin_log(const std::filesystem::path& file, const std::string& session,
                                          std::int64_t time_ns) {
  auto log = std::make_unique<EventLogWriter>(file);
  log->append(time_ns, Recorder::kSession, fmt::format("{}{}\n{}", kTitle, kVersionOfFile, session));
  log->flush();
  return log;
}

void end_log(EventLogWriter& log, std::int64_t time_ns, std::int64_t lost) {
  log.append(time_ns, Recorder::kEnd, fmt::format("lost: {}\n", lost));
  log.close();
}

/// A name that is not taken: what an earlier session has saved stays.
std::filesystem::path free_name(const std::filesystem::path& folder) {
  for (int number = 1;; ++number) {
    std::filesystem::path file = folder / fmt::format("fault_{}.lcmlog", number);
    if (!std::filesystem::exists(file)) return file;
  }
}

}  // namespace

Recorder::Recorder(RecorderSettings settings)
    : settings_(checked(std::move(settings))), ring_(2 * settings_.history_events, settings_.largest_event) {
  if (!settings_.fault_folder.empty()) prepare_output_folder(settings_.fault_folder);
  if (!settings_.session_file.empty())
    log_ = begin_log(settings_.session_file, settings_.session, MonotonicClock{}.now());
  publish();
  writer_ = std::thread([this] { work(); });
}

Recorder::~Recorder() { finish(); }

void Recorder::push(int channel, std::int64_t time_ns, std::span<const std::byte> data) noexcept {
  const bool is_known = channel >= 0 && channel < static_cast<int>(settings_.channels.size());
  if (!is_known || !ring_.push(channel, time_ns, data)) refused_.fetch_add(1, std::memory_order_relaxed);
}

void Recorder::report_fault() noexcept {
  std::uint64_t none = kNoFault;
  fault_.compare_exchange_strong(none, ring_.written(), std::memory_order_relaxed);
}

void Recorder::finish() {
  if (!writer_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  wake_.notify_all();
  writer_.join();
}

RecorderStatus Recorder::status() const {
  const std::lock_guard lock(mutex_);
  RecorderStatus status = status_;
  status.refused = refused_.load(std::memory_order_relaxed);
  return status;
}

/// The writer: looks, writes, sleeps.
void Recorder::work() noexcept {
  const sched_param ordinary{0};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);  // whatever the thread that made it has
  for (bool is_last = false; !is_last;) {
    {
      std::unique_lock lock(mutex_);
      is_last = wake_.wait_for(lock, kLook, [this] { return is_over_; });
    }
    try {
      record_new_events(is_last);
      save_fault(is_last);
    } catch (const std::exception& error) {
      trouble_ = error.what();
    }
    publish();
  }
}

void Recorder::publish() {
  const std::lock_guard lock(mutex_);
  status_.is_recording = log_ && log_->is_writing();
  status_.events = log_ ? log_->events() : 0;
  status_.bytes = log_ ? log_->bytes() : 0;
  status_.lost = lost_;
  status_.faults_saved = faults_saved_;
  status_.trouble = log_ && !log_->trouble().empty() ? log_->trouble() : trouble_;
}

void Recorder::record_new_events(bool is_last) {
  if (!log_ || !log_->is_writing()) return;
  const std::uint64_t end = ring_.written();
  lost_ += copy_events(*log_, next_, end);
  next_ = end;
  if (is_last)
    end_log(*log_, event_.time_ns, lost_);
  else
    log_->flush();
}

/// @return how many were overwritten before they could be copied; each gap is marked
std::int64_t Recorder::copy_events(EventLogWriter& log, std::uint64_t begin, std::uint64_t end) {
  std::int64_t lost = 0;
  for (std::uint64_t number = begin; number < end && log.is_writing();) {
    if (ring_.read(number, event_) == EventRing::Found::whole) {
      log.append(event_.time_ns, settings_.channels[static_cast<std::size_t>(event_.channel)], event_.data);
      ++number;
      continue;
    }
    // overtaken: on from a little behind the oldest, which is about to be overwritten too
    const std::uint64_t onward = std::clamp(ring_.oldest() + ring_.capacity() / 16, number + 1, end);
    log.append(event_.time_ns, kLost, fmt::format("lost: {}\n", onward - number));
    lost += static_cast<std::int64_t>(onward - number);
    number = onward;
  }
  return lost;
}

void Recorder::save_fault(bool is_last) {
  const std::uint64_t fault = fault_.load(std::memory_order_relaxed);
  if (fault == kNoFault) return;
  const std::uint64_t wanted = fault + settings_.events_after_fault, written = ring_.written();
  if (!is_last && written < wanted && ++looks_since_fault_ < kLooksAfterFault) return;
  looks_since_fault_ = 0;
  if (!settings_.fault_folder.empty() && faults_saved_ < kMostFaultFiles) write_history(std::min(written, wanted));
  fault_.store(kNoFault, std::memory_order_relaxed);
}

void Recorder::write_history(std::uint64_t end) {
  const std::uint64_t begin = end > settings_.history_events ? end - settings_.history_events : 0;
  if (begin < end) ring_.read(begin, event_);  // for the time of the first line
  const auto log = begin_log(free_name(settings_.fault_folder), settings_.session, event_.time_ns);
  const std::int64_t lost = copy_events(*log, begin, end);
  end_log(*log, event_.time_ns, lost);
  if (log->trouble().empty())
    ++faults_saved_;
  else
    trouble_ = log->trouble();
}

std::string session_text(const LogEvent& first, const std::filesystem::path& file) {
  const std::string_view text(reinterpret_cast<const char*>(first.data.data()), first.data.size());
  const std::size_t end_of_line = text.find('\n');
  if (first.channel != Recorder::kSession || !text.starts_with(kTitle) || end_of_line == std::string_view::npos)
    throw InputError(
        fmt::format("{}: begins with an event on channel {}, must begin with the settings of the session on channel {}",
                    file.string(), first.channel, Recorder::kSession));
  const std::string_view version = text.substr(kTitle.size(), end_of_line - kTitle.size());
  if (version != kVersionOfFile)
    throw InputError(
        fmt::format("{}: is a session of version {}, must be of version {}; read it with the program that "
                    "recorded it",
                    file.string(), version, kVersionOfFile));
  return std::string(text.substr(end_of_line + 1));
}

}  // namespace erard
