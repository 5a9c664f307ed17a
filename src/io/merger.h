// One table of several clouds.
#pragma once

#include "io/table.h"

#include <vector>

namespace g3r::io {

/// The properties of numbers that any of some clouds has, and records of points in them, 0 where a cloud has not a property.
class Merger {
 public:
  /// Of the clouds it looks at the precision, at which members are empty, and at the properties of their tables.
  explicit Merger(const std::vector<Cloud>& clouds);

  /// An element "vertex" with the records so far.
  [[nodiscard]] const Element& element() const { return element_; }
  /// Adds the points of a cloud that has the properties of one of those.
  void append(const Cloud& cloud);
  /// Gives the records away and has none then.
  [[nodiscard]] Element take();

 private:
  // Where a column comes from in each of the clouds.
  struct Column {
    enum class What { kPosition, kNormal, kColor, kConfidence, kProperty };
    What what = What::kProperty;
    std::size_t axis = 0;
  };
  void add(const std::string& name, Type type, Column column);
  static double own_value(const Cloud& cloud, const Column& column, std::size_t i);

  Element element_ = make_vertex_element();
  std::vector<Column> columns_;
};

}  // namespace g3r::io
