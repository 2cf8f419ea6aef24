// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/conversions.h"

#include <cmath>
#include <limits>
#include <string>

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

// As a C-contiguous array of T, if its numbers are of one of the given kinds ("f" floating, "i" signed, "u" unsigned).
template <typename T>
py::array_t<T> numbers(const py::object& object, const char* name, const std::string& kinds, const char* what) {
  const py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    refuse(std::string(name) + " is no array");
  }
  // An empty list becomes an array of float64.
  if (array.size() > 0 && kinds.find(array.dtype().kind()) == std::string::npos) {
    refuse(std::string(name) + " must hold " + what + ", not " + py::str(array.dtype()).cast<std::string>());
  }
  auto converted = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!converted) throw py::error_already_set();
  return converted;
}

std::string shape_of(const py::array& array) { return py::str(array.attr("shape")).cast<std::string>(); }

}  // namespace

PolygonSoup soup_from_arrays(const py::object& points_object, const py::object& offsets_object, const py::object& indices_object) {
  const auto points = numbers<double>(points_object, "points", "fiu", "numbers");
  const auto offsets = numbers<std::int64_t>(offsets_object, "face_offsets", "iu", "whole numbers");
  const auto indices = numbers<std::int64_t>(indices_object, "face_indices", "iu", "whole numbers");
  if (points.size() == 0) refuse("the mesh has no points");
  if (points.ndim() != 2 || points.shape(1) != 3) refuse("points must have the shape (n, 3), not " + shape_of(points));
  if (offsets.ndim() != 1) refuse("face_offsets must have one dimension, not the shape " + shape_of(offsets));
  if (indices.ndim() != 1) refuse("face_indices must have one dimension, not the shape " + shape_of(indices));
  if (offsets.size() == 0) refuse("face_offsets must have one entry more than there are faces");
  if (offsets.size() == 1) refuse("the mesh has no faces");
  const std::int64_t point_count = points.shape(0);
  const std::int64_t limit = std::numeric_limits<std::int32_t>::max();
  if (point_count > limit || indices.size() > limit) refuse("the mesh has more than 2147483647 points or face corners");

  PolygonSoup soup;
  soup.points.resize(static_cast<std::size_t>(point_count));
  const double* p = points.data();
  for (std::int64_t i = 0; i < point_count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double value = p[3 * i + k];
      if (!std::isfinite(value)) refuse("point " + std::to_string(i) + " has a coordinate that is not finite");
      soup.points[i][k] = value;
    }
  }
  const std::int64_t* o = offsets.data();
  if (o[0] != 0) refuse("face_offsets must begin with 0, not " + std::to_string(o[0]));
  for (py::ssize_t f = 0; f + 1 < offsets.size(); ++f) {
    if (o[f + 1] < o[f]) refuse("face_offsets decrease at face " + std::to_string(f));
    if (o[f + 1] - o[f] < 3) refuse("face " + std::to_string(f) + " has fewer than three corners");
  }
  if (o[offsets.size() - 1] != indices.size()) {
    refuse("face_offsets end with " + std::to_string(o[offsets.size() - 1]) + ", but there are " + std::to_string(indices.size()) + " face_indices");
  }
  soup.offsets.assign(o, o + offsets.size());
  soup.indices.resize(static_cast<std::size_t>(indices.size()));
  const std::int64_t* index = indices.data();
  for (py::ssize_t i = 0; i < indices.size(); ++i) {
    if (index[i] < 0 || index[i] >= point_count) {
      refuse("face_indices[" + std::to_string(i) + "] is " + std::to_string(index[i]) + ", but there are " + std::to_string(point_count) + " points");
    }
    soup.indices[i] = static_cast<std::int32_t>(index[i]);
  }
  return soup;
}

PolygonSoup soup_from_arrays(const py::object& points, const py::object& offsets, const py::object& indices, const py::object& density) {
  PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  if (density.is_none()) return soup;
  const auto values = numbers<double>(density, "density", "fiu", "numbers");
  if (values.ndim() != 1) refuse("density must have one dimension, not the shape " + shape_of(values));
  soup.density.assign(values.data(), values.data() + values.size());
  return soup;
}

PolygonSoup soup_from_faces(const py::object& points, const py::object& faces) {
  const auto array = py::array::ensure(faces);
  if (!array || array.ndim() != 2 || array.shape(1) < 3) {
    PyErr_Clear();
    refuse("faces must have the shape (m, 3)");
  }
  std::vector<std::int64_t> offsets;
  for (py::ssize_t f = 0; f <= array.shape(0); ++f) offsets.push_back(f * array.shape(1));
  return soup_from_arrays(points, to_array(offsets), array.attr("ravel")());
}

std::vector<Vec3> vectors_from_array(const py::object& object, const char* name) {
  const auto array = numbers<double>(object, name, "fiu", "numbers");
  if (array.ndim() != 2 || array.shape(1) != 3) refuse(std::string(name) + " must have the shape (n, 3), not " + shape_of(array));
  std::vector<Vec3> vectors(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = Vec3(array.data()[3 * i], array.data()[3 * i + 1], array.data()[3 * i + 2]);
  return vectors;
}

py::tuple soup_to_arrays(const PolygonSoup& soup) {
  return py::make_tuple(rows_to_array<double>(soup.points), to_array(soup.offsets), to_array(soup.indices));
}

std::string path_from_python(const py::object& path) { return py::bytes(py::module_::import("os").attr("fsencode")(path)).cast<std::string>(); }

}  // namespace hybrid_mesh
