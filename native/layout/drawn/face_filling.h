// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "base/context.h"
#include "layout/disks/disk_layout.h"
#include "layout/drawn/drawn_layout.h"

namespace hybrid_mesh {

// What the quads have to fit where a layout is a part of another one.
struct FaceFillingOptions {
  std::vector<int>
      quads_at;  // per node of the layout: how many quads are to meet there, as far as may be; 0, or empty: from 3 to 6, on the boundary up to 4
  std::set<std::pair<int, int>> joined;  // nodes, each pair in both orders, that must not be joined by a new side, besides those that curves join
};

// Quads for the faces of a layout, nodes 0, 1, ... being those at the starts of a face's sides: one for a face of four sides; by fill_disk() and the
// face's angles at its nodes for a disk with a larger even number of sides; none for other faces.
std::vector<DiskLayout> find_fillings(const PatchLayout& layout, const FaceFillingOptions& options, const Progress& progress);

// Cuts the faces of a layout without problems along the sides of quads that fill them. The layout's nodes keep their numbers, and faces of four sides
// their order among the patches. Where there is no map of a face to draw them in, that is a problem of `drawn`, and nothing is returned; nor is for a
// layout that has problems.
PatchedSurface fill_faces(DrawnLayout& drawn, const FaceFillingOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
