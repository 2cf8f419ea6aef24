// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/hierarchy.h"
#include "bindings/job.h"
#include "subdivision/limit_surface.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

// Points of the level where subdivision starts, by their indices.
using CreaseList = std::vector<std::tuple<std::int64_t, std::int64_t, double>>;
using CornerList = std::vector<std::pair<std::int64_t, double>>;

// What Python asks for.
struct Request {
  int from = 0, to = 0;
  bool limit = false;
  CreaseList creases;
  CornerList corners;
  std::vector<Vec3> points;  // empty: the level's own
  std::optional<std::vector<bool>> operations;
  bool semi_regular = false;  // no operations
  SubdivisionOptions options;
};

struct Answer {
  AnnotatedMesh mesh;
  std::vector<Vec3> normals;
};

void read_operations(const py::object& operations, Request& request) {
  if (py::isinstance<py::bool_>(operations)) {
    request.semi_regular = !operations.cast<bool>();
    return;
  }
  const char* const expected = "operations must be True, False, or a list of these, one for each operation";
  if (!py::isinstance<py::sequence>(operations) || py::isinstance<py::str>(operations)) refuse(expected);
  std::vector<bool> chosen;
  for (const py::handle choice : operations) {
    if (!py::isinstance<py::bool_>(choice)) refuse(expected);
    chosen.push_back(choice.cast<bool>());
  }
  request.operations = std::move(chosen);
}

template <class Enum>
Enum read_word(const char* name, const std::string& word, const std::vector<std::pair<const char*, Enum>>& words) {
  std::string all;
  for (const auto& [known, value] : words) {
    if (word == known) return value;
    all += std::string(all.empty() ? "'" : ", '") + known + "'";
  }
  refuse(std::string(name) + " must be one of " + all + ", not '" + word + "'");
}

VertexId vertex_at(const QuadMesh& level, std::int64_t point, const char* what, std::size_t number) {
  if (point >= 0 && point < static_cast<std::int64_t>(level.vertex.size())) return level.vertex[static_cast<std::size_t>(point)];
  refuse(std::string(what) + " " + std::to_string(number) + " names point " + std::to_string(point) + ", but the level has " +
         std::to_string(level.vertex.size()) + " points");
}

Answer answer(const HybridMesh& hierarchy, Request request, const Progress& progress) {
  if (request.from < 0 || request.from > hierarchy.depth()) refuse("there is no level N" + std::to_string(request.from));
  QuadMesh start = hierarchy.level_mesh(request.from);
  if (!request.points.empty()) {
    if (request.points.size() != start.points.size())
      refuse(std::to_string(request.points.size()) + " points for a level that has " + std::to_string(start.points.size()));
    start.points = std::move(request.points);
  }
  SubdivisionOptions& options = request.options;
  options.operations = std::move(request.operations);
  if (request.semi_regular) options.operations = operations_below(hierarchy, 0);
  for (std::size_t i = 0; i < request.creases.size(); ++i) {
    const auto& [a, b, sharpness] = request.creases[i];
    options.rules.creases.push_back({vertex_at(start, a, "crease", i), vertex_at(start, b, "crease", i), sharpness});
  }
  for (std::size_t i = 0; i < request.corners.size(); ++i)
    options.rules.vertices.push_back({vertex_at(start, request.corners[i].first, "corner", i), request.corners[i].second});
  SubdividedMesh subdivided = subdivide(hierarchy, start, request.from, request.to, options, progress.part(0, 0.5));
  Answer result;
  if (request.limit) {
    LimitSurface limit = limit_surface(subdivided.hierarchy, subdivided.mesh, subdivided.rules);
    subdivided.mesh.points = std::move(limit.points);
    result.normals = std::move(limit.normals);
  }
  progress(0.7);
  result.mesh = annotate(subdivided.hierarchy, VertexSources(subdivided.hierarchy), {}, std::move(subdivided.mesh));
  progress(1);
  return result;
}

py::dict subdivide_level(const PythonHierarchy& hierarchy, int from_level, int to_level, const py::object& operations, bool limit, CreaseList creases,
                         CornerList corners, const std::string& boundary, const std::string& operation_vertices, const py::object& points) {
  Request request;
  request.from = from_level;
  request.to = to_level;
  request.limit = limit;
  request.creases = std::move(creases);
  request.corners = std::move(corners);
  if (!points.is_none()) {
    request.points = vectors_from_array(points, "points");
    if (request.points.empty()) refuse("points is empty");
  }
  read_operations(operations, request);
  request.options.rules.boundary =
      read_word<BoundaryRule>("boundary", boundary, {{"edges", BoundaryRule::EdgesOnly}, {"edges_and_corners", BoundaryRule::EdgesAndCorners}});
  request.options.operation_vertices = read_word<OperationVertices>(
      "operation_vertices", operation_vertices,
      {{"stored", OperationVertices::Stored}, {"carried", OperationVertices::Carried}, {"harmonic", OperationVertices::Harmonic}});
  const Answer result = run_interruptibly([&](Context& context) {
    return hierarchy.locked([&](const HybridMesh& mesh) { return answer(mesh, std::move(request), Progress(context)); });
  });
  py::dict dict = to_dict(result.mesh);
  if (limit) dict["normals"] = rows_to_array<double>(result.normals);
  return dict;
}

constexpr const char* kDocumentation = R"(Catmull-Clark subdivision of a level, as a dict of arrays like that of level(to_level).

from_level, to_level  from N<from_level> to N<to_level>, which may be finer than the hierarchy's levels; an adaptive hierarchy is refined uniformly
operations            True: those of the hierarchy; False: none; a list of bool, one for each: those, without the ones that need a skipped one
limit                 points on the limit surface instead of control points, and the entry "normals", (n, 3)
creases               (point, point, sharpness) of edges, by indices of level("N<from_level>"); falls by one a level, 10 and more is infinite
corners               (point, sharpness) of points, in the same way
boundary              "edges": boundaries become smooth curves; "edges_and_corners": points of one quad stay where they are
operation_vertices    where operations put the points that they make: "stored": where the level has them; "carried": the same, moved along with
                      their surroundings; "harmonic": the mean of their neighbours
points                positions that take the place of those of level("N<from_level>"))";

}  // namespace

void bind_subdivision(py::module_& module) {
  using py::arg;
  const py::object type = module.attr("Hierarchy");
  type.attr("subdivide") =
      py::cpp_function(&subdivide_level, py::name("subdivide"), py::is_method(type), arg("from_level"), arg("to_level"), arg("operations") = true,
                       py::kw_only(), arg("limit") = false, arg("creases") = CreaseList(), arg("corners") = CornerList(), arg("boundary") = "edges",
                       arg("operation_vertices") = "stored", arg("points") = py::none(), kDocumentation);
}

}  // namespace hybrid_mesh
