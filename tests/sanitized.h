// Whether the tests run under AddressSanitizer or ThreadSanitizer, where everything takes 5 to 20 times as long: long sweeps thin out
// there.
#pragma once

namespace g3r {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
inline constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace g3r
