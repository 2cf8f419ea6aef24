// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "surface/polygon_soup.h"
#include "surface/repair.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {

// Bytes in any state are either a mesh, which can then be repaired to an oriented manifold, or an Error. Everything else is a finding.
inline void read_and_repair(const std::uint8_t* data, std::size_t size, MeshFormat format) {
  try {
    const PolygonSoup soup = read_polygon_soup(std::string_view(reinterpret_cast<const char*>(data), size), format, "fuzzed");
    if (soup.indices.size() > 20000) return;
    Context context;
    RepairReport report;
    const TriangleSurface surface = repair(soup, {}, report, Progress(context));
    const TopologySummary t = summarize_topology(to_soup(surface));
    if (t.nonmanifold_edges || t.nonmanifold_vertices || t.misoriented_edges || t.genus != std::floor(t.genus) || t.genus < 0) std::abort();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::Internal || std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace hybrid_mesh
