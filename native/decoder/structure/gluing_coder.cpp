// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/structure/gluing_coder.h"

#include <algorithm>
#include <string>

#include "decoder/disjoint_sets.h"
#include "decoder/error.h"

namespace hybrid_mesh {

namespace {

using Kind = Repatch::Side::Kind;

[[noreturn]] void corrupt(const char* what) { throw Error(ErrorCode::CorruptStream, std::string("not a valid hierarchy stream: ") + what); }

enum Question { IsNext, IsNew, IsOuter, IsPrevious, IsOpen };

}  // namespace

// A way over quads. A side that is not glued yet is a gate; gates are chained to the loops that bound what was met so far.
class GluingWay {
 public:
  GluingWay(GluingCoder& coder, const QuadSides* given, const std::vector<OuterHalf>& outer, int halves)
      : c_(coder), given_(given), outer_(outer), taken_(outer.size(), 0), halves_(halves) {}
  GluedQuads go(int quads);

 private:
  struct Gate {
    int next = -1, previous = -1;
    int start_degree = 1;  // quads that are known around the vertex where it starts
    bool open = true;      // nothing is decided yet
    VertexId from;         // of the corner that it starts at, if an outer side has said it
  };

  bool ask(Question question, int gate, bool answer);
  int start_component();
  int step(int gate);
  int attach(int gate, int given_side);
  void glue(int a, int b);
  void link(int previous, int next, int degree, VertexId vertex);
  void name(int gate, VertexId from, VertexId to);
  void code_outer(int gate);
  void code_far(int gate);
  int wanted(int gate) const;  // writers: the side that a gate is glued to, -1 if it is not met yet or there is none
  const Repatch::Side& given_side(int gate) const { return (*given_)[result_.quad[gate / 4]][(gate + result_.turn[gate / 4]) % 4]; }
  Repatch::Side& side(int gate) { return result_.sides[gate / 4][gate % 4]; }
  void add_quad(int given_quad, int turn);
  GluedQuads finished();

