// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Where in a file a reader is: line 12 of a text, counted from 1, or byte 1234, counted from 0.
struct FilePlace {
  const char* unit = "byte";
  std::uint64_t number = 0;
};

// Makes a soup of what a reader finds, point by point and corner by corner, and keeps the rules that hold for every format: coordinates are finite,
// corners are points that there are, and there are faces. Whatever breaks one is refused with the place where it stands; a corner may name a point
// that comes later, so that only finish() knows of the last ones.
class SoupBuilder {
 public:
  // name: of the file, for messages; where: the place that the reader has got to.
  SoupBuilder(const std::string& name, std::function<FilePlace()> where) : name_(name), where_(std::move(where)) {}

  std::size_t point_count() const { return soup_.points.size(); }
  void reserve_points(std::uint64_t count) { soup_.points.reserve(soup_.points.size() + count); }
  void reserve_polygons(std::uint64_t count) { soup_.offsets.reserve(soup_.offsets.size() + count); }

  void add_point(const Vec3& point);
  // index: of a point, from 0
  void add_corner(std::int64_t index);
  // Polygons of fewer than three corners are left out.
  void end_polygon();
  PolygonSoup finish();

  // Throws Error{CorruptStream} with the place.
  [[noreturn]] void refuse(const std::string& cause) const;

 private:
  [[noreturn]] void refuse_corner(std::uint64_t face, const FilePlace& place) const;

  const std::string& name_;
  std::function<FilePlace()> where_;
  PolygonSoup soup_;
  std::uint64_t faces_ = 0;  // that have ended, those that were left out too
  // Of the corners that name points to come, the one that names the last.
  std::int64_t furthest_ = -1;
  std::uint64_t furthest_face_ = 0;
  FilePlace furthest_place_;
};

}  // namespace hybrid_mesh
