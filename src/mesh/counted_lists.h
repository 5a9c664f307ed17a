// Lists that are counted before they are filled, one after another in one array.
#pragma once

#include <cstddef>
#include <vector>

namespace g3r::mesh {

/// The items of list i are those from begin[i] to begin[i + 1]. `for_each(use)` calls use(list, item) for every item, the same twice over;
/// within a list items stay in that order. `begin`: one more than there are lists. O(lists + items).
template <class Index, class Item, class ForEach>
void fill_lists(std::size_t lists, const ForEach& for_each, std::vector<Index>& begin, std::vector<Item>& items) {
  // Counted two places on, so that they are the beginnings once all are filled in.
  begin.assign(lists + 2, 0);
  for_each([&](std::size_t list, const Item&) { ++begin[list + 2]; });
  for (std::size_t i = 2; i < begin.size(); ++i) begin[i] += begin[i - 1];
  items.resize(begin.back());
  for_each([&](std::size_t list, const Item& item) { items[begin[list + 1]++] = item; });
  begin.pop_back();
}

}  // namespace g3r::mesh
