// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Tarini, Pietroni, Cignoni, Panozzo, Puppo, Practical quad mesh simplification, 2010 (triangles that are left are brought together by
// flips).
#pragma once

#include <vector>

#include "layout/base/decimation.h"

namespace hybrid_mesh {

// Where triangles are paired across feature curves: flips inner edges of the pieces between curves so that they find mates in their own piece. Three
// around a fourth, say, each with its other sides on curves, have none as they are. `mate`: per face, of one of the mesh's `faces`, the other
// triangle of its pair, or itself. Pairs are to be chosen anew afterwards. Flips are appended to `log`. Returns whether there are any.
bool pair_loose_triangles(EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<int>& faces,
                          std::vector<int> mate, std::vector<MeshEdit>& log);

// Would a flip fold the two triangles? One of them may have no area.
bool folds(const EditMesh& mesh, const std::vector<Vec3>& points, int h);

}  // namespace hybrid_mesh
