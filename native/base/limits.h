// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

// How far settings and plans may go. Whoever else has to know a bound (the command line, Blender's properties) asks the Python module for it, whose
// limits() has every one of these by its name.
namespace hybrid_mesh::limits {

// Of the final mesh: vertices are numbered by 32-bit integers.
inline constexpr std::int64_t most_vertices = (std::int64_t{1} << 31) - 1;

// L2 distances and areas of components are fractions of the whole, which they are to stay below.
inline constexpr double end_of_error = 1;
inline constexpr double end_of_drop_components = 1;
inline constexpr double end_of_remove_noise = 1;

// Above the base: a quad has 4^12 descendants there, as many as fill the memory.
inline constexpr int most_levels = 12;

// More than any scan has triangles for.
inline constexpr int most_base_quads = 10000000;

// A square is stretched by 1, and beyond the other bound everything is.
inline constexpr double least_stretch_threshold = 1;
inline constexpr double most_stretch_threshold = 1e6;

// Degrees between the normals of two faces: below, the triangles of every curved face would count.
inline constexpr double least_feature_angle = 5;
inline constexpr double most_feature_angle = 175;

// Reports and plans hold it as JSON, whose numbers are exact up to here wherever they are read; bases that are tried one after another count on from
// it.
inline constexpr std::int64_t most_seed = (std::int64_t{1} << 53) - 1;

inline constexpr int most_threads = 1024;

// Of a tower.
inline constexpr int most_cubes = 1000;

// In a region that is laid out anew.
inline constexpr int most_even_quads = 1000000;

// Around a region that is laid out anew: so many reach around any surface that is worth it.
inline constexpr int most_buffer_rings = 100;

// Of the bounding-box diagonal: how far apart ends of strokes may be that are joined.
inline constexpr double most_snap = 0.5;

}  // namespace hybrid_mesh::limits
