// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/structure/structure_coder.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "decoder/error.h"

namespace hybrid_mesh {

namespace {

using Kind = Repatch::Side::Kind;

// Kinds of operations are words for reports; these are kept.
constexpr std::array<const char*, 5> kinds = {"repatch", "add_cubes", "connect", "open_boundary", "free_layout"};

[[noreturn]] void corrupt(const std::string& what) { throw Error(ErrorCode::CorruptStream, "not a valid hierarchy stream: " + what); }

template <class T>
void set_at(std::vector<T>& list, int place, T value) {
  if (static_cast<std::size_t>(place) >= list.size()) list.resize(std::max<std::size_t>(place + 1, 2 * list.size()), -1);
  list[place] = value;
}

QuadSides base_sides(const QuadForest& mesh) {
  QuadSides sides(mesh.base_count());
  for (int q = 0; q < mesh.base_count(); ++q)
    for (int s = 0; s < 4; ++s)
      if (const SideLink link = mesh.neighbour(q, s); link.valid()) sides[q][s] = {Kind::Patch, link.node, link.side, -1};
  return sides;
}

// Sides of the removed quads that no two of them share.
std::vector<OuterHalf> rim_of(const QuadForest& mesh, const std::vector<int>& removed) {
  std::set<HalfEdge> halves;
  for (const int node : removed)
    for (int s = 0; s < 4; ++s) halves.insert(mesh.half_edge(node, s));
  std::vector<OuterHalf> rim;
  for (const int node : removed)
    for (int s = 0; s < 4; ++s)
      if (const HalfEdge h = mesh.half_edge(node, s); !halves.count(h ^ 1)) rim.push_back({h, mesh.from(h), mesh.to(h)});
  return rim;
}

// Names corners by the outer sides that they are at; the others are new vertices.
void name_corners(const QuadForest& mesh, const GluedQuads& glued, Repatch& repatch) {
  std::vector<VertexId> known(glued.vertices);
  for (std::size_t q = 0; q < glued.sides.size(); ++q)
    for (std::size_t s = 0; s < 4; ++s) {
      if (glued.sides[q][s].kind != Kind::Outer) continue;
      known[glued.vertex[4 * q + s]] = mesh.from(glued.sides[q][s].half);
      known[glued.vertex[4 * q + (s + 1) % 4]] = mesh.to(glued.sides[q][s].half);
    }
  std::vector<int> corner;
  for (const VertexId vertex : known) {
    corner.push_back(vertex.valid() ? static_cast<int>(repatch.boundary.size()) : -1 - repatch.new_vertices++);
    if (vertex.valid()) repatch.boundary.push_back(vertex);
  }
  for (std::size_t q = 0; q < glued.sides.size(); ++q) {
    std::array<int, 4>& quad = repatch.quads.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) quad[i] = corner[glued.vertex[4 * q + i]];
  }
  repatch.sides = glued.sides;
}

}  // namespace

// Where faces with hanging nodes are triangulated, which side is a quad's first one decides how: then it is kept.
void StructureCoder::code_turns(GluedQuads& glued) {
  if (closure_ != FaceClosure::Triangles) return;
  std::vector<int> turn;
  for (std::size_t q = 0; q < glued.sides.size(); ++q) {
    turn.push_back(0);
    for (int i = 0; i < 2; ++i) turn[q] |= coder_.code_raw(given_ && ((glued.turn[q] >> i) & 1)) << i;
    if (given_) glued.turn[q] = 0;
  }
  const GluedQuads before = glued;
  for (std::size_t q = 0; q < glued.sides.size(); ++q)
    for (std::size_t s = 0; s < 4; ++s) {
      const std::size_t place = (s + turn[q]) % 4;
      Repatch::Side& side = glued.sides[q][place];
      side = before.sides[q][s];
      if (side.kind == Kind::Patch) side.side = (side.side + turn[side.quad]) % 4;
      glued.vertex[4 * q + place] = before.vertex[4 * q + s];
    }
}

StructureCoder::StructureCoder(BitCoder& coder, const QuadForest* given, int most_quads)
    : coder_(coder), given_(given), most_quads_(most_quads), base_(coder), inserted_(coder) {
  if (!given) return;
  for (int o = 0; o < given->operation_count(); ++o) {
    if (!given->operation(o).enabled) throw Error(ErrorCode::Unsupported, "a stream cannot hold an operation that is switched off");
    operations_.push_back(o);
  }
  std::stable_sort(operations_.begin(), operations_.end(),
                   [&](int a, int b) { return given->operation(a).repatch.level < given->operation(b).repatch.level; });
  changed_ = !operations_.empty();
  closure_ = given->closure();
  for (int n = 0; n < given->node_count(); ++n) depth_ = std::max(depth_, given->level(n));
  for (int n = 0; n < given->node_count(); ++n) uniform_ &= (given->first_child(n) >= 0) == (given->level(n) < depth_ && given->removed_by(n) < 0);
}

