// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "surface/placement.h"
#include "surface/polygon_soup.h"
#include "surface/size_field.h"

namespace hybrid_mesh {

// By how much an attribute of this value, a weight in [0, 1], makes the edges of quads longer: 1 by 1/4, 0.5 by 1, 0 by 4, evenly in between. What
// lies beyond counts as 0 or 1. They are sizes beside one another: a mesh has as many vertices with them as without.
double size_at_density(double value);

// The sizes of quads that an attribute asks for.
struct Density {
  std::string name;                         // of the attribute; empty: there is none
  double smallest = 1, largest = 1;         // factors of edges' lengths, see size_at_density()
  std::int64_t outside = 0;                 // values that are not in [0, 1]
  std::vector<double> values;               // per point of the repaired surface
  std::shared_ptr<const SizeField> wanted;  // as the attribute has it, in unit size
  std::shared_ptr<const SizeField> sizes;   // what is made: the same, but no steeper than quads can follow. None: sizes are even
};

// Sizes per point of a placed surface, beside one another, as a field that grows no faster than quads can follow; what is small stays.
std::shared_ptr<const SizeField> gradual_sizes(const TriangleSurface& placed, std::vector<double> size);

// `name`: of the attribute that `input.density` holds. Points that repair merged have their mean, and what it cut apart has what was there. Throws
// Error{InvalidInput} with the name where values are not one a point, or not finite.
Density read_density(const PolygonSoup& input, const std::string& name, const TriangleSurface& repaired, const Placement& placement);

// How far the edges' lengths of a mesh of unit size are from those wanted: the median over its faces of |log(length / wanted)|, with the one factor
// for all that suits them best. 0: as wanted everywhere; 0.1: half of the faces are within a tenth.
double median_size_error(const QuadMesh& mesh, const SizeField& wanted);

// The report's `density`, of a mesh of unit size.
nlohmann::ordered_json describe_density(const Density& density, const QuadMesh& mesh);

}  // namespace hybrid_mesh
