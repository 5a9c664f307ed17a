// Text for people: numbers that read well, and the units that the command line understands.
#pragma once

#include <g3r/g3r.h>
#include <g3r/tiles.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/number_text.h"

namespace g3r::cli {

/// 1234567 -> "1,234,567".
[[nodiscard]] std::string with_commas(std::size_t count);

/// "1 point", "2,000 points": the plural is the noun with an s.
[[nodiscard]] std::string counted(std::size_t count, const std::string& noun);

/// Share 0..1 -> "12.3 %", three digits, and four of what is nearly all; a share that is not zero is never shown as "0 %".
[[nodiscard]] std::string exact_percent(double share);

/// 1536 -> "1.5 KiB".
[[nodiscard]] std::string bytes(std::size_t count);

/// 0.42 -> "0.42 s", 75 -> "1 min 15 s", 4000 -> "1 h 7 min".
[[nodiscard]] std::string duration(double seconds);

/// What --device can name, a line each: "gpu:0  NVIDIA H100, 78 GiB (OpenCL 3.0 CUDA, driver 550.54)". Empty without a driver.
[[nodiscard]] std::vector<std::string> device_lines();

/// "8G", "512M", "1.5GiB", "1000": bytes, powers of 1024. Empty if it is not that.
[[nodiscard]] std::optional<std::size_t> parse_bytes(const std::string& text);

/// "2/8": worker 2 of 8.
[[nodiscard]] std::optional<TileWorker> parse_worker(const std::string& text);

}  // namespace g3r::cli
