// The table that all readers fill: types by kind and size, records of either byte order, columns.
#include "io/table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace g3r::io {
namespace {

constexpr NumberKind kKinds[] = {NumberKind::kSigned, NumberKind::kUnsigned, NumberKind::kFloat};

// table: every type is that of one kind and its own size, and there are ten.
TEST(TypeOf, NamesEveryTypeOnce) {
  std::set<Type> found;
  for (const NumberKind kind : kKinds) {
    for (const std::uint64_t bytes : {1U, 2U, 4U, 8U}) {
      const std::optional<Type> type = type_of(kind, bytes);
      if (!type) continue;
      EXPECT_EQ(size_of(*type), bytes);
      EXPECT_EQ(is_float(*type), kind == NumberKind::kFloat);
      EXPECT_TRUE(found.insert(*type).second);
    }
  }
  EXPECT_EQ(found.size(), 10U);
  for (const NumberKind kind : kKinds) {
    for (const std::uint64_t bytes : {0U, 3U, 5U, 16U}) EXPECT_FALSE(type_of(kind, bytes).has_value());
  }
  EXPECT_FALSE(type_of(NumberKind::kFloat, 2).has_value());
}

// table: what is appended is what is read back, for all types; integers keep within their range.
TEST(AppendDouble, IsReadBack) {
  for (const NumberKind kind : kKinds) {
    for (const std::uint64_t bytes : {1U, 2U, 4U, 8U}) {
      const std::optional<Type> type = type_of(kind, bytes);
      if (!type) continue;
      std::string stored = "before";
      append_double(*type, 100, stored);
      append_double(*type, -1e300, stored);
      ASSERT_EQ(stored.size(), 6 + 2 * bytes);
      EXPECT_EQ(load_as_double(*type, stored.data() + 6), 100);
      const double least = load_as_double(*type, stored.data() + 6 + bytes);
      EXPECT_EQ(least, kind == NumberKind::kUnsigned ? 0
                       : kind == NumberKind::kSigned ? -std::ldexp(1, static_cast<int>(8 * bytes) - 1)
                       : bytes == 8                  ? -1e300
                                                     : -std::numeric_limits<double>::infinity());
    }
  }
}

// table: records with numbers of all sizes, an array and a list, as a machine of the other byte order writes them.
TEST(SwapRecords, TurnsBigEndianRecordsWithListsAndArrays) {
  Element element;
  element.count = 2;
  element.add("a", Type::kUint8);
  element.add("b", Type::kFloat64);
  element.properties[element.add("c", Type::kInt16)].count = 3;
  Property& list = element.properties[element.add("d", Type::kInt32)];
  list.list = true;
  list.count_type = Type::kUint16;
  std::string big;
  const auto append = [&](Type type, double value) {
    append_double(type, value, element.data);
    std::string bytes;
    append_double(type, value, bytes);
    std::reverse(bytes.begin(), bytes.end());
    big += bytes;
  };
  for (const int length : {2, 0}) {
    append(Type::kUint8, 7);
    append(Type::kFloat64, 0.1);
    for (const int value : {-1, 256, 3}) append(Type::kInt16, value);
    append(Type::kUint16, length);
    for (int k = 0; k < length; ++k) append(Type::kInt32, 1000000 + k);
  }
  Element swapped = element;
  swapped.data = big;
  swap_records(swapped);
  EXPECT_EQ(swapped.data, element.data);
}

// table: columns are found under the names that they were added with, in their order.
TEST(Element, FindsWhatWasAdded) {
  Element element = make_vertex_element();
  EXPECT_EQ(element.add("x", Type::kFloat32), 0U);
  EXPECT_EQ(element.add("label", Type::kUint16), 1U);
  EXPECT_EQ(element.find("label"), 1U);
  EXPECT_EQ(element.find("y"), Element::npos);
  EXPECT_EQ(element.stride(), 6U);
}

}  // namespace
}  // namespace g3r::io
