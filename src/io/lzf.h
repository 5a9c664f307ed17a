// LZF, the compression of PCD's binary_compressed. Source: Marc Lehmann, liblzf 3.6 (format only; the code is ours).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace g3r::io {

/// Bytes that a stream expands to, found without expanding it; nullopt if it is damaged.
std::optional<std::size_t> lzf_size(std::string_view stream);

/// Expands a stream that lzf_size() accepted.
std::string lzf_expand(std::string_view stream, std::size_t size);

/// Compresses; back references reach 8 KiB. Worst case: 33/32 of the input.
std::string lzf_compress(std::string_view bytes);

}  // namespace g3r::io
