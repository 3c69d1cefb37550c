// Put under a program by LD_PRELOAD, counts what its real-time loop asks of the heap. Writes one line when it ends:
// heap calls elsewhere, in the loop, behind it.
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include "loop_thread.hpp"

namespace {

using erard::test::Calls;
using erard::test::place;

Calls calls{};

void count() noexcept { calls[place].fetch_add(1, std::memory_order_relaxed); }

struct AtTheEnd {
  ~AtTheEnd() { erard::test::testify("heap", calls); }
} at_the_end;

}  // namespace

// glibc's own allocator under its second name: every malloc of the process passes here, operator new included
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t number, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) noexcept { return count(), __libc_malloc(size); }
void* calloc(std::size_t number, std::size_t size) noexcept { return count(), __libc_calloc(number, size); }
void* realloc(void* block, std::size_t size) noexcept { return count(), __libc_realloc(block, size); }
void free(void* block) noexcept { count(), __libc_free(block); }
void* memalign(std::size_t alignment, std::size_t size) noexcept { return count(), __libc_memalign(alignment, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept { return memalign(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  *block = memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
void* mmap(void* address, std::size_t size, int protection, int flags, int file, off_t offset) noexcept {
  count();
  return reinterpret_cast<void*>(syscall(SYS_mmap, address, size, protection, flags, file, offset));
}
int munmap(void* address, std::size_t size) noexcept {
  count();
  return static_cast<int>(syscall(SYS_munmap, address, size));
}
}
