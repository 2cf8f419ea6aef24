// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Points and polygons without any promise about how they fit together. Polygon p has the corners
// indices[offsets[p]] .. indices[offsets[p + 1] - 1]; offsets has one entry more than there are polygons.
struct PolygonSoup {
  std::vector<Vec3> points;
  std::vector<std::int64_t> offsets{0};
  std::vector<std::int32_t> indices;
  std::vector<double> density;  // per point, of an attribute that was asked for (see density.h): in [0, 1]; empty: none

  std::size_t polygon_count() const { return offsets.size() - 1; }
};

// Reads .ply (ASCII, binary of both byte orders), .obj, .off or .stl, told apart by the extension (any case).
// Never trusts a count in the file: memory stays proportional to the file's size.
// Throws Error{Io} if the file cannot be read, Error{InvalidInput} or Error{CorruptStream} naming the file and the cause
// if it holds no usable mesh (no faces, an index out of range, a coordinate that is not finite, a truncated list).
// Polygons of fewer than three corners are left out, lines and points too; corners of .stl facets at the same position are one point.
// `density`: name of the property of points, in a .ply alone, that becomes the soup's density: numbers as they stand, those of one or two unsigned
// bytes as fractions of the largest; "color" is the brightness of red, green and blue where no property has that name. Throws Error{InvalidInput}
// with the name where the file has none, and Error{Unsupported} for other formats. Empty: none is read.
PolygonSoup read_polygon_soup(const std::string& path, const std::string& density = "");

enum class MeshFormat { Ply, Obj, Off, Stl };

// The same from memory; `name` stands for the file in messages.
PolygonSoup read_polygon_soup(std::string_view bytes, MeshFormat format, const std::string& name, const std::string& density = "");

// Writes .ply (binary, float64 positions when they need it, else float32) or .obj, told apart by the extension, to a temporary file
// beside `path` that is renamed when complete. Throws Error{Io} and leaves nothing behind on failure.
void write_polygon_soup(const PolygonSoup& soup, const std::string& path);

}  // namespace hybrid_mesh
