// SPDX-License-Identifier: GPL-3.0-or-later
// Operations of all kinds one after another, at random places of small hierarchies: every invariant holds after each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>
#include <sstream>

#include "base/error.h"
#include "hierarchy/archive.h"
#include "hierarchy/bases.h"
#include "hierarchy/irregular_operations.h"
#include "hierarchy/operation_checks.h"
#include "layout/disks/disk_layout.h"

namespace hybrid_mesh {
namespace {

bool same(const Repatch& a, const Repatch& b) {
  if (a.level != b.level || a.removed != b.removed || a.new_vertices != b.new_vertices || a.quads != b.quads || a.boundary != b.boundary ||
      a.kind != b.kind || a.sides.size() != b.sides.size())
    return false;
  for (std::size_t q = 0; q < a.sides.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const Repatch::Side &x = a.sides[q][s], &y = b.sides[q][s];
      if (x.kind != y.kind || x.quad != y.quad || x.side != y.side || x.half != y.half) return false;
    }
  return true;
}

bool same(const HierarchyParts& a, const HierarchyParts& b) {
  if (a.base_vertices != b.base_vertices || a.base_quads != b.base_quads || a.base_links != b.base_links || a.refined != b.refined ||
      a.enabled != b.enabled || a.operations.size() != b.operations.size())
    return false;
  for (std::size_t o = 0; o < a.operations.size(); ++o)
    if (!same(a.operations[o], b.operations[o])) return false;
  return true;
}

struct SequenceBase {
  std::string name;
  HybridMesh mesh;
  bool simple;  // no two edges between the same vertices
};

HybridMesh two_components() {
  return HybridMesh::from_base(14,
                               {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {8, 9, 12, 11}, {9, 10, 13, 12}});
}

// A quad whose sides 1 and 3 are glued: a ring.
HybridMesh ring_of_one() { return HybridMesh::from_base(2, {{0, 0, 1, 1}}, {{SideLink{}, SideLink{0, 3}, SideLink{}, SideLink{0, 1}}}); }

// A quad folded along a diagonal: a sphere with two vertices of one quad.
HybridMesh folded_quad() { return HybridMesh::from_base(3, {{0, 1, 0, 2}}, {{SideLink{0, 1}, SideLink{0, 0}, SideLink{0, 3}, SideLink{0, 2}}}); }

std::vector<SequenceBase> sequence_bases() {
  std::vector<SequenceBase> result;
  result.push_back({"cube", cube(), true});
  result.push_back({"torus", torus(3, 3), true});
  result.push_back({"components", two_components(), true});
  result.push_back({"grid", grid(3, 2), true});
  result.push_back({"pillow", pillow(), false});
  result.push_back({"torus_of_one", torus(1, 1), false});
  result.push_back({"ring_of_one", ring_of_one(), false});
  result.push_back({"folded_quad", folded_quad(), false});
  return result;
}

class Sequence {
 public:
  Sequence(const SequenceBase& base, unsigned seed) : mesh_(base.mesh), simple_(base.simple), random_(seed) {}

  // False at the first thing that is wrong.
  testing::AssertionResult run(int steps) {
    mesh_.refine_uniform(mesh_.base_count() < 3 ? 2 : 1);
    for (int step = 0; step < steps; ++step) {
      take_step();
      if (mesh_.leaves().empty()) failure_ = "nothing is left";
      if (simple_ && BruteForce(mesh_).double_pieces() > 0) failure_ = "two vertices are joined twice";
      if (!failure_.empty()) return testing::AssertionFailure() << failure_ << log_.str();
      // Half of the time the next step meets the mesh as this one left it.
      testing::AssertionResult good = sound_but_for_balance(mesh_);
      if (!good) return good << log_.str();
      if (chance(2)) {
        mesh_.balance();
        log_ << "; balance";
        good = sound(mesh_);
        if (!good) return good << log_.str();
      }
    }
    mesh_.balance();
    testing::AssertionResult good = sound(mesh_);
    if (!good) return good << log_.str() << "; balance at the end";
    HybridMesh again;
    try {
      again = put_together(take_apart(mesh_));
    } catch (const Error& error) {
      return testing::AssertionFailure() << "cannot be put together again (" << error.what() << ")" << log_.str();
    }
    good = sound(again);
    if (!good) return good << log_.str() << "; put together again";
    if (!same(take_apart(again), take_apart(mesh_))) return testing::AssertionFailure() << "not the same when put together again" << log_.str();
    return testing::AssertionSuccess();
  }

  static std::map<std::string, int>& outcomes() {
    static std::map<std::string, int> counts;
    return counts;
  }

 private:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool chance(int n) { return below(n) == 0; }

