// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/disks/front_interior.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "layout/disks/grid_region.h"

namespace hybrid_mesh {
namespace {

constexpr int kMostChoices = 300;  // of irregular nodes on a front that are all tried

class Interior {
 public:
  Interior(const DiskFront& front, const Progress& progress) : front_(front), progress_(progress), nodes_(front.loop()) {
    for (int v : nodes_) {
      lacking_.push_back(front.lacking(v));
      turns_ += 2 - front.lacking(v);
    }
  }

  std::optional<DiskFilling> fill() {
    const int n = static_cast<int>(nodes_.size());
    std::vector<int> more(n, 0);
    attempt(more);
    if (best_) return best_;
    // A front that turns by four does not close, or the node inside would lie outside: there is one more pair.
    least_ = front_.irregular() + (turns_ == 4 ? 2 : std::abs(4 - turns_));
    for (int target : {4, 3, 5})
      if (turns_ != target) choose(turns_ > target ? 1 : -1, std::abs(turns_ - target));
    if (best_ && best_->irregular <= least_) return best_;
    for (double smoothness : {1e-4, 0.01, 0.05, 0.2, 1.0}) {
      for (int target : {turns_ > 4 ? 5 : 3, 4, turns_ > 4 ? 3 : 5})
        for (int phase = 0; phase < 4; ++phase)
          if (smoothen(target, phase / 4.0, smoothness, more)) attempt(more);
      if (best_ && best_->irregular <= least_) return best_;
    }
    rectangles();
    return best_;
  }

