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

constexpr std::size_t kAlignment = 16;  // of every block that asks for no more

/// A block of `size` bytes behind `alignment` bytes, the last of which hold the size; null if there is no memory, or on request.
inline void* allocate(std::size_t size, std::size_t alignment = kAlignment) {
  if (until_failure.load() >= 0 && until_failure.fetch_sub(1) == 0) return nullptr;
  const std::size_t whole = (size + 2 * alignment - 1) / alignment * alignment;
  auto* block = static_cast<char*>(alignment == kAlignment ? std::malloc(whole) : std::aligned_alloc(alignment, whole));
  if (block == nullptr) return nullptr;
  block += alignment;
  reinterpret_cast<std::size_t*>(block)[-1] = size;
  const std::size_t now = live.fetch_add(size) + size;
  std::size_t most = peak.load();
  while (most < now && !peak.compare_exchange_weak(most, now)) {
  }
  return block;
}

// Not inlined: GCC 12 takes the size before the block for an element outside an array.
[[gnu::noinline]] inline void release(void* pointer, std::size_t alignment = kAlignment) {
  if (pointer == nullptr) return;
  live.fetch_sub(static_cast<std::size_t*>(pointer)[-1]);
  std::free(static_cast<char*>(pointer) - alignment);
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
void* operator new(std::size_t size, std::align_val_t alignment) {
  void* pointer = g3r::allocator::allocate(size, static_cast<std::size_t>(alignment));
  if (pointer == nullptr) throw std::bad_alloc();
  return pointer;
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return g3r::allocator::allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return g3r::allocator::allocate(size); }
void operator delete(void* pointer) noexcept { g3r::allocator::release(pointer); }
void operator delete[](void* pointer) noexcept { g3r::allocator::release(pointer); }
void operator delete(void* pointer, std::size_t) noexcept { g3r::allocator::release(pointer); }
void operator delete[](void* pointer, std::size_t) noexcept { g3r::allocator::release(pointer); }
void operator delete(void* pointer, const std::nothrow_t&) noexcept { g3r::allocator::release(pointer); }
void operator delete[](void* pointer, const std::nothrow_t&) noexcept { g3r::allocator::release(pointer); }
void operator delete(void* pointer, std::align_val_t alignment) noexcept {
  g3r::allocator::release(pointer, static_cast<std::size_t>(alignment));
}
void operator delete(void* pointer, std::size_t, std::align_val_t alignment) noexcept {
  g3r::allocator::release(pointer, static_cast<std::size_t>(alignment));
}