  GluingCoder& c_;
  const QuadSides* given_;
  const std::vector<OuterHalf>& outer_;
  std::vector<char> taken_;
  int halves_;
  int quads_ = 0;
  GluedQuads result_;
  std::vector<Gate> gates_;      // 4 a quad
  std::vector<int> new_number_;  // writers: of given quads, -1
  std::size_t first_open_ = 0;
};

bool GluingWay::ask(Question question, int gate, bool answer) {
  const auto degree = [](int d) { return std::min(d, GluingCoder::degrees - 1); };
  const Gate& g = gates_[gate];
  const int end = degree(gates_[g.next].start_degree), start = degree(g.start_degree), ahead = degree(gates_[gates_[g.next].next].start_degree);
  GluingCoder::Decision& decision = c_.decisions_[question];
  const std::array<BitModel*, 3> models = {&decision.end[end], &decision.both[end * GluingCoder::degrees + start],
                                           &decision.ahead[end * GluingCoder::degrees + ahead]};
  return decision.mixer.code(*c_.coder_, answer, models);
}

void GluingWay::add_quad(int given_quad, int turn) {
  const auto number = static_cast<int>(result_.sides.size());
  result_.sides.emplace_back();
  gates_.resize(gates_.size() + 4);
  if (!given_) return;
  result_.quad.push_back(given_quad);
  result_.turn.push_back(turn);
  new_number_[given_quad] = number;
}

int GluingWay::start_component() {
  int seed = 0;
  if (given_) seed = static_cast<int>(std::find(new_number_.begin(), new_number_.end(), -1) - new_number_.begin());
  const auto first = static_cast<int>(gates_.size());
  add_quad(seed, 0);
  for (int s = 0; s < 4; ++s) gates_[first + s].next = first + (s + 1) % 4, gates_[first + s].previous = first + (s + 3) % 4;
  return first + 3;
}

int GluingWay::wanted(int gate) const {
  const Repatch::Side& s = given_side(gate);
  if (s.kind != Kind::Patch || new_number_[s.quad] < 0) return -1;
  const int quad = new_number_[s.quad];
  return 4 * quad + (s.side + 4 - result_.turn[quad]) % 4;
}

void GluingWay::link(int previous, int next, int degree, VertexId vertex) {
  gates_[previous].next = next;
  gates_[next].previous = previous;
  gates_[next].start_degree = degree;
  if (vertex.valid()) gates_[next].from = vertex;
}

// The ends of a gate are where it and the next one start.
void GluingWay::name(int gate, VertexId from, VertexId to) {
  gates_[gate].from = from;
  gates_[gates_[gate].next].from = to;
}

void GluingWay::glue(int a, int b) {
  side(a).kind = side(b).kind = Kind::Patch;
  side(a).quad = b / 4, side(a).side = b % 4;
  side(b).quad = a / 4, side(b).side = a % 4;
  gates_[a].open = gates_[b].open = false;
  const Gate ga = gates_[a], gb = gates_[b];
  // Of the vertex at which `before` ends, `at` starts and `after` goes on.
  const auto join = [&](int before, const Gate& at, int after) {
    link(before, after, at.start_degree + gates_[after].start_degree, at.from.valid() ? at.from : gates_[after].from);
  };
  const bool a_alone = ga.next == a, b_alone = gb.next == b;
  if (a_alone && b_alone) return;
  if (a_alone || b_alone) {
    const Gate &alone = a_alone ? ga : gb, &other = a_alone ? gb : ga;
    join(other.previous, alone, other.next);
    return;
  }
  // Where a starts, b ends, and the other way round; where one follows the other the vertex between them is closed.
  if (gb.next != a) join(ga.previous, ga, gb.next);
  if (ga.next != b) join(gb.previous, gb, ga.next);
}

// A new quad with its side 0 on the gate; its other sides take the gate's place.
int GluingWay::attach(int gate, int given_quad_side) {
  const auto first = static_cast<int>(gates_.size());
  add_quad(given_quad_side / 4, given_quad_side % 4);
  const Gate g = gates_[gate];
  side(gate) = {Kind::Patch, first / 4, 0, -1};
  side(first) = {Kind::Patch, gate / 4, gate % 4, -1};
  gates_[gate].open = gates_[first].open = false;
  const int after = g.next == gate ? first + 1 : g.next, before = g.previous == gate ? first + 3 : g.previous;
  const int after_degree = after == first + 1 ? 0 : gates_[after].start_degree + 1;
  link(before, first + 1, g.start_degree + 1, g.from);
  link(first + 1, first + 2, 1, {});
  link(first + 2, first + 3, 1, {});
  if (after_degree > 0) link(first + 3, after, after_degree, {});
  return first + 3;
}

void GluingWay::code_outer(int gate) {
  const VertexId from = gates_[gate].from, to = gates_[gates_[gate].next].from;
  const auto fits = [&](std::size_t i) { return !taken_[i] && ((from.valid() && outer_[i].from == from) || (to.valid() && outer_[i].to == to)); };
  HalfEdge half = given_ ? given_side(gate).half : -1;
  std::size_t expected = 0;
  while (expected < outer_.size() && !fits(expected)) ++expected;
  std::size_t place = outer_.size();
  for (std::size_t i = 0; i < outer_.size(); ++i)
    if (!taken_[i] && outer_[i].half == half) place = i;
  if (expected < outer_.size() && c_.expected_.code(*c_.coder_, place == expected)) {
    place = expected;
  } else if (c_.listed_.code(*c_.coder_, place < outer_.size())) {
    place = static_cast<std::size_t>(c_.far_.code(*c_.coder_, static_cast<std::int64_t>(place)));
    if (place >= outer_.size() || taken_[place]) corrupt("an outer side that there is not");
  } else {
    place = outer_.size();
    half = static_cast<HalfEdge>(c_.escaped_.code(*c_.coder_, half));
    if (half >= halves_) corrupt("a half-edge out of range");
  }
  side(gate) = {Kind::Outer, -1, 0, half};
  if (place < outer_.size()) {
    taken_[place] = 1;
    side(gate).half = outer_[place].half;
    name(gate, outer_[place].from, outer_[place].to);
  }
}

// A gate that is glued to one farther away: its place among those that are open.
void GluingWay::code_far(int gate) {
  std::vector<int> open;
  for (int g = static_cast<int>(first_open_); g < static_cast<int>(gates_.size()); ++g)
    if (gates_[g].open && g != gate) open.push_back(g);
  std::int64_t place = 0;
  if (given_) place = std::find(open.begin(), open.end(), wanted(gate)) - open.begin();
  place = c_.far_.code(*c_.coder_, place);
  if (place >= static_cast<std::int64_t>(open.size())) corrupt("a side that there is not");
  glue(gate, open[place]);
}

// Decides what is at a gate and returns the one to go on with, which may be decided already.
int GluingWay::step(int gate) {
  const Gate g = gates_[gate];
  const Kind kind = given_ ? given_side(gate).kind : Kind::Open;
  const int target = given_ ? wanted(gate) : -1;
  const bool full = static_cast<int>(result_.sides.size()) == quads_;
  if (halves_ > 0 && ask(IsOuter, gate, kind == Kind::Outer)) {
    code_outer(gate);
  } else if (g.next != gate && gates_[g.next].open && ask(IsNext, gate, target == g.next)) {
    glue(gate, g.next);
  } else if (!full && ask(IsNew, gate, kind == Kind::Patch && target < 0)) {
    int other = 0;
    if (given_) other = 4 * given_side(gate).quad + given_side(gate).side;
    return attach(gate, other);
  } else if (g.previous != g.next && gates_[g.previous].open && ask(IsPrevious, gate, target == g.previous)) {
    glue(gate, g.previous);
    return gates_[g.previous].previous;
  } else if (ask(IsOpen, gate, kind == Kind::Open)) {
    side(gate).kind = Kind::Open;
  } else {
    code_far(gate);
  }
  gates_[gate].open = false;
  return g.previous;
}

GluedQuads GluingWay::finished() {
  DisjointSets corners(4 * result_.sides.size());
  for (int g = 0; g < static_cast<int>(gates_.size()); ++g)
    if (const Repatch::Side& s = side(g); s.kind == Kind::Patch) corners.join(g, 4 * s.quad + (s.side + 1) % 4);
  std::vector<int> of_set(gates_.size(), -1);
  for (int g = 0; g < static_cast<int>(gates_.size()); ++g) {
    int& number = of_set[corners.find(g)];
    if (number < 0) number = result_.vertices++;
    result_.vertex.push_back(number);
  }
  return std::move(result_);
}

GluedQuads GluingWay::go(int quads) {
  quads_ = quads;
  if (given_) new_number_.assign(given_->size(), -1);
  int gate = -1;
  while (true) {
    while (first_open_ < gates_.size() && !gates_[first_open_].open) ++first_open_;
    if (gate < 0 || !gates_[gate].open) gate = first_open_ < gates_.size() ? static_cast<int>(first_open_) : -1;
    if (gate < 0 && static_cast<int>(result_.sides.size()) == quads_) return finished();
    gate = gate < 0 ? start_component() : step(gate);
  }
}

GluedQuads GluingCoder::code(const QuadSides* given, const std::vector<OuterHalf>& outer, int halves, int most_quads) {
  const std::int64_t quads = count_.code(*coder_, given ? static_cast<std::int64_t>(given->size()) : 0);
  if (quads > most_quads) corrupt("too many quads");
  // A question decides at most two of a quad's four sides, and takes at least 1/6000 bit, as no mixed bit is surer than 65528/65536.
  if (coder_->reads() && static_cast<std::uint64_t>(quads) > 3000 * coder_->bits_left()) throw StreamEnd();
  return GluingWay(*this, given, outer, halves).go(static_cast<int>(quads));
}

}  // namespace hybrid_mesh
