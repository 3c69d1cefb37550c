#include "erard/device/doorbell.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "erard/device/monotonic_clock.hpp"

namespace erard {

Doorbell::Doorbell() : file_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Doorbell::~Doorbell() { close(file_); }

void Doorbell::ring() noexcept { static_cast<void>(eventfd_write(file_, 1)); }

void Doorbell::wait(std::int64_t until_ns) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
  const std::int64_t left = until_ns - MonotonicClock{}.now();
  if (left <= 0) return;
  const timespec time{left / kSecond, left % kSecond};
  pollfd door{file_, POLLIN, 0};
  if (ppoll(&door, 1, &time, nullptr) <= 0) return;
  eventfd_t count = 0;
  static_cast<void>(eventfd_read(file_, &count));
}

}  // namespace erard
