// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Takayama, Panozzo, Sorkine-Hornung, Pattern-Based Quadrangulation for N-Sided Patches, 2014 (a boundary's wishes are kept, and a small pattern of irregular nodes is
// looked for inside).
//
// Quads are laid from the boundary inwards. A node of the front (the boundary of what is still empty) knows how many quads it lacks: where it lacks one, a quad closes the corner;
// where it lacks none, its two edges are one. The front turns by 2 - lacking right angles at a node, and by some number T in all, which no closed corner changes. Three kinds of
// fronts are filled without a choice: T = 4 by a piece of the regular grid, T = 3 and T = 5 by one with a single inner node of three or five quads, whose place follows from the
// front, as the point that a walk along it turns around. Each inner node with one quad more or fewer than four changes T by one, so |4 - T| of them are needed at least. One ring
// of quads along the boundary keeps the wishes; the nodes of the ring then are free to take one more or fewer until what is inside is of the three kinds.
#include "layout/disk_layout.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

constexpr int kMostWished = 8;     // quads at a boundary node
constexpr int kMostChoices = 300;  // of irregular nodes on a front that are all tried
constexpr int kMostTrials = 50;    // fillings of parts of a disk that is cut
constexpr int kBeam = 64;          // patterns next to the wishes that are followed up
constexpr int kSmallFront = 8;     // nodes of a front that may leave no choice of irregular nodes at all

// The walk along a front whose nodes lack so many quads, on the regular grid.
struct Walk {
  int turns = 0;                       // right angles to the left, all in all
  std::vector<std::array<int, 2>> at;  // where each node lies, and where the walk ends
  std::vector<int> direction;          // of the edge after each node: 0 .. 3

  explicit Walk(const std::vector<int>& lacking) {
    at.reserve(lacking.size() + 1);
    direction.reserve(lacking.size());
    at.push_back({0, 0});
    int heading = 0;
    for (std::size_t i = 0; i < lacking.size(); ++i) {
      turns += 2 - lacking[i];
      if (i > 0) heading += 2 - lacking[i];
      direction.push_back(((heading % 4) + 4) % 4);
      at.push_back({at[i][0] + step(i)[0], at[i][1] + step(i)[1]});
    }
  }
  const std::array<int, 2>& step(std::size_t i) const {
    static constexpr std::array<int, 2> kSteps[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    return kSteps[direction[i]];
  }
  bool closed() const { return at.back() == at.front(); }
  // The point that the walk turns around, if it turns by 3 or 5 right angles.
  std::array<int, 2> centre() const {
    const auto [a, b] = at.back();
    return turns == 5 ? std::array{(a - b) / 2, (a + b) / 2} : std::array{(a + b) / 2, (b - a) / 2};
  }
  // How far to the left of the edge after node i a point lies.
  int height(std::size_t i, const std::array<int, 2>& point) const { return step(i)[0] * (point[1] - at[i][1]) - step(i)[1] * (point[0] - at[i][0]); }
};

// What such a walk encloses: cells of the plane's grid or, for one that turns by 3 or 5, of the grid on three or five quadrants around a point.
class GridRegion {
 public:
  explicit GridRegion(const std::vector<int>& lacking) : walk_(lacking), nodes_(static_cast<int>(lacking.size())) { valid_ = place() && flood(); }

  bool valid() const { return valid_; }
  int turns() const { return walk_.turns; }
  // Corners counter-clockwise: the nodes of the walk, then the points inside.
  const std::vector<std::array<int, 4>>& cells() const { return cells_; }

 private:
  // A point, or the cell that has it as its least corner. In each quadrant x >= 0 and y >= 0 are counted from the centre.
  struct Place {
    int quadrant, x, y;
  };

