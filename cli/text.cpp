#include "text.h"

#include <g3r/io.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <system_error>

namespace g3r::cli {
namespace {

/// The number at the start of `text` and what follows it. Plain decimal or exponent notation, finite, no sign but a minus.
struct NumberAndRest {
  double number;
  std::string_view rest;
};

std::optional<NumberAndRest> leading_number(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
  return NumberAndRest{number, text.substr(static_cast<std::size_t>(end - text.data()))};
}

}  // namespace

std::string with_commas(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, 1, ',');
  return digits;
}

std::string counted(std::size_t count, const std::string& noun) { return with_commas(count) + " " + noun + (count == 1 ? "" : "s"); }

std::string exact_percent(double share) {
  const double value = 100 * share;
  if (value > 0 && value < 0.01) return "under 0.01 %";
  return short_number(value, value >= 99 && value < 100 ? 4 : 3) + " %";
}

std::string bytes(std::size_t count) {
  constexpr std::array kUnits = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  auto value = static_cast<double>(count);
  std::size_t unit = 0;
  for (; value >= 1000 && unit + 1 < kUnits.size(); ++unit) value /= 1024;
  return short_number(value, 3) + " " + kUnits[unit];
}

std::vector<std::string> device_lines() {
  std::vector<std::string> lines;
  for (const ComputeDevice& device : compute_devices()) {
    lines.push_back("gpu:" + std::to_string(lines.size()) + "  " + escape_text(device.name) + ", " + bytes(device.memory) +
                    (device.software ? ", software" : "") + " (" + escape_text(device.driver) + ")");
  }
  return lines;
}

std::string duration(double seconds) {
  if (seconds < 0.01) return "under 0.01 s";
  if (seconds < 59.5) return short_number(seconds, seconds < 1 ? 2 : 3) + " s";
  const auto whole = static_cast<std::size_t>(std::llround(seconds));
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::optional<std::size_t> parse_bytes(const std::string& text) {
  const auto parsed = leading_number(text);
  if (!parsed || parsed->number <= 0) return std::nullopt;
  double scale = 1;
  std::string_view rest = parsed->rest;
  if (!rest.empty() && rest != "B") {
    constexpr std::string_view kPrefixes = "KMGT";
    const auto power = kPrefixes.find(static_cast<char>(rest[0] & ~0x20));
    if (power == std::string_view::npos) return std::nullopt;
    scale = std::pow(1024.0, static_cast<double>(power + 1));
    rest.remove_prefix(1);
    if (!rest.empty() && rest != "B" && rest != "iB") return std::nullopt;
  }
  const double value = parsed->number * scale;
  if (value < 1 || value >= static_cast<double>(std::numeric_limits<std::size_t>::max())) return std::nullopt;
  return static_cast<std::size_t>(value);
}

std::optional<TileWorker> parse_worker(const std::string& text) {
  TileWorker worker;
  const char* end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, worker.number);
  if (number.ec != std::errc() || number.ptr == end || *number.ptr != '/') return std::nullopt;
  const auto workers = std::from_chars(number.ptr + 1, end, worker.workers);
  const bool good = workers.ec == std::errc() && workers.ptr == end && worker.number > 0 && worker.number <= worker.workers;
  return good ? std::optional(worker) : std::nullopt;
}

}  // namespace g3r::cli
