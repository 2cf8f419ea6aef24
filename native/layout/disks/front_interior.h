// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "base/context.h"
#include "layout/disks/disk_front.h"
#include "layout/disks/disk_layout.h"

namespace hybrid_mesh {

// A layout found, and what it costs.
struct DiskFilling {
  DiskLayout layout;
  int irregular = 0;  // inner nodes with other than four quads
  int quads() const { return static_cast<int>(layout.quads.size()); }
};
bool better(const DiskFilling& a, const std::optional<DiskFilling>& b);

// Whether no two nodes are joined twice, no quad has a node twice, and there is no boundary but the disk's.
bool is_disk_mesh(const DiskLayout& layout, int boundary_nodes);

// Fills the disk inside a front of inner nodes. Some of them take one quad more or less than four, so that the front turns by 3, 4 or 5 right angles.
// Nothing if no way is found.
std::optional<DiskFilling> fill_interior(const DiskFront& front, const Progress& progress);

}  // namespace hybrid_mesh
