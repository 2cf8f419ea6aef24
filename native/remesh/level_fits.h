// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remesh/candidate.h"
#include "remesh/surface_fit.h"

namespace hybrid_mesh {

// Each makes `candidate.final_mesh` and fits it to the surface:
// a uniform mesh of one level;
void fit_uniform(const RemeshTask& task, Candidate& candidate, int level);
// an adaptive one within the options' bounds. `vertices`: what the budget allows.
void fit_adaptive(const RemeshTask& task, Candidate& candidate, std::int64_t vertices);

// Fits and measures all levels, of which the last is the final mesh.
void finish_levels(const RemeshTask& task, Candidate& candidate);

// Measures one of the candidate's levels and describes it for the report; the last one is the final mesh. `closed`: what it is fitted to where not
// all of the topology is open, or null.
void measure_level(const RemeshTask& task, Candidate& candidate, int level, const DistanceReference* closed, const Progress& progress);

// How a level is fitted: the finest one, or one whose quads are much larger than the shape's features.
SurfaceFitOptions level_fit(bool finest, int level);

}  // namespace hybrid_mesh