  void take_step() {
    const bool all_enabled = [&] {
      for (bool on : mesh_.enabled())
        if (!on) return false;
      return true;
    }();
    const int choice = below(12);
    if (!all_enabled && choice >= 4) {
      // Operations need all earlier ones.
      choose_enabled(chance(3) ? random_subset() : std::vector<bool>(mesh_.operation_count(), true));
    } else if (choice == 0) {
      const int leaf = random_leaf();
      if (mesh_.level(leaf) >= 5) return;
      log_ << "; refine " << leaf;
      mesh_.refine(leaf);
    } else if (choice <= 2) {
      const int leaf = random_leaf();
      if (mesh_.level(leaf) >= 4) return;
      log_ << "; refine balanced " << leaf;
      mesh_.refine_balanced(leaf);
    } else if (choice == 3) {
      if (mesh_.operation_count() > 0) choose_enabled(random_subset());
    } else {
      operate(choice);
    }
  }

  int random_leaf() {
    const std::vector<int> leaves = mesh_.leaves();
    // New quads are refined more often: later operations stand on them.
    if (mesh_.operation_count() > 0 && chance(2)) {
      std::vector<int> fresh;
      for (int n : leaves)
        if (mesh_.inserted_by(n) >= 0) fresh.push_back(n);
      if (!fresh.empty()) return fresh[below(static_cast<int>(fresh.size()))];
    }
    return leaves[below(static_cast<int>(leaves.size()))];
  }

  std::vector<bool> random_subset() {
    std::vector<bool> enabled(mesh_.operation_count());
    const bool closed = !chance(4);
    for (int o = 0; o < mesh_.operation_count(); ++o) {
      enabled[o] = !chance(3);
      for (int d : mesh_.operation(o).depends) enabled[o] = enabled[o] && (enabled[d] || !closed);
    }
    return enabled;
  }

  void choose_enabled(const std::vector<bool>& enabled) {
    log_ << "; enable ";
    for (bool on : enabled) log_ << on;
    const auto before = everything(mesh_);
    note("set_enabled", mesh_.set_enabled(enabled), before);
  }

  // Active quads around one of them, often next to those of an earlier operation.
  std::vector<int> random_region(int level, int most) {
    const std::vector<int> candidates = active_of_level(mesh_, level);
    if (candidates.empty()) return {};
    std::vector<int> region{candidates[below(static_cast<int>(candidates.size()))]};
    const int size = 1 + below(most);
    for (int tries = 0; tries < 4 * size && static_cast<int>(region.size()) < size; ++tries) {
      const SideLink other = mesh_.neighbour(region[below(static_cast<int>(region.size()))], below(4));
      if (!other.valid() || mesh_.level(other.node) != level || mesh_.is_root(other.node)) continue;
      if (std::find(region.begin(), region.end(), other.node) != region.end()) continue;
      region.push_back(other.node);
      if (!find_disk_region(mesh_, region).reason.empty() && !chance(8)) region.pop_back();
    }
    return region;
  }

  int random_level() {
    const int level = 1 + below(3);
    return std::min(level, std::max(1, mesh_.depth()));
  }

  // The region's own quads, around which a ring may be laid, a node joined to every second corner, or what the corners ask for, or chance.
  std::vector<std::array<int, 4>> random_layout(const DiskRegion& region) {
    const int n = static_cast<int>(region.corners.size());
    std::vector<std::array<int, 4>> quads;
    const int kind = below(5);
    if (kind >= 3) {
      std::vector<int> wishes = regular_quads(region);
      if (kind == 4)
        for (int& q : wishes) q = 1 + below(3);
      Context context;
      return fill_disk(wishes, Progress(context)).quads;
    }
    if (kind == 0 && n >= 6) {
      for (int k = 0; k < n; k += 2) quads.push_back({k, k + 1, (k + 2) % n, n});
      return quads;
    }
    const int shift = kind == 1 ? n : 0;
    std::map<VertexId, int> name;
    for (int k = 0; k < n; ++k) name[region.corners[k]] = k + shift;
    for (int node : region.nodes) {
      std::array<int, 4> quad;
      for (int i = 0; i < 4; ++i) quad[i] = name.try_emplace(mesh_.corner(node, i), static_cast<int>(name.size()) + shift).first->second;
      quads.push_back(quad);
    }
    for (int k = 0; k < n && shift > 0; ++k) quads.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
    return quads;
  }