  // Finds the quadrants of the walk's nodes. False if the walk does not go around once, or meets itself or the centre.
  bool place() {
    const int turns = walk_.turns;
    if (turns < 3 || turns > 5 || (turns == 4 && !walk_.closed())) return false;
    std::array<int, 2> centre{0, 0};
    if (turns == 4) {
      // One quadrant holds all.
      quadrants_ = 1;
      for (const auto& at : walk_.at) centre = {std::min(centre[0], at[0] - 1), std::min(centre[1], at[1] - 1)};
    } else {
      if ((walk_.at.back()[0] + walk_.at.back()[1]) % 2) return false;
      quadrants_ = turns;
      centre = walk_.centre();
    }
    std::vector<Place> places;
    int quadrant = 0, first = 0;  // counted on as the walk goes around
    for (int i = 0; i <= nodes_; ++i) {
      const int x = walk_.at[i][0] - centre[0], y = walk_.at[i][1] - centre[1];
      if (x == 0 && y == 0) return false;
      const int now = x > 0 && y >= 0 ? 0 : x <= 0 && y > 0 ? 1 : x < 0 ? 2 : 3;
      if (i == 0) first = quadrant = now;
      quadrant += (((now - quadrant + 1) % 4) + 4) % 4 - 1;
      const std::array<int, 2> from_centre = now == 0 ? std::array{x, y} : now == 1 ? std::array{y, -x} : now == 2 ? std::array{-x, -y} : std::array{-y, x};
      places.push_back({((quadrant % quadrants_) + quadrants_) % quadrants_, from_centre[0], from_centre[1]});
      width_ = std::max({width_, from_centre[0] + 2, from_centre[1] + 2});
    }
    if (turns != 4 && quadrant - first != turns) return false;
    point_.assign(static_cast<std::size_t>(quadrants_) * width_ * width_, -1);
    reached_.assign(point_.size(), 0);
    for (int i = 0; i < nodes_; ++i) {
      if (point_[slot(places[i])] >= 0) return false;
      point_[slot(places[i])] = i;
    }
    start_ = places[0];
    return true;
  }

  std::size_t slot(const Place& p) const { return (static_cast<std::size_t>(p.quadrant) * width_ + p.x) * width_ + p.y; }
  bool in_range(const Place& cell) const { return cell.x + 1 < width_ && cell.y + 1 < width_; }

  // The point at a corner of a cell in range. One on the axis between two quadrants has y = 0, the centre quadrant 0.
  int& corner(const Place& cell, int i) {
    const int x = cell.x + (i == 1 || i == 2), y = cell.y + (i >= 2);
    if (x > 0) return point_[slot({cell.quadrant, x, y})];
    return point_[slot({y > 0 ? (cell.quadrant + 1) % quadrants_ : 0, y, 0})];
  }

  Place across(const Place& cell, int side) const {
    const auto [quadrant, x, y] = cell;
    if (side == 1) return {quadrant, x + 1, y};
    if (side == 2) return {quadrant, x, y + 1};
    if (side == 0) return y > 0 ? Place{quadrant, x, y - 1} : Place{(quadrant + quadrants_ - 1) % quadrants_, 0, x};
    return x > 0 ? Place{quadrant, x - 1, y} : Place{(quadrant + 1) % quadrants_, y, 0};
  }

  bool is_boundary(int from, int to) const { return from >= 0 && to >= 0 && from < nodes_ && to == (from + 1) % nodes_; }

  // Collects the cells to the left of the walk and all that they reach without crossing it. False if that leads out.
  bool flood() {
    std::vector<Place> stack;
    for (int side = 0; side < 4; ++side)
      for (int next = 0; next < 4; ++next)
        for (const Place& cell : {start_, across(start_, side), across(across(start_, side), next)})
          for (int i = 0; i < 4 && in_range(cell) && stack.empty(); ++i)
            if (corner(cell, i) == 0 && corner(cell, (i + 1) % 4) == 1) stack.push_back(cell);
    if (stack.empty()) return false;
    reached_[slot(stack[0])] = 1;
    int points = nodes_;
    while (!stack.empty()) {
      const Place cell = stack.back();
      stack.pop_back();
      std::array<int, 4> corners;
      for (int i = 0; i < 4; ++i) {
        int& point = corner(cell, i);
        if (point < 0) point = points++;
        corners[i] = point;
      }
      cells_.push_back(corners);
      for (int side = 0; side < 4; ++side) {
        const int a = corners[side], b = corners[(side + 1) % 4];
        if (is_boundary(a, b)) continue;
        const Place next = across(cell, side);
        if (is_boundary(b, a) || !in_range(next)) return false;
        if (reached_[slot(next)]++ == 0) stack.push_back(next);
      }
    }
    return true;
  }

