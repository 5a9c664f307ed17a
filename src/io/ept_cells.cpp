#include "io/ept_cells.h"

#include "base/platform.h"
#include "io/source.h"
#include "io/text_numbers.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace g3r::io {

namespace {

// The deepest level: cells of 2^-31 of the cube are smaller than the steps of its coordinates, so what names deeper ones is damaged.
constexpr std::uint32_t kDeepestCell = 31;

std::string name_of(const EptKey& key) {
  std::string name = std::to_string(key[0]);
  for (std::size_t i = 1; i < key.size(); ++i) (name += '-') += std::to_string(key[i]);
  return name;
}

// "3-1-0-7"; each place lies within its level.
std::optional<EptKey> parse_key(std::string_view text) {
  EptKey key{};
  for (std::size_t i = 0; i < key.size(); ++i) {
    const std::size_t end = i + 1 < key.size() ? text.find('-') : text.size();
    if (end == std::string_view::npos || !parse_integer(text.substr(0, end), key[i])) return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (key[0] > kDeepestCell) return std::nullopt;
  for (std::size_t i = 1; i < key.size(); ++i) {
    if (std::uint64_t{key[i]} >> key[0] != 0) return std::nullopt;
  }
  return key;
}

class Hierarchy {
 public:
  Hierarchy(const std::filesystem::path& folder, const std::array<double, 6>& bounds, const ReadOptions& options)
      : folder_(folder), bounds_(bounds), options_(options) {}

  std::vector<EptCell> read() {
    pages_.push_back({});
    while (!pages_.empty()) {
      const EptKey page = pages_.back();
      pages_.pop_back();
      if (seen_.insert(page).second) read_page(page);
    }
    std::sort(cells_.begin(), cells_.end(), [](const EptCell& a, const EptCell& b) { return a.key < b.key; });
    const auto same = [](const EptCell& a, const EptCell& b) { return a.key == b.key; };
    cells_.erase(std::unique(cells_.begin(), cells_.end(), same), cells_.end());
    return std::move(cells_);
  }

 private:
  // Entries are taken as they are read, without a tree of them.
  void read_page(const EptKey& page) {
    const std::string path = platform::name_of(folder_ / "ept-hierarchy" / (name_of(page) + ".json"));
    const std::string bytes = read_bytes(path);
    const Source source{bytes, path};
    const auto damaged = [&] { fail(source, "damaged: no JSON object of cells"); };
    std::string cell;
    const auto take = [&](int depth, nlohmann::json::parse_event_t event, const nlohmann::json& value) {
      using Event = nlohmann::json::parse_event_t;
      if (event == Event::key) {
        cell = value.get<std::string>();
      } else if (event == Event::value || depth > 0) {
        read_entry(source, cell, depth == 1 ? value : nlohmann::json());
      }
      return depth == 0;  // nothing is kept
    };
    try {
      if (!nlohmann::json::parse(source.bytes, take).is_object()) damaged();
    } catch (const nlohmann::json::exception&) {
      damaged();
    }
  }

  void read_entry(const Source& source, const std::string& cell, const nlohmann::json& points) {
    const std::optional<EptKey> key = parse_key(cell);
    const bool refers = points == -1;
    if (!key || !(refers || points.is_number_unsigned())) fail(source, "expected cells such as \"2-0-1-3\": 1000, found " + quote(cell));
    if (options_.levels != 0 && (*key)[0] >= static_cast<std::uint32_t>(options_.levels)) return;
    if (!meets_box(*key)) return;
    if (refers) {
      pages_.push_back(*key);
    } else if (points != 0) {
      cells_.push_back({*key, points.get<std::uint64_t>()});
    }
  }

  [[nodiscard]] bool meets_box(const EptKey& key) const {
    for (std::size_t a = 0; options_.box && a < 3; ++a) {
      const double side = std::ldexp(bounds_[3 + a] - bounds_[a], -static_cast<int>(key[0]));
      const double low = bounds_[a] + side * key[a + 1];
      const double slack = 1e-6 * side;  // points on the side of a cell may lie in either
      if (low - slack > options_.box->high[a] || low + side + slack < options_.box->low[a]) return false;
    }
    return true;
  }

  const std::filesystem::path& folder_;
  const std::array<double, 6>& bounds_;
  const ReadOptions& options_;
  std::vector<EptKey> pages_;
  std::set<EptKey> seen_;
  std::vector<EptCell> cells_;
};

}  // namespace

std::string EptCell::name() const { return name_of(key); }

std::vector<EptCell> find_ept_cells(const std::filesystem::path& folder, const std::array<double, 6>& bounds, const ReadOptions& options) {
  return Hierarchy(folder, bounds, options).read();
}

}  // namespace g3r::io
