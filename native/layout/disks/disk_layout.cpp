// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Takayama, Panozzo, Sorkine-Hornung, Pattern-Based Quadrangulation for N-Sided Patches, 2014 (a boundary's wishes are kept, and a small
// pattern of irregular nodes is looked for inside).
//
// Quads are laid from the boundary inwards. A node of the front (the boundary of what is still empty) knows how many quads it lacks: where it lacks
// one, a quad closes the corner; where it lacks none, its two edges are one. The front turns by 2 - lacking right angles at a node, and by some
// number T in all, which no closed corner changes. Three kinds of fronts are filled without a choice: T = 4 by a piece of the regular grid, T = 3 and
// T = 5 by one with a single inner node of three or five quads, whose place follows from the front, as the point that a walk along it turns around.
// Each inner node with one quad more or fewer than four changes T by one, so |4 - T| of them are needed at least. One ring of quads along the
// boundary keeps the wishes; the nodes of the ring then are free to take one more or fewer until what is inside is of the three kinds.
#include "layout/disks/disk_layout.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "layout/disks/disk_front.h"
#include "layout/disks/front_interior.h"

namespace hybrid_mesh {

namespace {

constexpr int kMostWished = 8;   // quads at a boundary node
constexpr int kMostTrials = 50;  // fillings of parts of a disk that is cut
constexpr int kBeam = 64;        // patterns next to the wishes that are followed up
constexpr int kSmallFront = 8;   // nodes of a front that may leave no choice of irregular nodes at all

struct Trial {
  std::optional<DiskFilling> filling;
  // If there is none: the boundary nodes, first those one of which should change, and how far it went.
  std::vector<int> blamed;
  int progress = 0;
};

// Looks for layouts with exactly so many quads at the boundary nodes.
class ExactFilling {
 public:
  explicit ExactFilling(const Progress& progress) : progress_(progress) {}

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
  std::optional<DiskFilling> fill_inside(const DiskFront& front, int widenings) const {
    std::optional<DiskFilling> best = fill_interior(front, progress_);
    if (best || widenings == 0 || front.length() > kSmallFront) return best;
    // One more quad at a node makes the next ring larger.
    for (int v : front.loop()) {
      if (!front.may_deviate(v, 1)) continue;
      DiskFront wider = front;
      wider.deviate(v, 1);
      if (!wider.lay_ring() || wider.done() || wider.length() == 2) continue;
      const std::optional<DiskFilling> filling = fill_inside(wider, widenings - 1);
      if (filling && better(*filling, best)) best = filling;
    }
    return best;
  }

  Trial lay_rings(const std::vector<int>& quads_at) const {
    progress_.check();
    Trial trial;
    const DiskFront boundary(quads_at);
    const int n = boundary.length();
    DiskFront filled = boundary;
    if (filled.fill()) {
      trial.filling = DiskFilling{filled.layout(), filled.irregular()};
      if (is_disk_mesh(trial.filling->layout, n)) return trial;
      trial.filling.reset();
    }
    // A ring is enough, unless nodes of it can neither take more nor fewer as they should.
    DiskFront front = boundary;
    for (int ring = 0; ring < 3; ++ring) {
      if (front.lay_ring() && front.length() == 2) front.join_last_edges();
      if (front.failed()) {
        if (ring == 0) trial.progress = n - front.boundary_length();
        trial.blamed = front.blamed();
        break;
      }
      if (front.done()) {
        trial.filling = DiskFilling{front.layout(), front.irregular()};
        if (!is_disk_mesh(trial.filling->layout, n)) trial.filling.reset();
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
          for (int k = 0; k <= n - arc; ++k)
            parts[1].push_back(k == 0 ? quads_at[j] - at_j : k == n - arc ? quads_at[i] - at_i : quads_at[(j + k) % n]);
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
          DiskFilling joined{join(n, i, j, arc, length, first.filling->layout, second.filling->layout),
                             first.filling->irregular + second.filling->irregular};
          if (better(joined, trial.filling) && is_disk_mesh(joined.layout, n)) trial.filling = std::move(joined);
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

  const Progress& progress_;
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

// Changes wishes one by one until they can be kept: a beam search, in which those come first that went farthest, and those with more quads before
// those with fewer. A rectangle ends it at the latest.
DiskLayout fill_near(const std::vector<int>& wishes, const Progress& progress) {
  struct Candidate {
    std::tuple<int, int, int> rank;  // least first
    std::vector<int> quads_at;
  };
  const int n = static_cast<int>(wishes.size());
  const std::vector<int> rectangle = nearest_rectangle(wishes);
  const int most = difference(wishes, rectangle);
  std::set<std::vector<int>> seen{wishes};
  std::vector<Candidate> generation{{{}, wishes}};
  ExactFilling fill_exactly(progress);
  for (int changes = 0; changes <= most; ++changes) {
    std::optional<DiskFilling> best;
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
  DiskFront grid(rectangle);
  grid.fill();
  return grid.layout();
}

}  // namespace

DiskLayout fill_disk(const std::vector<int>& quads_at, const Progress& progress) {
  const int n = static_cast<int>(quads_at.size());
  if (n % 2) throw Error(ErrorCode::InvalidInput, "a boundary of " + std::to_string(n) + " edges: only an even number can be filled with quads");
  if (n < 4)
    throw Error(ErrorCode::InvalidInput, "a boundary of " + std::to_string(n) + " edges: two nodes would be joined twice; at least four are needed");
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
  DiskLayout layout = fill_near(wishes, progress);
  for (auto& quad : layout.quads)
    for (int& c : quad)
      if (c < n) c = (c + turn) % n;
  return layout;
}

DiskLayout fill_disk_with_ring(int edges, const Progress& progress) {
  const DiskLayout inside = fill_disk(std::vector<int>(std::max(0, edges), 2), progress);
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
