// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/relaxation_sweeps.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace hybrid_mesh {
namespace {

// Vertices a block: few enough for their stars to stay in a core's cache, and for a mesh of some ten thousand vertices to keep a few threads busy;
// many enough for most of them to be inside.
constexpr int kBlock = 1000;

// The vertices that can move in connected blocks, each in an order in which neighbours are near each other, and the blocks in colours: no edge joins
// two blocks of one colour, so that these can be relaxed side by side. Within a block one vertex comes after the other, each seeing the last ones'
// new positions.
class Blocks {
 public:
  explicit Blocks(const ChartMesh& charts) : block_of_(charts.points.size(), -1) {
    grow(charts);
    colour(charts);
  }

  int colours() const { return static_cast<int>(of_colour_.size()); }
  const std::vector<int>& of_colour(int colour) const { return of_colour_[colour]; }
  template <class Visit>
  void for_vertices(int block, bool back, const Visit& visit) const {
    const int begin = begin_[block], end = begin_[block + 1];
    for (int i = 0; i < end - begin; ++i) visit(vertices_[back ? end - 1 - i : begin + i]);
  }

 private:
  void grow(const ChartMesh& charts) {
    const std::vector<int> movable = charts.movable_vertices();
    vertices_.reserve(movable.size());
    for (const int v : movable) block_of_[v] = kWaiting;
    for (const int seed : movable) {
      if (block_of_[seed] != kWaiting) continue;
      const int block = static_cast<int>(begin_.size());
      const std::size_t begin = vertices_.size();
      begin_.push_back(static_cast<int>(begin));
      const auto take = [&](int v) {
        if (block_of_[v] != kWaiting || vertices_.size() - begin == kBlock) return;
        block_of_[v] = block;
        vertices_.push_back(v);
      };
      take(seed);
      for (std::size_t i = begin; i < vertices_.size(); ++i) charts.mesh.for_ring(vertices_[i], take);
    }
    begin_.push_back(static_cast<int>(vertices_.size()));
  }

  void colour(const ChartMesh& charts) {
    std::vector<std::pair<int, int>> touching;
    for (const int v : vertices_)
      charts.mesh.for_ring(v, [&](int w) {
        if (block_of_[w] >= 0 && block_of_[w] < block_of_[v]) touching.push_back({block_of_[v], block_of_[w]});
      });
    std::sort(touching.begin(), touching.end());
    touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
    std::vector<int> colour(begin_.size() - 1, -1), taken;
    auto next = touching.begin();
    for (int block = 0; block < static_cast<int>(colour.size()); ++block) {
      taken.clear();
      for (; next != touching.end() && next->first == block; ++next) taken.push_back(colour[next->second]);
      int free = 0;
      while (std::find(taken.begin(), taken.end(), free) != taken.end()) ++free;
      colour[block] = free;
      if (free == colours()) of_colour_.emplace_back();
      of_colour_[free].push_back(block);
    }
  }

  static constexpr int kWaiting = -2;
  std::vector<int> vertices_, begin_;
  std::vector<int> block_of_;  // per vertex, -1: it cannot move
  std::vector<std::vector<int>> of_colour_;
};

}  // namespace

void relax_in_sweeps(ChartMesh& charts, const Distortion& density, int sweeps, const Progress& progress) {
  const Blocks blocks(charts);
  charts.remember_flat();
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int i = 0; i < blocks.colours(); ++i) {
      progress.check();
      const bool back = sweep % 2 == 1;
      const std::vector<int>& side_by_side = blocks.of_colour(back ? blocks.colours() - 1 - i : i);
      parallel_for_each_index(static_cast<std::int64_t>(side_by_side.size()), [&](std::int64_t k) {
        StarRelaxation stars(charts, density);
        blocks.for_vertices(side_by_side[k], back, [&](int v) { stars.relax(v, false); });
      });
    }
}

}  // namespace hybrid_mesh
