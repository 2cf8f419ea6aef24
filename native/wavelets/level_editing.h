// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Multiresolution editing: one level gets other positions, and the others follow.
//
// The levels that are edited are those that are shown, each fitted to the surface for itself. So what is carried is an oversampled pyramid: of every
// vertex of a finer level the difference x_{j+1} - S x_j, in the local frame that S x_j has there, so that it turns and grows as the surface does.
// With the wavelet transform (wavelet_step.h) a level would not look as it was fitted, and a local edit would reach everywhere, because analysis
// solves a system. A pyramid needs no solution: subdivision is local. Where the star of a vertex in S x_j is, bit by bit, what it was, the vertex is
// not touched.
//
// - A level that is set to what it was changes nothing, and far from an edit nothing changes: byte for byte.
// - A similarity of a whole level is one of all finer levels and of the final mesh, up to rounding.
// - An operation's vertices follow its boundary: their differences from its harmonic extension turn with the harmonic mean of its stars' motions.
//   Those that an operation takes away (M^j has them, N^j has not) follow in the same way if N^j is edited.
// - The final mesh follows the finest level.
//
// Of an adaptive hierarchy, what is not refined stays with its vertices of the coarser level. Vertices that the closure of leaves makes carry nothing
// to a finer level where these leaves are refined.
enum class CoarserLevels {
  Stay,
  // By analysis: of a coarser level the differences from the low-pass of the finer one (wavelet_step.h) are carried in the low-pass's local frames.
  // This reaches as far as analysis does; what moves by less than tolerance::same_place stays where it is.
  Follow
};

struct LevelEdit {
  int level = 0;
  LevelKind kind = LevelKind::N;
  std::vector<Vec3> points;  // of level_mesh(level, kind), in the order of its vertices
  CoarserLevels coarser = CoarserLevels::Stay;
};

// The hierarchy with the edit; structure and maps are the same. Throws Error{InvalidInput} if there is no such level, or if points are too few, too
// many or not finite.
HybridMesh edited(const HybridMesh& hierarchy, const LevelEdit& edit, const Progress& progress);

}  // namespace hybrid_mesh
