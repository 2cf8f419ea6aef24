// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Copies a mesh out of Python's arrays (anything that numpy makes an array of). Throws Error{InvalidInput} that says which array, and what
// of its type, shape or values cannot be used.
PolygonSoup soup_from_arrays(const pybind11::object& points, const pybind11::object& offsets, const pybind11::object& indices);

// The same with the values of an attribute that is the density of quads, one a point; none where it is None.
PolygonSoup soup_from_arrays(const pybind11::object& points, const pybind11::object& offsets, const pybind11::object& indices,
                             const pybind11::object& density);

// The same with faces of as many corners each, (m, corners) indices.
PolygonSoup soup_from_faces(const pybind11::object& points, const pybind11::object& faces);

// Rows of three numbers, (n, 3), which may be none, infinite or not a number. Throws Error{InvalidInput} that names the array.
std::vector<Vec3> vectors_from_array(const pybind11::object& array, const char* name);

// (points, offsets, indices)
pybind11::tuple soup_to_arrays(const PolygonSoup& soup);

// A str, bytes or os.PathLike, in the file system's encoding.
std::string path_from_python(const pybind11::object& path);

// A one-dimensional copy.
template <typename T>
pybind11::array_t<T> to_array(const std::vector<T>& values) {
  return pybind11::array_t<T>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

// A copy of n x m numbers from a contiguous vector of small fixed-size arrays or Eigen vectors.
template <typename T, typename Row>
pybind11::array_t<T> rows_to_array(const std::vector<Row>& rows) {
  static_assert(sizeof(Row) % sizeof(T) == 0 && std::is_trivially_destructible_v<Row>);
  constexpr pybind11::ssize_t columns = sizeof(Row) / sizeof(T);
  pybind11::array_t<T> array({static_cast<pybind11::ssize_t>(rows.size()), columns});
  const T* first = reinterpret_cast<const T*>(rows.data());
  std::copy(first, first + rows.size() * columns, array.mutable_data());
  return array;
}

// Calls native code that touches no Python object, with the interpreter's lock released. Whatever it throws that is neither an Error nor
// a lack of memory becomes Error{Internal}, so that callers need to know one family of exceptions only.
template <typename Function>
auto without_gil(Function&& function) -> decltype(function()) {
  const pybind11::gil_scoped_release release;
  try {
    return function();
  } catch (const Error&) {
    throw;
  } catch (const NoMap& none) {
    throw Error(ErrorCode::Unsupported, none.what());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::Internal, error.what());
  }
}

}  // namespace hybrid_mesh
