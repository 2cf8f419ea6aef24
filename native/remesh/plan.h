// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "layout/base/base_domain.h"
#include "layout/drawn/boundary_tower.h"
#include "layout/layout_outline.h"
#include "layout/operations/region_repatch.h"
#include "layout/search/layout_script.h"
#include "remesh/remesh.h"
#include "remesh/working_surface.h"
#include "topology/surface_series.h"

namespace hybrid_mesh {

// A level of a plan with operations has at most so many quads: deeper ones take more memory than there is, and no operation is meant there.
constexpr std::int64_t kMostPlanQuads = std::int64_t{1} << 22;

// What decides the quads of a remesh: where the base domain's quads lie in space, and the irregular operations by their place in the hierarchy.
// Nothing in it refers to the input's numbering, so that it can be carried out on any surface of about the same shape.
struct Plan {
  // How the base came about on the surface that the plan was made on. On that surface it is made in the same way again; on others the outline is laid
  // out.
  struct Origin {
    std::string surface;                 // its fingerprint()
    std::int64_t faces = 0;              // see make_working_surface()
    Features features = Features::None;  // that the base keeps
    double feature_angle = 0;            // with Features::Given
    BaseDomainOptions base;
    LayoutScript script;                 // the base's edits
    std::optional<BoundaryTower> tower;  // instead of all but the surface: in the input's space
  };
  // Quads of one level, laid out anew; see RegionRepatch.
  struct Region {
    int level = 0;
    std::vector<std::string> quads;  // addresses
    RegionPattern pattern;           // in the input's space
    // The addresses of quads, and their sides that begin at the first corners of the region's first rims; see make_region(). Empty: any.
    std::vector<std::pair<std::string, int>> starts;
    std::vector<int> opens;  // events of the plan's topology that open there
    int buffer_rings = 1;
  };
  // Something of the topology that is closed on the base, and opens on a finer level; see TopologyEvent.
  struct Event {
    EventKind kind = EventKind::Cut;
    std::vector<std::vector<Vec3>> loops;  // two of a tube, else one: in the input's space
    int level = -1;                        // on which it opens; -1: the first that has room
  };
  std::vector<Event> topology;
  // Nothing but the topology is given: the base is searched.
  bool has_base() const { return tower || !base.quads.empty(); }
  LayoutOutline base;                  // in the input's space
  std::optional<BoundaryTower> tower;  // instead of the base: in the input's space
  std::optional<Origin> origin;
  std::vector<Region> regions;
};

// JSON text. Throws Error{InvalidInput}, with the place in the text, for what is no plan.
std::string to_json(const Plan& plan);
Plan plan_from_json(const std::string& text);
// One of a plan's "operations" by itself.
Plan::Region plan_region_from_json(const std::string& text);

}  // namespace hybrid_mesh
