// For a library that is put under a program (LD_PRELOAD): which calls come from its real-time loop. Include it in one
// source file; it takes the program's prctl(), by which the loop's thread names itself.
#pragma once

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace erard::test {

/// Where a thread is.
enum Place { kElsewhere, kInLoop, kBehindLoop };

/// A thread local variable of a library may take memory when it is first looked at; this one may not.
inline thread_local Place place __attribute__((tls_model("initial-exec"))) = kElsewhere;

/// Calls by place.
using Calls = std::array<std::atomic<long>, 3>;

/// Appends a line to the file that ERARD_WITNESS names.
inline void testify(const char* what, const Calls& calls) {
  const char* const name = std::getenv("ERARD_WITNESS");
  if (name == nullptr) return;
  std::array<char, 128> line;
  const int size = std::snprintf(line.data(), line.size(), "%s %ld %ld %ld\n", what, calls[kElsewhere].load(),
                                 calls[kInLoop].load(), calls[kBehindLoop].load());
  const int file = open(name, O_WRONLY | O_CREAT | O_APPEND, 0666);
  if (file < 0 || write(file, line.data(), static_cast<std::size_t>(size)) != size) std::abort();
  close(file);
}

}  // namespace erard::test

extern "C" int prctl(int option, ...) noexcept {
  std::va_list arguments;
  va_start(arguments, option);
  std::array<unsigned long, 4> word;
  for (unsigned long& w : word) w = va_arg(arguments, unsigned long);
  va_end(arguments);
  if (option == PR_SET_NAME) {
    using namespace erard::test;
    if (std::strcmp(reinterpret_cast<const char*>(word[0]), "erard-loop") == 0)
      place = kInLoop;
    else if (place == kInLoop)
      place = kBehindLoop;
  }
  return static_cast<int>(syscall(SYS_prctl, option, word[0], word[1], word[2], word[3]));
}
