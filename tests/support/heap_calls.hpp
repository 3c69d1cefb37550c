// Counts every heap call of the process: include in one source file of an executable.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>

namespace {
std::atomic<long> heap_calls{0};
}

#ifdef __has_feature  // clang
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1  // as g++ says it
#endif
#endif

#ifdef __SANITIZE_ADDRESS__
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void*, std::size_t),
                                                         void (*)(const volatile void*));
namespace {
const int installed = __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { ++heap_calls; },
                                                                [](const volatile void*) { ++heap_calls; });
}
#else
// glibc's own allocator under its second name: every malloc of the process passes here, operator new and Eigen included
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) { return ++heap_calls, __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return ++heap_calls, __libc_calloc(count, size); }
void* realloc(void* block, std::size_t size) { return ++heap_calls, __libc_realloc(block, size); }
void* memalign(std::size_t alignment, std::size_t size) { return ++heap_calls, __libc_memalign(alignment, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
}
#endif
