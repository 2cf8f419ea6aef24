// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Touma, Gotsman, Triangle mesh compression, 1998 (the parallelogram rule), for quads.
#include "decoder/planes/base_points.h"

#include <array>
#include <cmath>

#include "decoder/error.h"

namespace hybrid_mesh {

namespace {

struct Prediction {
  int kind = 2;  // 0: quads around that are complete but for the vertex; 1: neighbours; 2: the vertex before
  std::array<std::int64_t, 3> value{0, 0, 0};
};

// From vertices with smaller numbers.
Prediction predict(const LevelMesh& mesh, const std::vector<std::vector<std::int64_t>>& corners_at, const std::vector<std::int32_t>& steps,
                   int vertex) {
  std::array<std::array<std::int64_t, 3>, 2> sum{};
  std::array<std::int64_t, 2> count{0, 0};
  for (const std::int64_t corner : corners_at[vertex]) {
    const std::int64_t first = corner / 4 * 4;
    const int next = mesh.indices[first + (corner + 1) % 4], across = mesh.indices[first + (corner + 2) % 4],
              last = mesh.indices[first + (corner + 3) % 4];
    for (int i = 0; i < 3; ++i) {
      if (next < vertex && across < vertex && last < vertex)
        sum[0][i] += static_cast<std::int64_t>(steps[3 * next + i]) + steps[3 * last + i] - steps[3 * across + i];
      if (next < vertex) sum[1][i] += steps[3 * next + i];
      if (last < vertex) sum[1][i] += steps[3 * last + i];
    }
    count[0] += next < vertex && across < vertex && last < vertex;
    count[1] += (next < vertex) + (last < vertex);
  }
  Prediction result;
  for (int kind = 0; kind < 2; ++kind) {
    if (count[kind] == 0) continue;
    result.kind = kind;
    for (int i = 0; i < 3; ++i) result.value[i] = sum[kind][i] / count[kind];
    return result;
  }
  for (int i = 0; i < 3 && vertex > 0; ++i) result.value[i] = steps[3 * (vertex - 1) + i];
  return result;
}

}  // namespace

double BasePoints::value(std::size_t i) const { return std::ldexp(steps[i] + (i < coded ? 0.5 : 1.0), -bits) - base_shift; }

void code_base_points(BitCoder& coder, const LevelMesh& mesh, BasePoints& known, int bits, const BasePoints* all) {
  std::array<NumberModel, 3> models;
  std::vector<std::vector<std::int64_t>> corners_at(mesh.vertex_count());
  for (std::size_t c = 0; c < mesh.indices.size(); ++c) corners_at[mesh.indices[c]].push_back(static_cast<std::int64_t>(c));
  known.bits = bits;
  known.steps.assign(3 * mesh.vertex_count(), 0);
  known.coded = known.steps.size();
  for (int v = 0; v < static_cast<int>(mesh.vertex_count()); ++v) {
    const Prediction prediction = predict(mesh, corners_at, known.steps, v);
    for (int i = 0; i < 3; ++i) {
      const std::int64_t target = all ? all->steps[3 * v + i] >> (all->bits - bits) : prediction.value[i];
      const std::int64_t value = prediction.value[i] + models[prediction.kind].code_signed(coder, target - prediction.value[i]);
      // So that no bits that follow lead out of 32.
      if (std::abs(value) > std::int64_t{1} << (bits + 4))
        throw Error(ErrorCode::CorruptStream, "not a valid hierarchy stream: a base vertex far away");
      known.steps[3 * v + i] = static_cast<std::int32_t>(value);
    }
  }
}

void refine_base_points(BitCoder& coder, BasePoints& known, const BasePoints* all) {
  ++known.bits;
  known.coded = 0;
  for (std::int32_t& steps : known.steps) steps *= 2;
  for (std::int32_t& steps : known.steps) {
    steps += coder.code_raw(all && ((all->steps[known.coded] >> (all->bits - known.bits)) & 1));
    ++known.coded;
  }
}

}  // namespace hybrid_mesh
