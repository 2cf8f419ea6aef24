// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "remesh/candidate.h"

namespace hybrid_mesh {

// An entry of the report's "levels". `to_closed`: the distance to the surface with what has not opened on that level closed, where there is such.
nlohmann::ordered_json describe_level(const HybridMesh& hierarchy, int level, const QuadMesh& mesh, const SurfaceDistance& distance,
                                      const std::optional<SurfaceDistance>& to_closed);

// The report of a finished candidate, without file name, settings, seconds and memory. Throws Error{Internal} if the final mesh does not have the
// surface's topology.
nlohmann::ordered_json describe_remesh(const RemeshTask& task, const Candidate& candidate);

}  // namespace hybrid_mesh
