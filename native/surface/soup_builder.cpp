// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/soup_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

constexpr std::int64_t most_points = std::numeric_limits<std::int32_t>::max() - 1;

std::string words(const FilePlace& place) { return std::string(place.unit) + " " + std::to_string(place.number) + ": "; }

std::string words(double value) { return value != value ? "nan" : value < 0 ? "-inf" : "inf"; }

}  // namespace

void SoupBuilder::add_point(const Vec3& point) {
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(point[i]))
      throw Error(ErrorCode::InvalidInput, name_ + ": " + words(where_()) + "point " + std::to_string(point_count() + 1) +
                                               " has a coordinate that is not finite (" + words(point[i]) + ")");
  if (static_cast<std::int64_t>(point_count()) == most_points) throw Error(ErrorCode::Unsupported, name_ + ": too many points");
  soup_.points.push_back(point);
}

void SoupBuilder::add_corner(std::int64_t index) {
  if (index < 0) refuse_corner(faces_ + 1, where_());
  if (index >= static_cast<std::int64_t>(point_count()) && index > furthest_) {
    furthest_ = index;
    furthest_face_ = faces_ + 1;
    furthest_place_ = where_();
  }
  // One that does not fit is beyond all points, and never comes out of finish().
  soup_.indices.push_back(static_cast<std::int32_t>(std::min(index, most_points)));
}

void SoupBuilder::end_polygon() {
  ++faces_;
  const auto begin = static_cast<std::size_t>(soup_.offsets.back());
  if (soup_.indices.size() - begin < 3)
    soup_.indices.resize(begin);
  else
    soup_.offsets.push_back(static_cast<std::int64_t>(soup_.indices.size()));
}

PolygonSoup SoupBuilder::finish() {
  if (furthest_ >= static_cast<std::int64_t>(point_count())) refuse_corner(furthest_face_, furthest_place_);
  if (soup_.polygon_count() == 0) throw Error(ErrorCode::InvalidInput, name_ + ": no faces");
  return std::move(soup_);
}

void SoupBuilder::refuse(const std::string& cause) const { throw Error(ErrorCode::CorruptStream, name_ + ": " + words(where_()) + cause); }

void SoupBuilder::refuse_corner(std::uint64_t face, const FilePlace& place) const {
  throw Error(ErrorCode::InvalidInput, name_ + ": " + words(place) + "face " + std::to_string(face) + " has a point index out of range (there are " +
                                           std::to_string(point_count()) + " points)");
}

}  // namespace hybrid_mesh