  Walk walk_;
  int nodes_, quadrants_ = 1, width_ = 0;
  Place start_{};
  std::vector<int> point_;
  std::vector<char> reached_;
  std::vector<std::array<int, 4>> cells_;
  bool valid_ = false;
};

// The boundary of what is still empty, and the quads laid so far. It begins as the boundary of the disk and is done when nothing is left of it.
class Front {
 public:
  explicit Front(const std::vector<int>& quads_at) : boundary_nodes_(static_cast<int>(quads_at.size())), length_(boundary_nodes_) {
    for (int i = 0; i < boundary_nodes_; ++i) nodes_.push_back({(i + 1) % boundary_nodes_, (i + boundary_nodes_ - 1) % boundary_nodes_, quads_at[i], 0, 0, i, i, true});
  }

  bool done() const { return length_ == 0; }
  bool failed() const { return failed_; }
  int length() const { return length_; }
  int quad_count() const { return static_cast<int>(quads_.size()); }
  // Inner nodes with other than four quads, so far.
  int irregular() const { return irregular_; }
  int boundary_nodes() const { return boundary_nodes_; }
  // Nodes of the disk's boundary that still lack quads.
  int boundary_length() const {
    int count = 0;
    for (int v : loop()) count += nodes_[v].on_boundary;
    return count;
  }
  int lacking(int v) const { return nodes_[v].total - nodes_[v].used; }
  std::vector<int> loop() const {
    std::vector<int> result;
    int v = start_;
    for (int i = 0; i < length_; ++i, v = nodes_[v].next) result.push_back(v);
    return result;
  }
  // After a failure: the boundary nodes, first those whose wishes led to it most likely.
  const std::vector<int>& blamed() const { return blamed_; }

  bool may_deviate(int v, int by) const {
    const Node& node = nodes_[v];
    return !node.on_boundary && std::abs(node.total + by - 4) <= 1 && lacking(v) + by >= 0;
  }
  void deviate(int v, int by) {
    Node& node = nodes_[v];
    irregular_ += (node.total + by != 4) - (node.total != 4);
    node.total += by;
  }

  // Gives a node all the quads that it lacks, at least one.
  void close(int a) {
    const int u = nodes_[a].before, v = nodes_[a].next, count = lacking(a);
    if (length_ < 4) return fail(a);
    // The quads go around `a` from v to u. Of each the corner opposite `a` and, but for the last, the one after it are new.
    int last = v;
    for (int k = 1; k <= count; ++k) {
      const int tip = add_node(1, nodes_[a].origin), after = k < count ? add_node(2, nodes_[a].origin) : u;
      quads_.push_back({a, last, tip, after});
      link(tip, last);
      link(after, tip);
      last = after;
    }
    nodes_[u].used += 1;
    nodes_[v].used += 1;
    start_ = u;
    length_ += 2 * (count - 1);
    if (lacking(u) < 0) fail(u);
    if (lacking(v) < 0) fail(v);
  }

  // Makes one edge of the two at a node that lacks no quad.
  void zip(int a) {
    const int u = nodes_[a].before, v = nodes_[a].next;
    if (length_ == 2) {
      if (lacking(u) != 0) return fail(a);
      length_ = 0;
      return;
    }
    if (nodes_[u].on_boundary && nodes_[v].on_boundary) return fail(a);
    const int kept = nodes_[v].on_boundary ? v : u, gone = kept == u ? v : u;
    Node& node = nodes_[kept];
    const int off = nodes_[gone].total - 4;
    if (off != 0 && node.on_boundary) return fail(a);
    if (off != 0) {
      deviate(gone, -off);
      deviate(kept, off);
    }
    node.used += nodes_[gone].used;
    node.ring = std::min(node.ring, nodes_[gone].ring);
    link(nodes_[u].before, kept);
    link(kept, nodes_[v].next);
    nodes_[gone].same_as = kept;
    start_ = kept;
    length_ -= 2;
    if (lacking(kept) < 0 && may_deviate(kept, 1)) deviate(kept, 1);
    if (lacking(kept) < 0 || (!node.on_boundary && std::abs(node.total - 4) > 1)) fail(kept);
  }

  // Zips until every node lacks a quad. False if that failed.
  bool settle() {
    int steps = length_;
    for (int v = start_; !failed_ && length_ > 0 && steps > 0; --steps) {
      if (lacking(v) == 0) {
        zip(v);
        v = start_;
        steps = length_ + 1;
      } else {
        v = nodes_[v].next;
      }
    }
    return !failed_;
  }

