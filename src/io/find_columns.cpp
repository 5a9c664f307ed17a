#include "io/find_columns.h"

#include "io/column_facts.h"
#include "io/column_names.h"
#include "io/column_words.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <utility>

namespace g3r::io {

namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

// The column of this name, or one that is not there.
std::size_t column_of(std::string_view name, const std::vector<std::string>& names) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

// Finds the columns of one text.
class Finder {
 public:
  Finder(const Text& text, const TextShape& shape) : text_(text), source_(text.source()), shape_(shape), words_(source_, shape) {
    found_.properties.resize(shape.columns);
    for (Property& property : found_.properties) property.type = Type::kFloat64;
  }

  TextColumns find(const std::function<void(const double*)>& store) {
    const bool named = !shape_.header.names.empty();
    const bool asks = !named || column_of("i", shape_.header.names) < shape_.columns;  // what i, j, k are
    ColumnFacts facts(shape_.columns);
    PointRows rows(text_, shape_, [&](std::size_t column, std::size_t line, std::string_view value) { words_.note(column, line, value); });
    while (const double* row = rows.next()) {
      if (store) store(row);
      if (asks) facts.add(row);
    }
    found_.overflow = rows.overflow();
    words_.set_missing(rows.missing());
    const std::vector<TextColumn> text = words_.find_text();
    if (named) name_by_header(facts);
    const std::size_t known = named ? shape_.columns : name_first_columns(facts, text);
    const std::size_t left = leave_out_text(known);
    const std::vector<std::string> missing = words_.about_missing();
    found_.warnings.insert(found_.warnings.end(), missing.begin(), missing.end());
    if (named) return std::move(found_);
    if (found_.kept.size() < shape_.columns && left < found_.kept.size()) facts = facts_of_kept();
    const std::string doubt = guess_names(found_.properties, facts, left, shape_.counted);
    if (!doubt.empty()) found_.warnings.push_back(doubt);
    return std::move(found_);
  }

 private:
  template <class Take>
  void for_each_row(const Take& take) const {
    PointRows rows(text_, shape_, [](std::size_t, std::size_t, std::string_view) {});
    while (const double* row = rows.next()) take(row);
  }

  [[nodiscard]] ColumnFacts facts_of_kept() const {
    ColumnFacts facts(found_.kept.size());
    std::vector<double> kept(found_.kept.size());
    for_each_row([&](const double* row) {
      std::transform(found_.kept.begin(), found_.kept.end(), kept.begin(), [&](std::size_t c) { return row[c]; });
      facts.add(kept.data());
    });
    return facts;
  }

  // Names the columns of a text without names, as far as their order says what they are; returns how many.
  std::size_t name_first_columns(const ColumnFacts& facts, const std::vector<TextColumn>& text) {
    const auto numbers_differ = [&] {
      return all_differ(shape_.points,
                        [&](const std::function<void(double)>& take) { for_each_row([&](const double* row) { take(row[0]); }); });
    };
    // PTS is always x y z
    const Arrangement arrangement = shape_.counted ? Arrangement::kXyz : find_arrangement(facts, text, numbers_differ);
    if (arrangement == Arrangement::kPnezd) {
      found_.warnings.emplace_back(
          "the columns look like point number, northing, easting, elevation and description (PNEZD) and are read so; if they are others, "
          "name them in a first line, for example point,x,y,z,description");
      for (std::size_t a = 0; a < 3; ++a) words_.require_numbers(1 + a);
      constexpr const char* kNames[] = {"point", "y", "x", "z", "description"};
      for (std::size_t c = 0; c < std::size(kNames); ++c) found_.properties[c].name = kNames[c];
      return std::size(kNames);
    }
    const std::size_t first = arrangement == Arrangement::kNumberedXyz ? 1 : 0;
    if (first != 0) {
      found_.properties[0].name = "point";
      found_.warnings.emplace_back(
          "the first column names or numbers the points; the next three are taken for x, y and z; if they are others, name the columns in "
          "a first line, for example point,northing,easting,elevation");
    }
    for (std::size_t a = 0; a < 3; ++a) {
      words_.require_numbers(first + a);
      found_.properties[first + a].name = kAxes[a];
    }
    const std::string doubt = first == 0 && !shape_.counted ? doubt_of_order(facts, shape_.columns) : "";
    if (!doubt.empty()) found_.warnings.push_back(doubt);
    return first + 3;
  }

