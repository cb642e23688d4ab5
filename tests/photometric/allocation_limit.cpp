// Replaces the global operators new and delete of this suite. All of those without alignment, even where the
// standard library's would call these: those of a sanitizer do not.

#include "allocation_limit.h"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

std::atomic<std::size_t> refused_bytes{std::numeric_limits<std::size_t>::max()};

void* limited_allocation(std::size_t bytes) noexcept {
  if (bytes >= refused_bytes.load(std::memory_order_relaxed)) return nullptr;
  return std::malloc(bytes == 0 ? 1 : bytes);
}

void* limited_allocation_or_throw(std::size_t bytes) {
  if (void* memory = limited_allocation(bytes)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t bytes) {
  return limited_allocation_or_throw(bytes);
}
void* operator new[](std::size_t bytes) {
  return limited_allocation_or_throw(bytes);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return limited_allocation(bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return limited_allocation(bytes);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}

namespace apriltrack::test {

AllocationLimit::AllocationLimit(std::size_t bytes) {
  refused_bytes = bytes;
}

AllocationLimit::~AllocationLimit() {
  refused_bytes = std::numeric_limits<std::size_t>::max();
}

}  // namespace apriltrack::test