  // Makes one edge of a front of two, whose nodes may take one quad fewer for it.
  void join_last_edges() {
    for (int v : loop())
      if (lacking(v) > 0 && may_deviate(v, -lacking(v))) deviate(v, -lacking(v));
    if (lacking(start_) != 0) return fail(start_);
    zip(start_);
  }

  // Lays quads along the whole front: closes all its nodes, corners first. False if what they lack contradicts each other.
  bool lay_ring() {
    while (!failed_ && length_ > 0) {
      int best = -1, best_rank = 4;
      int v = start_;
      for (int i = 0; i < length_; ++i, v = nodes_[v].next) {
        if (nodes_[v].ring > ring_) continue;
        // Others come last, and are met from a side that has its row.
        const int rank = lacking(v) <= 1 ? lacking(v) : 2 + (nodes_[nodes_[v].before].ring <= ring_ && nodes_[nodes_[v].next].ring <= ring_);
        if (rank < best_rank) best = v, best_rank = rank;
        if (rank == 0) break;
      }
      if (best < 0) {
        ++ring_;
        return settle();
      }
      if (best_rank == 0)
        zip(best);
      else
        close(best);
    }
    return !failed_;
  }

  // Fills a front that turns by 4, 3 or 5 right angles with regular nodes and, for the latter two, one inner node of three or five quads. False if that cannot be.
  bool fill() {
    if (!settle()) return false;
    if (length_ == 0) return true;
    const std::vector<int> nodes = loop();
    std::vector<int> lacks;
    for (int v : nodes) lacks.push_back(lacking(v));
    const GridRegion region(lacks);
    if (!region.valid()) return false;
    std::vector<int> inner;
    for (const auto& corners : region.cells()) {
      std::array<int, 4> quad;
      for (int i = 0; i < 4; ++i) {
        const int c = corners[i], k = c - length_;
        while (k >= static_cast<int>(inner.size())) inner.push_back(add_node(0, 0));
        quad[i] = k < 0 ? nodes[c] : inner[k];
        ++nodes_[quad[i]].used;
      }
      quads_.push_back(quad);
    }
    irregular_ += region.turns() != 4;
    length_ = 0;
    return true;
  }

  DiskLayout layout() const {
    std::vector<int> number(nodes_.size(), -1);
    for (int i = 0; i < boundary_nodes_; ++i) number[i] = i;
    DiskLayout result;
    for (const auto& quad : quads_) {
      std::array<int, 4> named;
      for (int i = 0; i < 4; ++i) {
        int v = quad[i];
        while (nodes_[v].same_as != v) v = nodes_[v].same_as;
        if (number[v] < 0) number[v] = boundary_nodes_ + result.inner_nodes++;
        named[i] = number[v];
      }
      result.quads.push_back(named);
    }
    return result;
  }

 private:
  struct Node {
    int next, before;
    int total, used;  // quads around it in the end, so far
    int ring;
    int same_as;      // itself, or the node that it became one with
    int origin;       // a boundary node near it
    bool on_boundary;
  };

  int add_node(int used, int origin) {
    const int v = static_cast<int>(nodes_.size());
    nodes_.push_back({-1, -1, 4, used, ring_ + 1, v, origin, false});
    return v;
  }
  void link(int u, int v) {
    nodes_[u].next = v;
    nodes_[v].before = u;
  }

  void fail(int at) {
    failed_ = true;
    // What happened here depends most on the boundary from the one neighbour to the other, and there on what is near.
    const int n = boundary_nodes_, from = nodes_[nodes_[at].before].origin, middle = nodes_[at].origin, to = nodes_[nodes_[at].next].origin;
    const auto apart = [n](int i, int j) { return std::min((i - j + n) % n, (j - i + n) % n); };
    std::vector<std::pair<int, int>> order;
    bool between = true;
    for (int k = 0; k < n; ++k) {
      const int i = (from + k) % n;
      order.emplace_back((between ? 0 : n) + std::min({apart(i, from), apart(i, middle), apart(i, to)}), i);
      between &= i != to;
    }
    std::sort(order.begin(), order.end());
    blamed_.clear();
    for (const auto& [distance, i] : order) blamed_.push_back(i);
  }