 private:
  // Tries all choices of `count` nodes that take `by` quads more, if there are not too many.
  void choose(int by, int count) {
    std::vector<int> allowed;
    for (int i = 0; i < static_cast<int>(nodes_.size()); ++i)
      if (may(i, by)) allowed.push_back(i);
    const int n = static_cast<int>(allowed.size());
    if (count > n) return;
    double choices = 1;
    for (int k = 0; k < count; ++k) choices *= static_cast<double>(n - k) / (k + 1);
    if (choices > kMostChoices) return;
    std::vector<int> chosen(count), more(nodes_.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    // One without nodes inside the front is good enough.
    while (!best_ || best_->irregular > least_ || best_->quads() > front_.quad_count() + front_.length() / 2 - 1) {
      std::fill(more.begin(), more.end(), 0);
      for (int k : chosen) more[allowed[k]] = by;
      attempt(more);
      int k = count - 1;
      while (k >= 0 && chosen[k] == n - count + k) --k;
      if (k < 0) return;
      for (++chosen[k]; k + 1 < count; ++k) chosen[k + 1] = chosen[k] + 1;
    }
  }

  bool may(int i, int by) const { return front_.may_deviate(nodes_[i], by); }

  void attempt(const std::vector<int>& more) {
    progress_.check();
    if (!tried_.insert(more).second) return;
    if (!is_plausible(more)) return;
    DiskFront front = front_;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (more[i] != 0) front.deviate(nodes_[i], more[i]);
    if (best_ && front.irregular() > best_->irregular) return;
    if (!front.fill()) return;
    const DiskFilling filling{front.layout(), front.irregular()};
    if (better(filling, best_) && is_disk_mesh(filling.layout, front_.boundary_nodes())) best_ = filling;
  }

  // Whether the front with these changes closes or, if it is convex, has the irregular node inside.
  bool is_plausible(const std::vector<int>& more) const {
    std::vector<int> lacks = lacking_;
    int reflex = 0;
    for (std::size_t i = 0; i < lacks.size(); ++i) {
      lacks[i] += more[i];
      reflex += lacks[i] > 2;
    }
    const GridWalk walk(lacks);
    if (walk.turns == 4) return walk.closed();
    if (walk.turns < 3 || walk.turns > 5) return false;
    const std::array<int, 2> centre = walk.centre();
    for (std::size_t i = 0; i < lacks.size() && reflex == 0; ++i)
      if (lacks[i] == 1 && walk.height(i, centre) < 1) return false;
    return true;
  }

  // Chooses nodes such that the front turns by `target`: the fewest, and the larger `smoothness` is, the more at an even pace, as a circle does.
  // `phase` in [0, 1) says where it begins. False if there is no choice.
  bool smoothen(int target, double phase, double smoothness, std::vector<int>& more) const {
    const int n = static_cast<int>(nodes_.size()), reach = n / 2 + std::abs(turns_ - target) + 1, width = 2 * reach + 1;
    constexpr double kNever = std::numeric_limits<double>::infinity();
    std::vector<double> cost(width, kNever), next(width);  // by the sum of the changes so far
    std::vector<signed char> choice(static_cast<std::size_t>(n) * width, 0);
    cost[reach] = 0;
    int turned = 0;
    for (int i = 0; i < n; ++i) {
      turned += 2 - lacking_[i];
      std::fill(next.begin(), next.end(), kNever);
      for (int by = -1; by <= 1; ++by) {
        if (by != 0 && !may(i, by)) continue;
        for (int s = std::max(0, -by); s < width - std::max(0, by); ++s) {
          if (cost[s] == kNever) continue;
          const double off = turned - (s + by - reach) - (target * (i + 0.5) / n + phase - 0.5);
          const double c = cost[s] + std::abs(by) + smoothness * off * off;
          if (c < next[s + by]) {
            next[s + by] = c;
            choice[static_cast<std::size_t>(i) * width + s + by] = static_cast<signed char>(by);
          }
        }
      }
      cost.swap(next);
    }
    int s = reach + turns_ - target;
    if (s < 0 || s >= width || cost[s] == kNever) return false;
    more.assign(n, 0);
    for (int i = n; i-- > 0; s -= more[i]) more[i] = choice[static_cast<std::size_t>(i) * width + s];
    return true;
  }

  // Tries the rectangles that take the fewest irregular nodes: corners p, p + a and their opposites.
  void rectangles() {
    const int n = static_cast<int>(nodes_.size()), half = n / 2;
    if (n < 4) return;
    constexpr int kNever = 1 << 20;
    std::vector<int> straight(n), corner(n);
    std::int64_t all = 0;
    for (int i = 0; i < n; ++i) {
      const auto cost = [&](int by) { return by == 0 ? 0 : may(i, by) ? 1 : kNever; };
      straight[i] = cost(2 - lacking_[i]);
      corner[i] = cost(1 - lacking_[i]);
      all += straight[i];
    }
    struct Choice {
      std::int64_t cost;
      int p, a;
    };
    std::vector<Choice> choices;
    for (int p = 0; p < half; ++p)
      for (int a = 1; a < half; ++a) {
        std::int64_t cost = all;
        for (int k : {p, p + a, p + half, (p + half + a) % n}) cost += corner[k % n] - straight[k % n];
        if (cost < kNever) choices.push_back({cost, p, a});
      }
    std::sort(choices.begin(), choices.end(), [&](const Choice& x, const Choice& y) {
      return std::tuple(x.cost, x.a * (half - x.a), x.p) < std::tuple(y.cost, y.a * (half - y.a), y.p);
    });
    std::vector<int> more(n);
    for (std::size_t c = 0; c < choices.size() && c < 4; ++c) {
      for (int i = 0; i < n; ++i) more[i] = 2 - lacking_[i];
      const int p = choices[c].p, a = choices[c].a;
      for (int k : {p, p + a, p + half, p + half + a}) more[k % n] = 1 - lacking_[k % n];
      attempt(more);
    }
  }

  const DiskFront& front_;
  const Progress& progress_;
  std::vector<int> nodes_, lacking_;
  int turns_ = 0;
  int least_ = 0;  // irregular nodes that cannot be done without
  std::set<std::vector<int>> tried_;
  std::optional<DiskFilling> best_;
};

}  // namespace

bool is_disk_mesh(const DiskLayout& layout, int boundary_nodes) {
  std::vector<std::pair<int, int>> sides;
  for (const auto& quad : layout.quads)
    for (int i = 0; i < 4; ++i) {
      if (quad[i] == quad[(i + 1) % 4] || quad[i] == quad[(i + 2) % 4]) return false;
      sides.emplace_back(quad[i], quad[(i + 1) % 4]);
    }
  std::sort(sides.begin(), sides.end());
  if (std::adjacent_find(sides.begin(), sides.end()) != sides.end()) return false;
  int open = 0;
  for (const auto& [a, b] : sides) open += !std::binary_search(sides.begin(), sides.end(), std::pair(b, a));
  return open == boundary_nodes;
}

bool better(const DiskFilling& a, const std::optional<DiskFilling>& b) {
  return !b || a.irregular < b->irregular || (a.irregular == b->irregular && a.quads() < b->quads());
}

std::optional<DiskFilling> fill_interior(const DiskFront& front, const Progress& progress) { return Interior(front, progress).fill(); }

}  // namespace hybrid_mesh
