#include "io/table.h"

#include <algorithm>
#include <utility>

namespace g3r::io {

Element make_vertex_element() {
  Element points;
  points.name = "vertex";
  return points;
}

std::size_t Element::stride() const {
  std::size_t bytes = 0;
  for (const Property& property : properties) {
    if (property.list) return 0;
    bytes += size_of(property.type) * property.count;
  }
  return bytes;
}

std::size_t Element::find(std::string_view property_name) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property_name) return i;
  }
  return npos;
}

std::size_t Element::add(std::string property_name, Type type) {
  properties.emplace_back();
  properties.back().name = std::move(property_name);
  properties.back().type = type;
  return properties.size() - 1;
}

void swap_records(Element& element) {
  char* number = element.data.data();
  const char* const end = number + element.data.size();
  while (number != end) {
    for (const Property& property : element.properties) {
      std::size_t length = property.count;
      if (property.list) {
        swap_bytes(property.count_type, number);
        length = static_cast<std::size_t>(load_as_double(property.count_type, number));
        number += size_of(property.count_type);
      }
      for (std::size_t k = 0; k < length; ++k, number += size_of(property.type)) swap_bytes(property.type, number);
    }
  }
}

RecordLayout::RecordLayout(const Element& element)
    : element_(element),
      fixed_(std::none_of(element.properties.begin(), element.properties.end(), [](const Property& p) { return p.list; })),
      offsets_(element.properties.size() + 1) {
  if (!fixed_) return;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    offsets_[i + 1] = offsets_[i] + size_of(element.properties[i].type) * element.properties[i].count;
  }
}

void RecordLayout::seek(const char* record) {
  if (fixed_) return;
  std::size_t at = 0;
  for (std::size_t i = 0; i < element_.properties.size(); ++i) {
    const Property& property = element_.properties[i];
    offsets_[i] = at;
    if (property.list) {
      const auto length = static_cast<std::size_t>(load_as_double(property.count_type, record + at));
      at += size_of(property.count_type) + length * size_of(property.type);
    } else {
      at += size_of(property.type) * property.count;
    }
  }
  offsets_.back() = at;
}

}  // namespace g3r::io

namespace g3r {

std::shared_ptr<Attributes> Attributes::of_points(Dialect dialect, io::Element points) {
  auto table = std::make_shared<Attributes>();
  table->dialect = dialect;
  table->elements.push_back(std::move(points));
  return table;
}

}  // namespace g3r
