// One table of several clouds.
#pragma once

#include "io/cloud_from_table.h"
#include "io/table.h"

#include <vector>

namespace g3r::io {

/// The properties of numbers that any of some clouds has, and records of points in them, 0 where a cloud has not a property.
class Merger {
 public:
  /// Of the clouds it looks at the precision, at which members are empty, and at the properties of their tables. `deep_colors`: colours
  /// become 16 bits.
  explicit Merger(const std::vector<Cloud>& clouds, bool deep_colors = false);

  /// Whose names the properties follow: that of PLY if all clouds do, or are no tables.
  [[nodiscard]] Attributes::Dialect dialect() const { return dialect_; }

  /// An element "vertex" with the records so far.
  [[nodiscard]] const Element& element() const { return element_; }
  /// Adds the points of a cloud that has the properties of one of those. `colors`: of its records, where colours become 16 bits; null
  /// where only the cloud has them.
  void append(const Cloud& cloud, const RecordColors* colors = nullptr);
  /// Gives the records away and has none then.
  [[nodiscard]] Element take();

 private:
  // Where a column comes from in each of the clouds.
  struct Column {
    enum class What { kPosition, kNormal, kColor, kProperty };
    What what = What::kProperty;
    std::size_t axis = 0;
  };
  void add(const std::string& name, Type type, Column column);
  [[nodiscard]] double own_value(const Cloud& cloud, const Column& column, std::size_t i) const;

  Element element_ = make_vertex_element();
  std::vector<Column> columns_;
  bool deep_colors_;
  Attributes::Dialect dialect_ = Attributes::Dialect::kPly;
};

}  // namespace g3r::io
