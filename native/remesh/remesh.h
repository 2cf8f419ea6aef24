// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "surface/polygon_soup.h"
#include "surface/reflection.h"
#include "surface/repair.h"

namespace hybrid_mesh {

enum class Refinement { Uniform, Adaptive };
// Whether a base is made for each component, or one for all, which tubes join until they part on finer levels.
enum class Components { Apart, Joined };
// Where the topology that the base domain need not have opens: on finer levels, or in the base. Auto: late with a minimal base.
enum class TopologyMode { Auto, Late, Base };
enum class BaseSize { Auto, Minimal, Given };
// Whether sharp edges are kept. Auto: where the surface has flat or smooth faces that meet at angles; Given: all edges from an angle on.
enum class Features { Auto, None, Given };
// Whether the mesh is made its own mirror image. Auto: in the plane in which the surface nearly is, if there is one; Given: in RemeshOptions::mirror.
enum class Symmetry { None, Auto, Given };
// What is mirrored: the surface on the side of the plane that its normal points to, on the other, or the mean of both.
enum class SymmetrySide { Positive, Negative, Average };

// What is tried where the first mesh is poor. Quick: nothing. Normal: other bases and smaller quads where they are needed, a few times, but not of
// large surfaces and bases, of which a mesh takes long. Thorough: of these, too, and more often.
enum class Effort { Quick, Normal, Thorough };

struct RemeshOptions {
  std::int64_t vertices = 0;  // hard upper bound on the final mesh's vertices; 0 = none
  double error = 0;           // stop at this l2 (relative to the bounding-box diagonal); 0 = none
  int levels = -1;            // uniform: exactly, adaptive: at most so many regular levels; -1 = as many as the budget needs
  Refinement refinement = Refinement::Uniform;
  FaceClosure faces = FaceClosure::Quads;  // what becomes of leaves with hanging nodes (adaptive)
  BaseSize base = BaseSize::Auto;
  int base_quads = 0;  // with BaseSize::Given
  TopologyMode topology = TopologyMode::Auto;
  Components components = Components::Apart;
  double remove_noise = 0;       // handles and tunnels with shorter loops, as a fraction of the bounding-box diagonal, are closed for good
  double stretch_threshold = 4;  // above it skin is grown (irregular operations)
  bool semi_regular = false;     // no irregular operations
  Features features = Features::Auto;
  double feature_angle = 40;  // degrees between the normals of two faces; with Features::Given
  Symmetry symmetry = Symmetry::None;
  MirrorPlane mirror;  // where the input stands; with Symmetry::Given
  SymmetrySide symmetry_side = SymmetrySide::Positive;
  Effort effort = Effort::Normal;
  double drop_components = 0;  // see RepairOptions
  std::string density;         // name of the attribute that the input's `density` holds, see density.h; empty: quads are even
  bool strict = false;         // refuse input that needs repair
  std::uint64_t seed = 1;
  std::string plan;  // JSON text, see Plan: what decides base and operations instead of a search; empty: none
  int threads = 0;   // 0 = all cores; never changes the result
};

struct RemeshResult {
  HybridMesh hierarchy;  // with its patch maps
  QuadMesh final_mesh;
  TriangleSurface repaired;       // what the maps' source faces refer to
  std::string plan;               // JSON text: what was decided. With it, and the same other options, the same surface gives the same result
  std::vector<int> plan_root;     // per node: number of a root quad in the addresses of the plan, -1 for other nodes
  std::vector<int> opened;        // per node: of a root quad, the event of the plan's topology that opened where it was put in; -1: none
  nlohmann::ordered_json report;  // `NAME.report.json` without file name, settings and memory
};

// Remeshes a polygon soup. Runs on the calling thread and TBB's. Throws Error.
RemeshResult remesh(PolygonSoup input, const RemeshOptions& options, Context& context);

}  // namespace hybrid_mesh