  void operate(int choice) {
    const int level = random_level();
    const std::vector<int> region = random_region(level, 5);
    if (region.empty()) return;
    OperationDraft draft;
    std::string kind;
    if (choice <= 5) {
      kind = "add_cubes";
      draft = add_cubes(mesh_, region, 1 + below(2));
    } else if (choice <= 7) {
      kind = "connect";
      std::vector<int> other;
      // Regions apart from each other, if chance finds any.
      for (int tries = 0; tries < 6; ++tries) {
        other = random_region(level, 5);
        draft = connect(mesh_, region, other, below(7) - 3);
        if (draft.reason.empty()) break;
      }
    } else if (choice == 8) {
      kind = "open_boundary";
      draft = open_boundary(mesh_, region);
      if (draft.reason.empty()) opened_.push_back(region);
    } else if (choice == 9 && !opened_.empty()) {
      // The quads of a hole that an earlier operation left are put back as root quads.
      kind = "fill";
      const std::vector<int>& hole = opened_[below(static_cast<int>(opened_.size()))];
      draft.repatch.kind = kind;
      draft.repatch.level = mesh_.level(hole[0]);
      std::map<VertexId, int> name;
      std::map<HalfEdge, SideLink> sides;
      for (std::size_t q = 0; q < hole.size(); ++q)
        for (int s = 0; s < 4; ++s) sides[mesh_.half_edge(hole[q], s)] = {static_cast<int>(q), s};
      for (int n : hole) {
        std::array<int, 4> quad;
        std::array<Repatch::Side, 4> links;
        for (int s = 0; s < 4; ++s) {
          const auto [at, fresh] = name.try_emplace(mesh_.corner(n, s), static_cast<int>(name.size()));
          if (fresh) draft.repatch.boundary.push_back(mesh_.corner(n, s));
          quad[s] = at->second;
          const auto across = sides.find(mesh_.half_edge(n, s) ^ 1);
          links[s].kind = across != sides.end() ? Repatch::Side::Kind::Patch : Repatch::Side::Kind::Outer;
          if (across != sides.end()) {
            links[s].quad = across->second.node;
            links[s].side = across->second.side;
          } else {
            links[s].half = mesh_.half_edge(n, s);
          }
        }
        draft.repatch.quads.push_back(quad);
        draft.repatch.sides.push_back(links);
      }
    } else {
      kind = "free_layout";
      const DiskRegion disk = find_disk_region(mesh_, region);
      draft = disk.reason.empty() && disk.corners.size() >= 4 ? free_layout(mesh_, region, random_layout(disk))
                                                              : OperationDraft{{}, "no disk: " + disk.reason};
    }
    log_ << "; " << kind << " of level " << level << " at";
    for (int n : draft.repatch.removed) log_ << " " << n;
    if (!draft.reason.empty()) {
      note(kind + " (builder)", draft.reason, everything(mesh_));
      return;
    }
    const auto before = everything(mesh_);
    const bool thorough = chance(4);
    const HierarchyParts parts = thorough ? take_apart(mesh_) : HierarchyParts{};
    const std::string reason = mesh_.apply(draft.repatch);
    note(kind, reason, before);
    if (!reason.empty() && thorough && !same(parts, take_apart(mesh_))) failure_ = "a refused " + kind + " changed the archive";
  }

  void note(const std::string& what, const std::string& reason, const std::vector<std::int64_t>& before) {
    std::string plain;  // without numbers
    for (char c : reason)
      if (c < '0' || c > '9') plain += c;
    outcomes()[what + ": " + (reason.empty() ? "done" : plain)] += 1;
    log_ << (reason.empty() ? "" : " refused");
    if (!reason.empty() && everything(mesh_) != before) failure_ = "a refused " + what + " changed the hierarchy (" + reason + ")";
  }

  HybridMesh mesh_;
  bool simple_;
  std::mt19937 random_;
  std::vector<std::vector<int>> opened_;
  std::ostringstream log_;
  std::string failure_;
};

class RandomSequences : public testing::TestWithParam<std::pair<int, int>> {};

// Sequences of a base in a block: ten thousand in all.
constexpr int kBlocks = 5, kSequences = 250;

TEST_P(RandomSequences, KeepEveryInvariantAndAnswerEveryQuery) {
  const SequenceBase base = sequence_bases()[GetParam().first];
  // HYBRID_MESH_SEQUENCES: how many a block, for a longer run.
  const char* given = std::getenv("HYBRID_MESH_SEQUENCES");
  const int sequences = given ? std::atoi(given) : kSequences;
  for (int i = 0; i < sequences; ++i) {
    const unsigned seed = static_cast<unsigned>(GetParam().second * sequences + i);
    const testing::AssertionResult good = Sequence(base, seed).run(9);
    ASSERT_TRUE(good) << base.name << ", seed " << seed;
  }
  int done = 0, refused = 0;
  for (const auto& [what, count] : Sequence::outcomes()) (what.ends_with(": done") ? done : refused) += count;
  EXPECT_GT(done, refused);
  if (std::getenv("HYBRID_MESH_OUTCOMES"))
    for (const auto& [what, count] : Sequence::outcomes()) std::cout << count << " " << what << "\n";
}

std::vector<std::pair<int, int>> blocks() {
  std::vector<std::pair<int, int>> result;
  for (int base = 0; base < static_cast<int>(sequence_bases().size()); ++base)
    for (int b = 0; b < kBlocks; ++b) result.emplace_back(base, b);
  return result;
}

INSTANTIATE_TEST_SUITE_P(Hierarchy, RandomSequences, testing::ValuesIn(blocks()),
                         [](const auto& info) { return sequence_bases()[info.param.first].name + "_" + std::to_string(info.param.second); });

}  // namespace
}  // namespace hybrid_mesh
