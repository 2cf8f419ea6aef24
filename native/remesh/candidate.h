// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/found.h"
#include "construction/construction.h"
#include "hierarchy/hybrid_mesh.h"
#include "layout/search/base_map.h"
#include "remesh/budget.h"
#include "remesh/plan.h"
#include "surface/distance.h"

namespace hybrid_mesh {

// One remesh of the source, of unit size, with all that belongs to it: of several candidates one is kept whole.
struct Candidate {
  HybridMesh hierarchy;        // with its maps; refined as far as it has been fitted
  std::string plan;            // JSON text
  std::vector<int> plan_root;  // see RemeshResult
  std::vector<int> opened;     // see RemeshResult
  int base_quads = 0, base_vertices = 0;
  bool base_given = false;  // by a plan
  int levels = 0;           // above the base, of a uniform mesh

  // The last level with operations (0: none), all of whose quads have a map of their own.
  int finest = 0;
  std::int64_t finest_quads = 0, finest_boundary_sides = 0;  // of a half: with its mirror image
  std::vector<VertexId> finest_irregular;                    // sorted
  std::vector<int> opened_on;                                // per event of the topology: the level
  std::vector<std::pair<int, std::string>> unopened;         // events of the topology that found no room above the base, and why
  std::vector<std::string> waited;                           // per event: why it opened no sooner; empty with a plan
  bool keeps_features = false;                               // are sharp edges of the surface sides of the base?
  bool by_need = false;                                      // are its quads smaller where an earlier mesh was poor?
  std::string lost_operations;                               // of a half: why it has no irregular operations, where it would have some
  std::string lost_features;                                 // why they are not; empty: they are, or there are none

  QuadMesh final_mesh;                                // fitted
  std::vector<QuadMesh> level_meshes;                 // of every level, fitted; the last is the final mesh
  std::vector<nlohmann::ordered_json> level_reports;  // see the report's "levels"
  SurfaceDistance distance;                           // of the final mesh
};

// A search for a base domain and a map to it. What is tried, one after the other, for as long as no map is found.
struct BaseRequest {
  std::uint64_t seed = 0;  // decides near-ties
  int size_factor = 1;     // of a minimal base: more quads where a map to fewer cannot be had
  bool base_edits = true;  // a minimal base's own quads are improved as well: slow where there are few, but a map to them holds more often
  bool operations = true;  // with a minimal base: irregular operations on a finer level
};
// Eight of them. `another`: others than those of the first time.
std::vector<BaseRequest> base_requests(const RemeshOptions& options, bool another);

// Does the source have sharp edges that a base can keep? Where topology opens late, surface is exchanged, which knows of none.
bool keeps_features(const RemeshTask& task);

struct CandidateSearch {
  Found<Candidate> candidate;
  std::int64_t too_many = 0;  // vertices that are needed at least, where only meshes of more than allowed were found
};
// The first of the requests that gives a map, and, with a bound on the vertices, a uniform mesh within it; the number of levels falls until it does.
CandidateSearch search_candidate(const RemeshTask& task, const Target& target, const std::vector<BaseRequest>& requests);

// What a plan says: made again as it was on the surface that the plan was made on, else laid out on this one. Throws Error.
Candidate planned_candidate(const RemeshTask& task, const Plan& plan);

// Does further irregular operations and returns them as a plan has them.
using Operations = std::function<std::vector<Plan::Region>(Construction& made)>;

// The construction of a base, whose quads get their maps. `working`: the surface that the map is of. Throws NoMap where the map does not hold.
Construction construct(const RemeshTask& task, const WorkingSurface& working, BaseMap map);
// It and what was decided, as a candidate. Throws what `operations` throws.
Candidate assemble_candidate(const RemeshTask& task, const WorkingSurface& working, Construction made, const std::optional<Plan::Origin>& origin,
                             const Operations& operations);

// A working surface that is made again only where another size of triangles is asked for.
class WorkingSurfaceInUse {
 public:
  const WorkingSurface& of_size(const RemeshTask& task, std::int64_t faces);
  // The one that a plan's origin tells of, with the features that it keeps.
  const WorkingSurface& of(const RemeshTask& task, const Plan::Origin& origin);

 private:
  const WorkingSurface& made(const RemeshTask& task, std::int64_t faces, Features features, double angle);

  WorkingSurface surface_;
  std::int64_t faces_ = -1;
  Features features_ = Features::None;
};

// The base domain that a plan's origin tells of, on the surface of the size that it names.
BaseDomain make_base(const RemeshTask& task, const Plan::Origin& origin, WorkingSurfaceInUse& working);

// The names of the inner vertices of a mesh where other than four faces meet, sorted.
std::vector<VertexId> irregular_names(const QuadMesh& mesh);

}  // namespace hybrid_mesh