// Calls body(); for a reader what is not valid is no stream.
template <class Body>
QuadForest StructureCoder::checked(const Body& body) {
  try {
    return body();
  } catch (const Error& error) {
    if (!given_ && error.code() == ErrorCode::InvalidInput) corrupt(error.what());
    throw;
  }
}

QuadForest StructureCoder::code() {
  return checked([&] {
    code_shape();
    QuadForest base = code_base();
    code_sharp_sides(base);
    base.set_closure(closure_);
    // Of the last level, and where it is known of all together.
    if (!given_ && uniform_ && base.base_count() * std::ldexp(1, 2 * depth_) > most_quads_) corrupt("too many quads");
    if (!given_ && is_plain() && base.base_count() * ((std::ldexp(4, 2 * depth_) - 1) / 3) > most_quads_) corrupt("too many quads");
    return is_plain() ? base : grown(std::move(base));
  });
}

QuadForest StructureCoder::refined_to_depth(QuadForest forest) {
  return checked([&] { return is_plain() ? grown(std::move(forest)) : std::move(forest); });
}

QuadForest StructureCoder::grown(QuadForest base) {
  if (is_plain()) base.reserve_levels(depth_);
  QuadForest mesh = grow(std::move(base), *this, most_quads_);
  if (given_) match(mesh);
  check_balance(mesh);
  return mesh;
}

// How faces are closed where they have hanging nodes is said of balanced leaves alone.
void StructureCoder::check_balance(QuadForest& mesh) const {
  std::vector<int> refined;
  if (!uniform_) mesh.balance(&refined);
  if (!refined.empty()) throw Error(ErrorCode::InvalidInput, "the hierarchy is not balanced");
}

QuadForest StructureCoder::code_base() {
  QuadSides sides;
  if (given_) sides = base_sides(*given_);
  GluedQuads glued = base_.code(given_ ? &sides : nullptr, {}, 0, most_quads_);
  code_turns(glued);
  if (glued.sides.empty()) corrupt("no base quads");
  std::vector<std::array<int, 4>> quads(glued.sides.size());
  std::vector<std::array<SideLink, 4>> links(quads.size());
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (std::size_t s = 0; s < 4; ++s) {
      quads[q][s] = glued.vertex[4 * q + s];
      if (glued.sides[q][s].kind == Kind::Patch) links[q][s] = {glued.sides[q][s].quad, glued.sides[q][s].side};
    }
  for (std::size_t q = 0; q < glued.quad.size(); ++q) note_root(glued.quad[q], glued.turn[q]);
  return QuadForest::from_base(glued.vertices, quads, links);
}

void StructureCoder::code_sharp_sides(QuadForest& mesh) {
  if (!coder_.code_raw(given_ && given_->has_sharp_sides())) return;
  for (int q = 0; q < mesh.base_count(); ++q)
    for (int s = 0; s < 4; ++s) {
      const SideLink across = mesh.neighbour(q, s);
      if (across.valid() && 4 * across.node + across.side < 4 * q + s) continue;
      if (sharp_.code(coder_, given_ && given_->is_sharp(given_node_[q], (s + turn_[q]) % 4))) mesh.set_sharp(q, s);
    }
}

void StructureCoder::code_shape() {
  int closure = 0;
  for (int i = 0; i < 2; ++i) closure |= coder_.code_raw((static_cast<int>(closure_) >> i) & 1) << i;
  if (closure > static_cast<int>(FaceClosure::Triangles)) corrupt("a closure of no known kind");
  closure_ = static_cast<FaceClosure>(closure);
  depth_ = static_cast<int>(number_.code(coder_, depth_));
  if (depth_ > QuadForest::max_level) corrupt("too many levels");
  uniform_ = coder_.code_raw(uniform_);
  changed_ = coder_.code_raw(changed_);
}

void StructureCoder::note_root(int given, int turn) {
  given_node_.push_back(given);
  turn_.push_back(turn);
}

// Names of all nodes, half-edges and vertices that have come since.
void StructureCoder::match(const QuadForest& mesh) {
  for (; matched_ < mesh.node_count(); ++matched_) {
    for (int s = 0; s < 4; ++s) halves_ = std::max(halves_, (mesh.half_edge(matched_, s) | 1) + 1);
    if (!given_) continue;
    const int given = given_node_[matched_], turn = turn_[matched_];
    set_at(new_node_, given, matched_);
    for (int s = 0; s < 4; ++s) {
      const HalfEdge mine = mesh.half_edge(matched_, s), its = given_->half_edge(given, (s + turn) % 4);
      for (int k = 0; k < 2; ++k) {
        set_at(given_half_, mine ^ k, its ^ k);
        set_at(new_half_, its ^ k, mine ^ k);
      }
      if (const VertexId vertex = mesh.from(mine); vertex.kind() == VertexId::Kind::Free)
        set_at(given_free_, vertex.index(), given_->from(its).index());
    }
  }
}

