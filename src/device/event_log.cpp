#include "erard/device/event_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "erard/device/error.hpp"

namespace erard {
namespace {

constexpr std::uint32_t kSyncWord = 0xEDA1DA01;
constexpr std::size_t kHead = 28;                  // [B]
constexpr std::size_t kBlock = 256 * 1024;         // [B]
constexpr std::int64_t kLongestChannel = 63;       // LCM takes no more
constexpr std::int64_t kLargestData = 64LL << 20;  // [B] beyond it a length is taken for damage

template <class Number>
void put(std::string& block, Number number) {
  for (int shift = 8 * (static_cast<int>(sizeof(Number)) - 1); shift >= 0; shift -= 8)
    block += static_cast<char>(static_cast<std::uint64_t>(number) >> shift & 0xff);
}

std::uint64_t get(const char* bytes, int count) {
  std::uint64_t number = 0;
  for (int i = 0; i < count; ++i) number = number << 8 | static_cast<unsigned char>(bytes[i]);
  return number;
}

std::ifstream open_to_read(const std::filesystem::path& path) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (is_folder || !stream)
    throw InputError(fmt::format("{}: cannot be read ({}), must be an LCM log", path.string(),
                                 is_folder ? "it is a folder" : std::strerror(errno)));
  return stream;
}

bool begins_like_a_log(std::ifstream& stream) {
  std::array<char, 4> first{};
  return stream.read(first.data(), first.size()) && get(first.data(), 4) == kSyncWord;
}

}  // namespace

bool is_event_log(const std::filesystem::path& path) {
  std::ifstream stream = open_to_read(path);
  return begins_like_a_log(stream);
}

EventLogWriter::EventLogWriter(std::filesystem::path path) : path_(std::move(path)) {
  file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0)
    throw InputError(
        fmt::format("{}: cannot be written ({}); name a place that can", path_.string(), std::strerror(errno)));
  block_.reserve(2 * kBlock);
}

EventLogWriter::~EventLogWriter() { close(); }

void EventLogWriter::append(std::int64_t time_ns, std::string_view channel, std::span<const std::byte> data) {
  append(time_ns, channel, std::string_view(reinterpret_cast<const char*>(data.data()), data.size()));
}

void EventLogWriter::append(std::int64_t time_ns, std::string_view channel, std::string_view text) {
  if (!is_writing()) return;
  put(block_, kSyncWord);
  put(block_, events_ + static_cast<std::int64_t>(ends_.size()));
  put(block_, time_ns / 1000);
  put(block_, static_cast<std::int32_t>(channel.size()));
  put(block_, static_cast<std::int32_t>(text.size()));
  block_ += channel;
  block_ += text;
  ends_.push_back(block_.size());
  if (block_.size() >= kBlock) flush();
}

void EventLogWriter::flush() {
  if (!is_writing()) return;
  for (std::size_t done = 0; done < block_.size();) {
    const ssize_t accepted = write(file_, block_.data() + done, block_.size() - done);
    if (accepted > 0)
      done += static_cast<std::size_t>(accepted);
    else if (errno != EINTR)
      return give_up(done, errno);
  }
  events_ += static_cast<std::int64_t>(ends_.size());
  bytes_ += static_cast<std::int64_t>(block_.size());
  block_.clear();
  ends_.clear();
}

/// Cuts the file behind the last event that the disk took whole.
void EventLogWriter::give_up(std::size_t accepted, int error) {
  const auto whole = std::upper_bound(ends_.begin(), ends_.end(), accepted);
  events_ += whole - ends_.begin();
  const std::size_t kept = whole == ends_.begin() ? 0 : *(whole - 1);
  bytes_ += static_cast<std::int64_t>(kept);
  trouble_ = fmt::format("{}: recording stopped after {} events ({})", path_.string(), events_, std::strerror(error));
  if (kept < accepted && ftruncate(file_, bytes_) != 0) trouble_ += ", the last one is not whole";
}

void EventLogWriter::close() {
  if (file_ < 0) return;
  flush();
  if (::close(file_) != 0 && trouble_.empty())
    trouble_ = fmt::format("{}: not written whole ({})", path_.string(), std::strerror(errno));
  file_ = -1;
}

EventLogReader::EventLogReader(std::filesystem::path path) : path_(std::move(path)), stream_(open_to_read(path_)) {
  stream_.seekg(0, std::ios::end);
  size_ = stream_.tellg();
  if (size_ == 0) throw InputError(fmt::format("{}: is empty, must be an LCM log", path_.string()));
  stream_.seekg(0);
  if (!begins_like_a_log(stream_))
    throw InputError(fmt::format("{}: is no LCM log, which begins with the bytes ED A1 DA 01", path_.string()));
  stream_.seekg(0);
}

void EventLogReader::refuse(const std::string& what) const {
  throw InputError(fmt::format("{}: event {} at byte {} is damaged: {}; the {} events before it can be read",
                               path_.string(), events_, place_, what, events_));
}

std::optional<LogEvent> EventLogReader::next() {
  const std::int64_t left = size_ - place_;
  std::array<char, kHead> head{};
  if (left < static_cast<std::int64_t>(kHead)) {
    is_truncated_ = left > 0;
    return {};
  }
  stream_.read(head.data(), kHead);
  if (!stream_) refuse("it cannot be read");
  if (get(&head[0], 4) != kSyncWord) refuse("it does not begin with the bytes ED A1 DA 01");
  const auto time = static_cast<std::int64_t>(get(&head[12], 8));
  const auto channel_length = static_cast<std::int32_t>(get(&head[20], 4));
  const auto data_length = static_cast<std::int32_t>(get(&head[24], 4));
  if (channel_length < 1 || channel_length > kLongestChannel)
    refuse(fmt::format("length of the channel = {}, must be 1 to {}", channel_length, kLongestChannel));
  if (data_length < 0 || data_length > kLargestData)
    refuse(fmt::format("length of the data = {}, must be 0 to {}", data_length, kLargestData));
  const std::int64_t length = static_cast<std::int64_t>(kHead) + channel_length + data_length;
  if (length > left) {
    is_truncated_ = true;
    place_ = size_;
    return {};
  }
  LogEvent event{time, std::string(static_cast<std::size_t>(channel_length), ' '),
                 std::vector<std::byte>(static_cast<std::size_t>(data_length))};
  stream_.read(event.channel.data(), channel_length);
  stream_.read(reinterpret_cast<char*>(event.data.data()), data_length);
  if (!stream_) refuse("it cannot be read");
  place_ += length;
  ++events_;
  return event;
}

}  // namespace erard