  std::vector<Node> nodes_;
  std::vector<std::array<int, 4>> quads_;
  std::vector<int> blamed_;
  int boundary_nodes_, length_, start_ = 0, ring_ = 0, irregular_ = 0;
  bool failed_ = false;
};

// Whether no two nodes are joined twice, no quad has a node twice, and there is no boundary but the disk's.
bool is_mesh(const DiskLayout& layout, int boundary_nodes) {
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

// A layout found, and what it costs.
struct Filling {
  DiskLayout layout;
  int irregular = 0;  // inner nodes with other than four quads
  int quads() const { return static_cast<int>(layout.quads.size()); }
};

bool better(const Filling& a, const std::optional<Filling>& b) {
  return !b || a.irregular < b->irregular || (a.irregular == b->irregular && a.quads() < b->quads());
}

// Fills the disk inside a front of inner nodes. Some of them take one quad more or less than four, so that the front turns by 3, 4 or 5 right angles.
class Interior {
 public:
  explicit Interior(const Front& front) : front_(front), nodes_(front.loop()) {
    for (int v : nodes_) {
      lacking_.push_back(front.lacking(v));
      turns_ += 2 - front.lacking(v);
    }
  }

  std::optional<Filling> fill() {
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
    if (!tried_.insert(more).second) return;
    if (!is_plausible(more)) return;
    Front front = front_;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (more[i] != 0) front.deviate(nodes_[i], more[i]);
    if (best_ && front.irregular() > best_->irregular) return;
    if (!front.fill()) return;
    const Filling filling{front.layout(), front.irregular()};
    if (better(filling, best_) && is_mesh(filling.layout, front_.boundary_nodes())) best_ = filling;
  }

  // Whether the front with these changes closes or, if it is convex, has the irregular node inside.
  bool is_plausible(const std::vector<int>& more) const {
    std::vector<int> lacks = lacking_;
    int reflex = 0;
    for (std::size_t i = 0; i < lacks.size(); ++i) {
      lacks[i] += more[i];
      reflex += lacks[i] > 2;
    }
    const Walk walk(lacks);
    if (walk.turns == 4) return walk.closed();
    if (walk.turns < 3 || walk.turns > 5) return false;
    const std::array<int, 2> centre = walk.centre();
    for (std::size_t i = 0; i < lacks.size() && reflex == 0; ++i)
      if (lacks[i] == 1 && walk.height(i, centre) < 1) return false;
    return true;
  }

  // Chooses nodes such that the front turns by `target`: the fewest, and the larger `smoothness` is, the more at an even pace, as a circle does. `phase` in [0, 1) says where it
  // begins. False if there is no choice.
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

  const Front& front_;
  std::vector<int> nodes_, lacking_;
  int turns_ = 0;
  int least_ = 0;  // irregular nodes that cannot be done without
  std::set<std::vector<int>> tried_;
  std::optional<Filling> best_;
};

struct Trial {
  std::optional<Filling> filling;
  // If there is none: the boundary nodes, first those one of which should change, and how far it went.
  std::vector<int> blamed;
  int progress = 0;
};

// Looks for layouts with exactly so many quads at the boundary nodes.
class ExactFilling {
 public:
  Trial operator()(const std::vector<int>& quads_at) {
    const auto known = known_.find(quads_at);
    if (known != known_.end()) return known->second;
    --budget_;
    Trial trial = lay_rings(quads_at);
    if (!trial.filling || trial.filling->irregular > 0) cut(quads_at, trial);
    if (trial.filling) trial.blamed.clear();
    return known_[quads_at] = trial;
  }

 private:
  static std::optional<Filling> fill_inside(const Front& front, int widenings) {
    std::optional<Filling> best = Interior(front).fill();
    if (best || widenings == 0 || front.length() > kSmallFront) return best;
    // One more quad at a node makes the next ring larger.
    for (int v : front.loop()) {
      if (!front.may_deviate(v, 1)) continue;
      Front wider = front;
      wider.deviate(v, 1);
      if (!wider.lay_ring() || wider.done() || wider.length() == 2) continue;
      const std::optional<Filling> filling = fill_inside(wider, widenings - 1);
      if (filling && better(*filling, best)) best = filling;
    }
    return best;
  }

  static Trial lay_rings(const std::vector<int>& quads_at) {
    Trial trial;
    const Front boundary(quads_at);
    const int n = boundary.length();
    Front filled = boundary;
    if (filled.fill()) {
      trial.filling = Filling{filled.layout(), filled.irregular()};
      if (is_mesh(trial.filling->layout, n)) return trial;
      trial.filling.reset();
    }
    // A ring is enough, unless nodes of it can neither take more nor fewer as they should.
    Front front = boundary;
    for (int ring = 0; ring < 3; ++ring) {
      if (front.lay_ring() && front.length() == 2) front.join_last_edges();
      if (front.failed()) {
        if (ring == 0) trial.progress = n - front.boundary_length();
        trial.blamed = front.blamed();
        break;
      }
      if (front.done()) {
        trial.filling = Filling{front.layout(), front.irregular()};
        if (!is_mesh(trial.filling->layout, n)) trial.filling.reset();
        break;
      }
      trial.progress = n + ring + 1;
      trial.filling = fill_inside(front, 2);
      if (trial.filling) return trial;
    }
    if (trial.blamed.empty())
      for (int i = 0; i < n; ++i) trial.blamed.push_back(i);
    return trial;
  }

  // Cuts the disk along an edge or two between boundary nodes, one of them a reflex corner, and keeps what is better.
  void cut(const std::vector<int>& quads_at, Trial& trial) {
    const int n = static_cast<int>(quads_at.size());
    struct Cut {
      int rank, i, arc;
    };
    std::vector<Cut> cuts;
    for (int i = 0; i < n; ++i)
      for (int arc = 2; arc <= n - 2; ++arc) {
        const int j = (i + arc) % n, length = arc % 2 ? 1 : 2;
        if (quads_at[i] < 3 || quads_at[j] < 2 || (quads_at[j] >= 3 && j < i)) continue;
        if (arc + length < 4 || n - arc + length < 4) continue;
        // Between two reflex corners, and in the middle, first.
        const int rank = (quads_at[j] >= 3 ? 0 : n) + std::abs(n - 2 * arc);
        cuts.push_back({rank, i, arc});
      }
    std::stable_sort(cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.rank < b.rank; });
    for (const Cut& c : cuts) {
      const int i = c.i, arc = c.arc, j = (i + arc) % n, length = arc % 2 ? 1 : 2;
      for (int at_i = 1; at_i < quads_at[i]; ++at_i)
        for (int at_j = 1; at_j < quads_at[j]; ++at_j) {
          if (budget_ <= 0) return;
          std::array<std::vector<int>, 2> parts;
          for (int k = 0; k <= arc; ++k) parts[0].push_back(k == 0 ? at_i : k == arc ? at_j : quads_at[(i + k) % n]);
          for (int k = 0; k <= n - arc; ++k) parts[1].push_back(k == 0 ? quads_at[j] - at_j : k == n - arc ? quads_at[i] - at_i : quads_at[(j + k) % n]);
          int least = 0;
          for (auto& part : parts) {
            if (length == 2) part.push_back(2);
            least += std::abs(4 - 2 * static_cast<int>(part.size()) + std::accumulate(part.begin(), part.end(), 0));
          }
          if (trial.filling && least > trial.filling->irregular) continue;
          const Trial first = (*this)(parts[0]);
          if (!first.filling) continue;
          const Trial second = (*this)(parts[1]);
          if (!second.filling) continue;
          Filling joined{join(n, i, j, arc, length, first.filling->layout, second.filling->layout), first.filling->irregular + second.filling->irregular};
          if (better(joined, trial.filling) && is_mesh(joined.layout, n)) trial.filling = std::move(joined);
        }
    }
  }

  static DiskLayout join(int n, int i, int j, int arc, int length, const DiskLayout& first, const DiskLayout& second) {
    DiskLayout result;
    result.inner_nodes = length - 1;
    const auto add = [&](const DiskLayout& part, int from, int count) {
      for (auto quad : part.quads) {
        for (int& c : quad) c = c <= count ? (from + c) % n : c < count + length ? n : n + result.inner_nodes + c - count - length;
        result.quads.push_back(quad);
      }
      result.inner_nodes += part.inner_nodes;
    };
    add(first, i, arc);
    add(second, j, n - arc);
    return result;
  }

  int budget_ = kMostTrials;
  std::map<std::vector<int>, Trial> known_;
};

// The wishes next to the given ones that a rectangle keeps.
std::vector<int> nearest_rectangle(const std::vector<int>& wishes) {
  const int n = static_cast<int>(wishes.size()), half = n / 2;
  const auto gain = [&](int i) { return std::abs(wishes[i % n] - 1) - std::abs(wishes[i % n] - 2); };
  std::tuple<int, int, int, int> best{1 << 30, 0, 0, 0};
  for (int p = 0; p < half; ++p)
    for (int a = 1; a < half; ++a)
      best = std::min(best, std::tuple(gain(p) + gain(p + a) + gain(p + half) + gain(p + half + a), a * (half - a), p, a));
  std::vector<int> result(n, 2);
  const auto [cost, size, p, a] = best;
  for (int k : {p, p + a, p + half, p + half + a}) result[k % n] = 1;
  return result;
}

int difference(const std::vector<int>& a, const std::vector<int>& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

// Changes wishes one by one until they can be kept: a beam search, in which those come first that went farthest, and those with more quads before those with fewer. A rectangle
// ends it at the latest.
DiskLayout fill_near(const std::vector<int>& wishes) {
  struct Candidate {
    std::tuple<int, int, int> rank;  // least first
    std::vector<int> quads_at;
  };
  const int n = static_cast<int>(wishes.size());
  const std::vector<int> rectangle = nearest_rectangle(wishes);
  const int most = difference(wishes, rectangle);
  std::set<std::vector<int>> seen{wishes};
  std::vector<Candidate> generation{{{}, wishes}};
  ExactFilling fill_exactly;
  for (int changes = 0; changes <= most; ++changes) {
    std::optional<Filling> best;
    std::vector<Candidate> next;
    for (const auto& [rank, now] : generation) {
      const Trial trial = fill_exactly(now);
      if (trial.filling && better(*trial.filling, best)) best = trial.filling;
      if (best) continue;
      int order = 0;
      for (int i : trial.blamed)
        for (int by : {1, -1}) {
          if (by > 0 ? now[i] < wishes[i] : now[i] > wishes[i] || now[i] == 1) continue;
          std::vector<int> changed = now;
          changed[i] += by;
          int lowered = 0;
          for (int k = 0; k < n; ++k) lowered += std::max(0, wishes[k] - changed[k]);
          if (seen.insert(changed).second) next.push_back({{(lowered > 0) - trial.progress, lowered, order++}, std::move(changed)});
        }
    }
    if (best) return best->layout;
    std::stable_sort(next.begin(), next.end(), [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
    next.resize(std::min<std::size_t>(next.size(), kBeam));
    generation = std::move(next);
  }
  Front grid(rectangle);
  grid.fill();
  return grid.layout();
}

}  // namespace

DiskLayout fill_disk(const std::vector<int>& quads_at) {
  const int n = static_cast<int>(quads_at.size());
  if (n % 2) throw Error(ErrorCode::InvalidInput, "a boundary of " + std::to_string(n) + " edges: only an even number can be filled with quads");
  if (n < 4) throw Error(ErrorCode::InvalidInput, "a boundary of " + std::to_string(n) + " edges: two nodes would be joined twice; at least four are needed");
  std::vector<int> wishes;
  for (int q : quads_at) wishes.push_back(std::clamp(q, 1, kMostWished));
  // The least of all rotations, so that the layout turns with the wishes.
  int turn = 0;
  for (int k = 1; k < n; ++k)
    for (int i = 0; i < n; ++i) {
      const int a = wishes[(k + i) % n], b = wishes[(turn + i) % n];
      if (a == b) continue;
      if (a < b) turn = k;
      break;
    }
  std::rotate(wishes.begin(), wishes.begin() + turn, wishes.end());
  DiskLayout layout = fill_near(wishes);
  for (auto& quad : layout.quads)
    for (int& c : quad)
      if (c < n) c = (c + turn) % n;
  return layout;
}

DiskLayout fill_disk_with_ring(int edges) {
  const DiskLayout inside = fill_disk(std::vector<int>(std::max(0, edges), 2));
  DiskLayout layout;
  layout.inner_nodes = edges + inside.inner_nodes;
  for (int k = 0; k < edges; ++k) layout.quads.push_back({k, (k + 1) % edges, edges + (k + 1) % edges, edges + k});
  for (auto quad : inside.quads) {
    for (int& c : quad) c += edges;
    layout.quads.push_back(quad);
  }
  return layout;
}

}  // namespace hybrid_mesh
