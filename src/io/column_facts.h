// What the columns of a text without names hold, inferred from their values.
#pragma once

#include "io/table.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace g3r::io {

/// What the values of columns are like, told point by point. Columns with text have NaN in its place.
class ColumnFacts {
 public:
  explicit ColumnFacts(std::size_t columns);
  /// Takes note of a point.
  void add(const double* row);
  /// Whether a column holds whole numbers.
  [[nodiscard]] bool are_whole(std::size_t column) const { return whole_[column]; }
  /// Whether a column holds whole numbers 0..255.
  [[nodiscard]] bool are_bytes(std::size_t column) const { return are_levels(column, 255); }
  /// Whether a column and the next two hold whole numbers 0..255.
  [[nodiscard]] bool are_colors(std::size_t column) const;
  /// Whether a column and the next two hold whole numbers from 0 on, some above 1, as no normals do.
  [[nodiscard]] bool are_counts(std::size_t column) const;
  /// The same up to 65535: three such columns alone beside x, y and z are colours.
  [[nodiscard]] bool are_deep_colors(std::size_t column) const;
  /// Whether a column and the next two hold vectors of length 1, or 0 here and there.
  [[nodiscard]] bool are_normals(std::size_t column) const { return any_unit_[column] && !any_other_[column]; }
  /// Whether the first column is 1 more from point to point, in more points than may be so by chance.
  [[nodiscard]] bool count_points() const;
  /// Whether the first column becomes larger from point to point.
  [[nodiscard]] bool increase() const { return increase_; }

 private:
  [[nodiscard]] bool are_levels(std::size_t column, double most) const {
    return whole_[column] && low_[column] >= 0 && high_[column] <= most;
  }

  std::uint64_t points_ = 0;
  std::vector<bool> whole_;
  std::vector<double> low_;  // of columns of whole numbers
  std::vector<double> high_;
  std::vector<bool> any_unit_;   // of the triple that begins at the column
  std::vector<bool> any_other_;  // neither 0 nor of length 1
  double last_ = 0;              // of the first column
  bool increase_ = true;
  bool by_one_ = true;
};

/// How the first columns of a text without names are arranged, inferred from their values.
enum class Arrangement {
  kXyz,
  kNumberedXyz,  ///< a name or number of the point, x, y, z
  kPnezd         ///< point number, northing, easting, elevation, description
};

/// Which columns hold text. `all` of its values are words that do not begin like a number.
struct TextColumn {
  bool any = false;
  bool all = false;
};

/// `all_differ` says whether all values of the first column differ, which takes long and is seldom asked.
Arrangement find_arrangement(const ColumnFacts& facts, const std::vector<TextColumn>& text, const std::function<bool()>& all_differ);

/// Whether all of some numbers differ, of which for_each_value(take) calls take(number) for each, as often as it is called. No more than
/// about `at_once` are in memory.
bool all_differ(std::uint64_t count, const std::function<void(const std::function<void(double)>&)>& for_each_value,
                std::size_t at_once = std::size_t{1} << 21);

/// Without names the first three columns are x, y and z. What to do where they look like something else and the coordinates stand later,
/// else "".
std::string doubt_of_order(const ColumnFacts& facts, std::size_t columns);

/// Names for columns without names, of which none holds text any more and the first `known` are named already: triples that look like
/// normals or colours, else "scalar_4" and so on. A text with a count of its points is PTS, where an intensity comes before the colours.
/// Returns what may be wrong and what to do, else "".
std::string guess_names(std::vector<Property>& columns, const ColumnFacts& facts, std::size_t known, bool counted);

}  // namespace g3r::io
