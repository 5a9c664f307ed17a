// Replaces operator new of the program that includes it: counts live bytes and their peak, and makes the n-th allocation fail on request.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace g3r::allocator {

inline std::atomic<std::size_t> live{0};
inline std::atomic<std::size_t> peak{0};
inline std::atomic<long> until_failure{-1};  ///< allocations before one fails; negative: never

constexpr std::size_t kHead = 16;  // holds the size, keeps the alignment

inline void* allocate(std::size_t size) {
  if (until_failure.load() >= 0 && until_failure.fetch_sub(1) == 0) return nullptr;
  auto* block = static_cast<char*>(std::malloc(size + kHead));
  if (block == nullptr) return nullptr;
  *reinterpret_cast<std::size_t*>(block) = size;
  const std::size_t now = live.fetch_add(size) + size;
  std::size_t most = peak.load();
  while (most < now && !peak.compare_exchange_weak(most, now)) {
  }
  return block + kHead;
}

inline void release(void* pointer) {
  if (pointer == nullptr) return;
  char* block = static_cast<char*>(pointer) - kHead;
  live.fetch_sub(*reinterpret_cast<std::size_t*>(block));
  std::free(block);
}

/// Forgets the peak so far.
inline void reset_peak() { peak.store(live.load()); }

}  // namespace g3r::allocator

void* operator new(std::size_t size) {
  void* pointer = g3r::allocator::allocate(size);
  if (pointer == nullptr) throw std::bad_alloc();
  return pointer;
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return g3r::allocator::allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return g3r::allocator::allocate(size); }
void operator delete(void* pointer) noexcept { g3r::allocator::release(pointer); }
void operator delete[](void* pointer) noexcept { g3r::allocator::release(pointer); }
void operator delete(void* pointer, std::size_t) noexcept { g3r::allocator::release(pointer); }
void operator delete[](void* pointer, std::size_t) noexcept { g3r::allocator::release(pointer); }
void operator delete(void* pointer, const std::nothrow_t&) noexcept { g3r::allocator::release(pointer); }
void operator delete[](void* pointer, const std::nothrow_t&) noexcept { g3r::allocator::release(pointer); }