VertexId StructureCoder::given_vertex(VertexId vertex) const {
  switch (vertex.kind()) {
    case VertexId::Kind::Free:
      return {vertex.kind(), given_free_[vertex.index()]};
    case VertexId::Kind::Edge:
      return {vertex.kind(), given_half_[2 * vertex.index()] >> 1};
    default:
      return {vertex.kind(), given_node_[vertex.index()]};
  }
}

// By what is known of the quads at its sides.
BitModel& StructureCoder::refined_model(const QuadForest& mesh, int node) {
  if (!mesh.is_active(node)) return inactive_;
  int refined = 0, whole = 0, coarser = 0;
  for (int s = 0; s < 4; ++s) {
    const int across = mesh.neighbour(node, s).node;
    if (across < 0 || (mesh.level(across) == mesh.level(node) && across >= node)) continue;
    if (mesh.level(across) < mesh.level(node))
      coarser = 1;
    else
      ++(mesh.first_child(across) >= 0 ? refined : whole);
  }
  return refined_[(refined * 5 + whole) * 2 + coarser];
}

bool StructureCoder::refined(const QuadForest& mesh, int node) {
  bool answer = given_ && given_->first_child(given_node_[node]) >= 0;
  if (mesh.level(node) == depth_)
    answer = false;
  else if (uniform_)
    answer = mesh.removed_by(node) < 0;
  else
    answer = refined_model(mesh, node).code(coder_, answer);
  if (answer && given_)
    for (int k = 0; k < 4; ++k) note_root(given_->first_child(given_node_[node]) + (k + turn_[node]) % 4, turn_[node]);
  return answer;
}

QuadSides StructureCoder::given_sides(const Repatch& repatch) const {
  QuadSides sides = repatch.sides;
  for (auto& quad : sides)
    for (Repatch::Side& side : quad)
      if (side.kind == Kind::Outer) side.half = new_half_[side.half];
  return sides;
}

void StructureCoder::code_removed(const QuadForest& mesh, Repatch& repatch, std::int64_t first) {
  std::vector<int> removed;
  if (given_)
    for (const int node : given_->operation(operations_[next_operation_]).repatch.removed) removed.push_back(new_node_[node]);
  std::sort(removed.begin(), removed.end());
  const std::int64_t count = number_.code(coder_, static_cast<std::int64_t>(removed.size()));
  if (count > mesh.node_count()) corrupt("more quads removed than there are");
  for (std::int64_t i = 0; i < count; ++i) {
    first += (i == 0 ? number_ : removed_).code(coder_, given_ ? removed[i] - first : 0);
    if (first >= mesh.node_count()) corrupt("a quad out of range");
    repatch.removed.push_back(static_cast<int>(first++));
  }
}

bool StructureCoder::operation(const QuadForest& mesh, int level, Repatch& repatch) {
  if (!changed_ || level > depth_) return false;
  match(mesh);
  const bool another = next_operation_ < operations_.size() && given_->operation(operations_[next_operation_]).repatch.level == level;
  if (!more_.code(coder_, another)) return false;
  const QuadForest::Operation* given = given_ ? &given_->operation(operations_[next_operation_]) : nullptr;
  std::size_t kind = 0;
  if (given) kind = std::find(kinds.begin(), kinds.end(), given->repatch.kind) - kinds.begin();
  kind = static_cast<std::size_t>(kind_.code(coder_, static_cast<std::int64_t>(kind % kinds.size())));
  if (kind >= kinds.size()) corrupt("an operation of no known kind");
  repatch.kind = kinds[kind];
  int first = 0;
  while (first < mesh.node_count() && mesh.level(first) < level) ++first;
  code_removed(mesh, repatch, first);
  QuadSides sides;
  if (given) sides = given_sides(given->repatch);
  GluedQuads glued = inserted_.code(given ? &sides : nullptr, rim_of(mesh, repatch.removed), halves_, most_quads_);
  code_turns(glued);
  name_corners(mesh, glued, repatch);
  if (!given) return true;
  if (repatch.new_vertices != given->repatch.new_vertices)
    throw Error(ErrorCode::Unsupported, "a stream cannot hold an operation whose quads touch what is around them at a corner alone");
  for (std::size_t q = 0; q < glued.quad.size(); ++q) note_root(given->roots[glued.quad[q]], glued.turn[q]);
  ++next_operation_;
  return true;
}

}  // namespace hybrid_mesh