  // i, j and k are normals where they are vectors of length 1, else indices or what they may be.
  void name_normals(std::vector<std::string>& names, const ColumnFacts& facts) const {
    const std::size_t i = column_of("i", shape_.header.names);
    if (i + 2 >= names.size() || names[i + 1] != "j" || names[i + 2] != "k" || column_of("nx", shape_.header.names) < names.size() ||
        !facts.are_normals(i))
      return;
    for (std::size_t a = 0; a < 3; ++a) names[i + a] = std::string("n") + kAxes[a];
  }

  // The columns that are taken for x, y and z where the header does not name all three. If it names two, the third is the next column with
  // numbers.
  std::array<std::size_t, 3> choose_axes(const std::vector<std::string>& names) {
    std::array<std::size_t, 3> axes{};
    std::size_t named = 0;
    std::size_t last = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      axes[a] = column_of(kAxes[a], names);
      if (axes[a] == names.size()) continue;
      ++named;
      last = std::max(last, axes[a]);
    }
    std::vector<std::size_t> found = named == 2 ? std::vector<std::size_t>() : like_axes(names);
    const bool by_name = !found.empty();
    for (std::size_t c = named == 2 ? last + 1 : 0; c < names.size() && found.size() < 3; ++c) {
      if (words_.is_used(c)) found.push_back(c);
    }
    if (found.size() < (named == 2 ? 1 : 3))
      fail(source_, "the header names no columns x, y and z, and fewer than three columns are numbers");
    if (named == 2) {
      *std::find(axes.begin(), axes.end(), names.size()) = found[0];
    } else {
      std::copy_n(found.begin(), 3, axes.begin());
    }
    found_.warnings.push_back(std::string("the header names no columns x, y and z: ") + (by_name || named == 2 ? "" : "the first three, ") +
                              quote(shape_.header.theirs[axes[0]]) + ", " + quote(shape_.header.theirs[axes[1]]) + " and " +
                              quote(shape_.header.theirs[axes[2]]) + (by_name || named == 2 ? "" : ",") + " are taken for them");
    return axes;
  }

  // Names the columns by the header. x, y and z must be numbers.
  void name_by_header(const ColumnFacts& facts) {
    std::vector<std::string> names = shape_.header.names;
    name_normals(names, facts);
    if (!shape_.header.axes) {
      const std::array<std::size_t, 3> axes = choose_axes(names);
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t c = 0; c < names.size(); ++c) names[c] += names[c] == kAxes[a] && c != axes[a] ? "_2" : "";
      }
      for (std::size_t a = 0; a < 3; ++a) names[axes[a]] = kAxes[a];
    }
    make_distinct(names);
    for (std::size_t c = 0; c < names.size(); ++c) found_.properties[c].name = names[c];
    for (const char* axis : kAxes) words_.require_numbers(column_of(axis, names));
  }

  // Leaves out the columns with text, and says so. Returns how many of the first `known` columns are left.
  std::size_t leave_out_text(std::size_t known) {
    constexpr std::size_t kMostNamed = 8;  // The warning names so many columns, and counts the others.
    std::vector<std::size_t>& kept = found_.kept;
    std::string names;
    for (std::size_t c = 0; c < shape_.columns; ++c) {
      if (words_.is_used(c)) {
        kept.push_back(c);
        continue;
      }
      const std::size_t left_out = c + 1 - kept.size();
      if (left_out > kMostNamed) continue;
      if (left_out > 1) names += ", ";
      names += std::to_string(c + 1);
      if (!found_.properties[c].name.empty()) names.append(" ").append(quote(found_.properties[c].name));
      names.append(" (").append(words_.first(c).empty() ? "empty" : quote(words_.first(c))).append(")");
    }
    if (kept.size() == shape_.columns) return known;
    const std::size_t more = shape_.columns - kept.size() > kMostNamed ? shape_.columns - kept.size() - kMostNamed : 0;
    if (more != 0) names += " and " + std::to_string(more) + " more";
    found_.warnings.push_back("columns without numbers are not used: " + names);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (k != kept[k]) found_.properties[k] = std::move(found_.properties[kept[k]]);
    }
    found_.properties.resize(kept.size());
    return static_cast<std::size_t>(std::lower_bound(kept.begin(), kept.end(), known) - kept.begin());
  }

  const Text& text_;
  const Source& source_;
  const TextShape& shape_;
  ColumnWords words_;
  TextColumns found_;
};

}  // namespace

TextColumns find_columns(const Text& text, const TextShape& shape, const std::function<void(const double*)>& store) {
  return Finder(text, shape).find(store);
}

}  // namespace g3r::io
