// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "decoder/forest/names.h"

namespace hybrid_mesh {

// Finds places in a list of different numbers from 0 on.
class PlaceIndex {
 public:
  PlaceIndex() = default;
  explicit PlaceIndex(const std::vector<int>& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) set(numbers[i], static_cast<int>(i));
  }
  void set(int number, int place) {
    const auto i = static_cast<std::size_t>(number);
    if (i >= places_.size()) places_.resize(std::max(i + 1, 2 * places_.size()), -1);
    places_[i] = place;
  }
  // -1: not in the list.
  int operator()(int number) const { return static_cast<std::size_t>(number) < places_.size() ? places_[number] : -1; }

 private:
  std::vector<int> places_;
};

// Finds places in a list of vertices.
class VertexIndex {
 public:
  explicit VertexIndex(const std::vector<VertexId>& vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (vertices[i].valid()) of_kind_[vertices[i].code & 3].set(vertices[i].index(), static_cast<int>(i));
  }
  int operator()(VertexId vertex) const { return vertex.valid() ? of_kind_[vertex.code & 3](vertex.index()) : -1; }

 private:
  std::array<PlaceIndex, 4> of_kind_;  // one of them for names that no hierarchy has
};

}  // namespace hybrid_mesh
