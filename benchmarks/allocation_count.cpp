#include "benchmarks/allocation_count.h"

#include <atomic>
#include <cstdlib>

#include <malloc.h>

namespace {

std::atomic<long> allocations{0};
std::atomic<long> bytes{0};

}  // namespace

#if defined(__SANITIZE_ADDRESS__)

extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             size_t),
                                                         void (*free_hook)(const volatile void*));
extern "C" size_t __sanitizer_get_allocated_size(const volatile void* memory);
namespace {
const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, size_t size) {
      ++allocations;
      bytes += static_cast<long>(size);
    },
    [](const volatile void* memory) {
      bytes -= static_cast<long>(__sanitizer_get_allocated_size(memory));
    });
}  // namespace

#else

// glibc lets a program put its own allocator in front; these count and pass on.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);
}

namespace {

long usable_bytes(void* memory) { return static_cast<long>(malloc_usable_size(memory)); }

void* counted(void* memory) {
  ++allocations;
  bytes += usable_bytes(memory);
  return memory;
}

}  // namespace

extern "C" {
void* malloc(size_t size) { return counted(__libc_malloc(size)); }
void* calloc(size_t count, size_t size) { return counted(__libc_calloc(count, size)); }
void* realloc(void* old, size_t size) {
  bytes -= usable_bytes(old);
  return counted(__libc_realloc(old, size));
}
void* memalign(size_t alignment, size_t size) { return counted(__libc_memalign(alignment, size)); }
void* aligned_alloc(size_t alignment, size_t size) {
  return counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** out, size_t alignment, size_t size) {
  *out = counted(__libc_memalign(alignment, size));
  return *out == nullptr ? 12 : 0;
}
void free(void* memory) {
  bytes -= usable_bytes(memory);
  __libc_free(memory);
}
}

#endif

namespace isosyrk {

long bytes_in_use() { return bytes; }

long allocations_during(const std::function<void()>& action) {
  const long before = allocations;
  action();
  return allocations - before;
}

}  // namespace isosyrk
