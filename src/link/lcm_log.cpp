#include "erard/device/lcm_log.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "erard/device/error.hpp"
#include "erard/device/lcm_datagram.hpp"

namespace erard {
namespace {

constexpr std::uint32_t kMagic = 0xEDA1DA01;
constexpr std::uint64_t kHeaderSize = 28;             // [byte]
constexpr std::uint64_t kLongestPayload = 256 << 20;  // what LCM takes for a message at most [byte]

std::ifstream open(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file))
    throw InputError(fmt::format("{}: {}", file.string(), in ? "is a folder" : std::strerror(errno)));
  return in;
}

}  // namespace

bool is_lcm_log(const std::filesystem::path& file) {
  std::array<std::uint8_t, 4> start{};
  open(file).read(reinterpret_cast<char*>(start.data()), start.size());
  return read_big_endian(start) == kMagic;
}

LcmLogReader::LcmLogReader(const std::filesystem::path& file)
    : file_(file), in_(open(file)), size_(std::filesystem::file_size(file)) {}

void LcmLogReader::rewind() {
  in_.clear();
  in_.seekg(0);
  position_ = 0;
}

/// @return false when the file ends before that
bool LcmLogReader::read(void* bytes, std::uint64_t count) {
  if (count <= size_ - position_ && in_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count))) {
    position_ += count;
    return true;
  }
  is_cut_short_ = true;
  position_ = size_;
  return false;
}

bool LcmLogReader::next(LcmLogEvent& event) {
  if (position_ == size_) return false;
  const std::uint64_t start = position_;
  std::array<std::uint8_t, kHeaderSize> header;
  if (!read(header.data(), header.size())) return false;
  const Bytes fields(header);
  const std::uint64_t name_size = read_big_endian(fields.subspan(20, 4));
  const std::uint64_t payload_size = read_big_endian(fields.subspan(24, 4));
  if (read_big_endian(fields.first(4)) != kMagic || name_size == 0 || name_size > kLcmLongestName ||
      payload_size > kLongestPayload)
    throw InputError(
        fmt::format("{}: byte {}: is not the start of an event, must be an LCM log as lcm-logger writes it",
                    file_.string(), start));
  if (name_size + payload_size > size_ - position_) {  // no memory for what is not there
    is_cut_short_ = true;
    position_ = size_;
    return false;
  }
  event.time_us = static_cast<std::int64_t>(read_big_endian(fields.subspan(12, 8)));
  event.channel.resize(name_size);
  event.payload.resize(payload_size);
  return read(event.channel.data(), name_size) && read(event.payload.data(), payload_size);
}

}  // namespace erard
