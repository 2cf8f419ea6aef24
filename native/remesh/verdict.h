// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "remesh/candidate.h"
#include "remesh/mesh_intersections.h"
#include "remesh/quality.h"

namespace hybrid_mesh {

// What makes a result poor.
struct Reason {
  std::string what;           // a short key
  std::string text;           // a sentence, with figures
  std::optional<Vec3> where;  // one place, the worst where there is one; of unit size as the candidate
  double severity = 1;        // times what would just be no reason; 1 where nothing is measured
};

// A finished remesh, and what of its final mesh is measured for the verdict only.
struct Finished {
  const RemeshTask& task;
  const Candidate& candidate;
  QuadQuality quality;
  double width = 0;          // see mean_width()
  SurfaceDistance distance;  // to the input as it was asked for: without components and noise, or made symmetric
  MeshIntersections intersections;
};
Finished measured(const RemeshTask& task, const Candidate& candidate, const Progress& progress);

// Why the input's sharp edges are not kept; empty where they are, or where there are none.
std::string why_features_are_lost(const RemeshTask& task, const Candidate& candidate);

// Everything that makes the result poor; empty for a good one.
std::vector<Reason> reasons_against(const Finished& finished);

// What is worth knowing but makes no result poor.
std::vector<std::string> warnings(const Finished& finished);

}  // namespace hybrid_mesh
