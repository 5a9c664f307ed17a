#include "io/column_names.h"

#include "io/text.h"
#include "io/text_values.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace g3r::io {

namespace {

// Units in brackets are ignored: "X [m]" is x.
std::string without_unit(std::string_view name) { return lower_case(trim(name.substr(0, name.find_first_of("[(")))); }

std::string_view without_quotes(std::string_view text) {
  while (!text.empty() && (text.front() == '"' || text.front() == '\'')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == '"' || text.back() == '\'')) text.remove_suffix(1);
  return text;
}

struct Triple {
  std::array<std::string_view, 3> theirs;
  std::array<std::string_view, 3> ours;
};

// What is ours where all three are there: b alone is no blue, and n_x alone no normal. Those that come first are preferred.
constexpr std::array<std::string_view, 3> kNormalNames = {"nx", "ny", "nz"};
constexpr std::array<std::string_view, 3> kColorNames = {"red", "green", "blue"};
constexpr Triple kTriples[] = {{kNormalNames, kNormalNames},
                               {{"normal_x", "normal_y", "normal_z"}, kNormalNames},
                               {{"normalx", "normaly", "normalz"}, kNormalNames},
                               {{"normal x", "normal y", "normal z"}, kNormalNames},
                               {{"n_x", "n_y", "n_z"}, kNormalNames},
                               {{"normals_x", "normals_y", "normals_z"}, kNormalNames},
                               {kColorNames, kColorNames},
                               {{"r", "g", "b"}, kColorNames},
                               {{"rot", "gruen", "blau"}, kColorNames}};

struct AxisName {
  std::string_view theirs;
  std::string_view ours;
  bool geographic;
  std::string_view beside;  // another name without which this one means something else
};

// Those that come first are preferred.
constexpr AxisName kAxisNames[] = {
    {"easting", "x", false, ""},    {"east", "x", false, ""},      {"northing", "y", false, ""}, {"north", "y", false, ""},
    {"height", "z", false, ""},     {"elevation", "z", false, ""}, {"altitude", "z", false, ""}, {"elev", "z", false, ""},
    {"alt", "z", false, ""},        {"longitude", "x", true, ""},  {"lon", "x", true, ""},       {"long", "x", true, ""},
    {"latitude", "y", true, ""},    {"lat", "y", true, ""},        {"e", "x", false, "n"},       {"n", "y", false, "e"},
    {"rechtswert", "x", false, ""}, {"hochwert", "y", false, ""},  {"hoehe", "z", false, ""},    {"h\xc3\xb6he", "z", false, ""},
    {"h\xf6he", "z", false, ""},    {"h", "z", false, ""},         {"u", "z", false, "e"},       {"up", "z", false, ""}};

// The names of a header line, and which of them are taken.
class Renamer {
 public:
  explicit Renamer(std::vector<std::string> names) : names_(std::move(names)) {
    for (const std::string& name : names_) keys_.push_back(without_unit(name));
  }

  void rename_triples() {
    for (const Triple& triple : kTriples) {
      std::array<std::size_t, 3> at{};
      for (std::size_t k = 0; k < 3; ++k) at[k] = find(triple.theirs[k]);
      const bool are_there = std::all_of(at.begin(), at.end(), [this](std::size_t column) { return column < keys_.size(); });
      if (!are_there || std::any_of(triple.ours.begin(), triple.ours.end(), [this](std::string_view name) { return has(name); })) continue;
      for (std::size_t k = 0; k < 3; ++k) rename(at[k], triple.ours[k]);
    }
  }

  // Renames a column of this name; says whether there was one.
  bool rename(std::string_view theirs, std::string_view ours) {
    const std::size_t column = find(theirs);
    if (column == keys_.size() || has(ours)) return false;
    rename(column, ours);
    return true;
  }

  // Whether a column has this name now.
  [[nodiscard]] bool has(std::string_view ours) const {
    return std::find(names_.begin(), names_.end(), ours) != names_.end() && is_renamed(ours);
  }
  // Whether the header has this name.
  [[nodiscard]] bool says(std::string_view theirs) const { return std::find(keys_.begin(), keys_.end(), theirs) != keys_.end(); }
  [[nodiscard]] std::vector<std::string> take() { return std::move(names_); }

 private:
  [[nodiscard]] bool is_renamed(std::string_view ours) const { return std::find(renamed_.begin(), renamed_.end(), ours) != renamed_.end(); }

  [[nodiscard]] std::size_t find(std::string_view key) const {
    return static_cast<std::size_t>(std::find(keys_.begin(), keys_.end(), key) - keys_.begin());
  }

  void rename(std::size_t column, std::string_view ours) {
    names_[column] = ours;
    renamed_.emplace_back(ours);
  }

  std::vector<std::string> names_;
  std::vector<std::string> keys_;  // in small letters, without units
  std::vector<std::string> renamed_;
};

// The name with the letter or digit at `at` replaced.
std::string with_letter(std::string name, std::size_t at, char letter) {
  name[at] = letter;
  return name;
}

}  // namespace

ColumnNames column_names(std::string_view line, char separator) {
  ColumnNames found;
  Values values(line, separator);
  std::string_view value;
  while (values.next(value)) found.names.emplace_back(without_quotes(value));
  Renamer renamer(found.names);
  for (const std::string_view axis : {"x", "y", "z"}) renamer.rename(axis, axis);
  renamer.rename_triples();
  renamer.rename("confidence", "confidence");
  Renamer with_axes = renamer;
  bool geographic = false;
  for (const AxisName& axis : kAxisNames) {
    if (!axis.beside.empty() && !with_axes.says(axis.beside)) continue;
    geographic = with_axes.rename(axis.theirs, axis.ours) ? geographic || axis.geographic : geographic;
  }
  int axes = 0;
  for (const std::string_view axis : {"x", "y", "z"}) axes += with_axes.has(axis) ? 1 : 0;
  if (axes < 2) return {renamer.take(), false, false, std::move(found.names)};
  return {with_axes.take(), axes == 3, geographic && axes == 3, std::move(found.names)};
}

std::vector<std::size_t> like_axes(const std::vector<std::string>& names) {
  constexpr std::array<std::string_view, 3> kLetters = {"xyz", "012", "123"};
  std::vector<std::string> keys;
  for (const std::string& name : names) keys.push_back(without_unit(name));
  const auto find = [&](const std::string& key) {
    return static_cast<std::size_t>(std::find(keys.begin(), keys.end(), key) - keys.begin());
  };
  constexpr std::size_t kLongest = 256;  // of a name: every letter is tried in turn
  for (std::size_t c = 0; c < keys.size(); ++c) {
    if (keys[c] == kNormalNames[0] || keys[c].size() > kLongest) continue;
    for (const std::string_view letters : kLetters) {
      for (std::size_t at = 0; (at = keys[c].find(letters[0], at)) != std::string::npos; ++at) {
        const std::size_t second = find(with_letter(keys[c], at, letters[1]));
        const std::size_t third = find(with_letter(keys[c], at, letters[2]));
        if (second < keys.size() && third < keys.size()) return {c, second, third};
      }
    }
  }
  return {};
}

void make_distinct(std::vector<std::string>& names) {
  std::set<std::string> used;
  for (std::string& name : names) {
    const std::string first = name;
    for (int k = 2; !used.insert(name).second; ++k) name = first + "_" + std::to_string(k);
  }
}

}  // namespace g3r::io
