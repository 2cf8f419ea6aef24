// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/region_update.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/found.h"
#include "base/parallel.h"
#include "construction/construction.h"
#include "remesh/level_fits.h"
#include "remesh/plan_regions.h"
#include "remesh/surface_samples.h"

namespace hybrid_mesh {
namespace {

// Whether each node is one of some or below one of them.
std::vector<char> trees_of(const HybridMesh& h, const std::vector<int>& nodes) {
  std::vector<char> in(h.node_count(), 0);
  std::vector<int> stack = nodes;
  while (!stack.empty()) {
    const int n = stack.back();
    stack.pop_back();
    in[n] = 1;
    if (h.first_child(n) < 0) continue;
    for (int k = 0; k < 4; ++k)
      if (h.is_active(h.first_child(n) + k)) stack.push_back(h.first_child(n) + k);
  }
  return in;
}

// How many levels the leaves below some quads are finer than these, on average over their area.
int mean_depth(const HybridMesh& h, const std::vector<int>& quads) {
  const std::vector<char> in = trees_of(h, quads);
  std::int64_t leaves = 0;
  for (int n = 0; n < h.node_count(); ++n) leaves += in[n] && h.is_leaf(n);
  return static_cast<int>(std::lround(std::log2(static_cast<double>(leaves) / static_cast<double>(quads.size())) / 2));
}

void refine_below(HybridMesh& h, std::vector<int> quads, int levels) {
  for (; levels > 0; --levels) {
    std::vector<int> children;
    for (const int n : quads) {
      const int first = h.refine(n);
      for (int k = 0; k < 4; ++k) children.push_back(first + k);
    }
    quads = std::move(children);
  }
}

// The faces of a mesh under some nodes, as a mesh of their own. Vertices where other faces have them too are marked.
QuadMesh part_of(const QuadMesh& mesh, const std::vector<char>& in, std::vector<char>& on_rim) {
  QuadMesh part;
  std::vector<int> number(mesh.points.size(), -1);
  std::vector<char> outside(mesh.points.size(), 0);
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
      if (!in[mesh.node[f]]) outside[mesh.indices[i]] = 1;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    if (!in[mesh.node[f]]) continue;
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) {
      const int v = mesh.indices[i];
      if (number[v] < 0) {
        number[v] = static_cast<int>(part.points.size());
        part.points.push_back(mesh.points[v]);
        part.vertex.push_back(mesh.vertex[v]);
        part.location.push_back(mesh.location[v]);
        on_rim.push_back(outside[v]);
      }
      part.indices.push_back(number[v]);
    }
    part.offsets.push_back(static_cast<std::int64_t>(part.indices.size()));
    part.node.push_back(mesh.node[f]);
    part.root.push_back(mesh.root[f]);
  }
  return part;
}

// The part of a level that has new maps, fitted to the surface; its rim stays where it is.
QuadMesh fitted_part(const HybridMesh& h, const QuadMesh& mesh, const std::vector<int>& mapped, const SurfaceFitOptions& options,
                     const Placement& placement, const Progress& progress) {
  std::vector<char> on_rim;
  QuadMesh part = part_of(mesh, trees_of(h, mapped), on_rim);
  const std::vector<Vec3> before = part.points;
  for (std::size_t v = 0; v < part.points.size(); ++v)
    if (!on_rim[v]) part.points[v] = h.sample(part.location[v]).position;
  const SurfaceSamples samples(h, mapped, fit_sample_count(part.points.size()), options.finest);
  std::vector<FitSample> on = samples.on(h, part);
  for (FitSample& s : on) s.position = placement.to_unit(s.position);
  for (Vec3& p : part.points) p = placement.to_unit(p);
  fit_to_samples(part, std::move(on), parameter_shares(h, part), options, progress);
  for (std::size_t v = 0; v < part.points.size(); ++v) part.points[v] = on_rim[v] ? before[v] : placement.from_unit(part.points[v]);
  return part;
}

}  // namespace

RegionUpdate repatch_hierarchy(const HybridMesh& hierarchy, const std::vector<int>& root_numbers, const Plan::Region& region,
                               const Progress& progress) {
  const int depth = hierarchy.depth();
  if (region.level > depth)
    throw Error(ErrorCode::InvalidInput, "the hierarchy has no level " + std::to_string(region.level) + ": its finest is " + std::to_string(depth));
  const bool uniform = hierarchy.conforming();
  Construction made(hierarchy, root_numbers, region.level);
  const Placement placement = made.state().placement;
  const RegionRepatch repatch = resolved(region, made.quads());
  for (const int q : repatch.patches)
    if (made.hierarchy().is_root(made.node(q)))
      throw Error(ErrorCode::InvalidInput, "quad " + to_string(made.quads().address(q)) + " was put in by another operation of level " +
                                               std::to_string(region.level) + ": select quads beside it, or of a finer level");
  std::vector<int> removed;
  for (const int q : repatch.patches) removed.push_back(made.node(q));
  const int levels_above = uniform ? depth - region.level : mean_depth(made.hierarchy(), removed);
  RegionUpdate out;
  std::vector<int> patches;
  Found<MappedEdit> edit = found([&] { return repatch_region(made.state(), repatch, progress.part(0, 0.6)); });
  if (!edit) throw Error(ErrorCode::Unsupported, "no map to the region's new quads is found: " + edit.reason);
  out.energy_before = edit->energy_before;
  out.energy_after = edit->energy_after;
  for (const auto& [q, map] : edit->maps) patches.push_back(q);
  made.apply(std::move(*edit));
  made.close();
  HybridMesh& h = made.hierarchy();
  out.operation = h.operation_count() - 1;
  refine_below(h, h.operation(out.operation).roots, levels_above);
  if (!uniform) h.balance();
  std::vector<int> mapped;
  for (const int q : patches) mapped.push_back(made.node(q));
  // Fits are independent: each reads the hierarchy and moves its own level.
  const int levels = h.depth() - region.level + 1;
  std::vector<QuadMesh> parts(levels + 1);
  out.levels.resize(levels);
  parallel_for_each_index(levels + 1, [&](std::int64_t i) {
    const int k = static_cast<int>(i);
    const bool last = k == levels;
    const int level = last ? h.depth() : region.level + k;
    const QuadMesh mesh = last ? h.final_mesh() : h.level_mesh(level);
    if (!last) out.levels[k] = {level, static_cast<std::int64_t>(mesh.points.size()), static_cast<std::int64_t>(mesh.face_count())};
    parts[k] = fitted_part(h, mesh, mapped, level_fit(level == h.depth(), level), placement, progress.part(0.6, 0.6));
  });
  for (int k = 0; k < levels; ++k) h.set_level_positions(region.level + k, parts[k]);
  h.set_final_positions(parts[levels]);
  out.root_numbers = made.root_numbers();
  out.hierarchy = std::move(h);
  progress(1);
  return out;
}

}  // namespace hybrid_mesh
