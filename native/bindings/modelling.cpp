// SPDX-License-Identifier: GPL-3.0-or-later
// Hierarchies made and changed by scripts.
#include "subdivision/modelling.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/hierarchy.h"
#include "bindings/job.h"
#include "subdivision/completion.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

using Quads = std::vector<int>;
using Side = std::pair<int, int>;  // quad, side

PythonHierarchy from_quads(const py::object& points, const py::object& quads) {
  const PolygonSoup soup = soup_from_faces(points, quads);
  if (soup.offsets[1] != 4) refuse("quads must have the shape (m, 4)");
  std::vector<std::array<int, 4>> corners(soup.offsets.size() - 1);
  for (std::size_t q = 0; q < corners.size(); ++q)
    for (int i = 0; i < 4; ++i) corners[q][i] = soup.indices[4 * q + i];
  return {std::make_shared<const HybridMesh>(make_base(soup.points, corners)), ""};
}

void refine_to(PythonHierarchy& hierarchy, int level) {
  run_interruptibly([&](Context& context) {
    hierarchy.replace([&](const HybridMesh& mesh) { return refine(mesh, level, Progress(context)); });
    return true;
  });
}

void complete(PythonHierarchy& hierarchy) {
  run_interruptibly([&](Context& context) {
    hierarchy.replace([&](const HybridMesh& mesh) {
      // Maps know nothing of levels that were put elsewhere.
      return completed(mesh, hierarchy.notes().edited ? UnrefinedQuads::Subdivided : UnrefinedQuads::OnMaps, Progress(context));
    });
    return true;
  });
}

// Applies the operation that draft(const HybridMesh&) makes and returns its quads.
template <typename Draft>
py::array_t<int> change_by(PythonHierarchy& hierarchy, const Draft& draft) {
  return to_array(run_interruptibly([&](Context& context) {
    std::vector<int> roots;
    hierarchy.replace([&](const HybridMesh& mesh) {
      ChangedHierarchy changed = change(mesh, draft(mesh), Progress(context));
      roots = std::move(changed.roots);
      return std::move(changed.hierarchy);
    });
    return roots;
  }));
}

// -1: none was given.
HalfEdge half_edge_at(const HybridMesh& mesh, const std::optional<Side>& side) {
  if (!side) return -1;
  if (side->first < 0 || side->first >= mesh.node_count() || side->second < 0 || side->second > 3)
    refuse("there is no side " + std::to_string(side->second) + " of a quad " + std::to_string(side->first) + " to start from");
  return mesh.half_edge(side->first, side->second);
}

py::array_t<int> boundary_of(const PythonHierarchy& hierarchy, const Quads& quads, const std::optional<Side>& start) {
  return rows_to_array<int>(without_gil([&] {
    return hierarchy.locked([&](const HybridMesh& mesh) {
      const DiskRegion region = find_disk_region(mesh, quads, half_edge_at(mesh, start));
      if (!region.reason.empty()) refuse(region.reason);
      std::vector<std::array<int, 2>> sides;
      for (const SideLink& side : region.sides) sides.push_back({side.node, side.side});
      return sides;
    });
  }));
}

constexpr const char* kRefine = R"(Refines all quads until they have at least this level.

New points are placed by Catmull-Clark subdivision, level by level; points that are there stay. The final mesh is the finest level then.)";

constexpr const char* kComplete = R"(Refines all quads of an adaptive hierarchy until they are of one level.

That is the finest level there is; one more where hanging nodes have split quads in four.
Quads that are there stay where they are. What was not refined goes on where its maps have it, on the surface; without maps, and where levels were edited,
by Catmull-Clark subdivision of the level before. A uniform hierarchy stays as it is.)";

constexpr const char* kBoundary = R"(The sides around quads of one level that form a disk, counter-clockwise, as an array (n, 2) of quads and sides.

Side s of a quad runs from its corner s to the next. The first is `start`, or that of the first quad that has one.)";

constexpr const char* kAddCubes = R"(Grows a tower of cubes on quads that form a disk.

These are rings of quads around it, each as high as the quads' sides are long, and a copy of the quads on top.)";

constexpr const char* kConnect = R"(Removes two disks of quads that do not touch, and joins their boundaries by a tube.

The first side of boundary(region_a) faces that of boundary(region_b) with the number `turn`.)";

constexpr const char* kOpenBoundary = R"(Removes quads and leaves a hole.)";

constexpr const char* kFreeLayout = R"(Puts new quads in the place of quads that form a disk.

new_quads are (m, 4), counter-clockwise. Corners are 0 .. n - 1 where the n sides of boundary(quads, start) begin, and n .. for new points, which are
placed at the mean of their neighbours.)";

// What all operations have in common.
constexpr const char* kOperation = R"(

Quads are given by the numbers that level() has as "quad". They must be of one level, 1 or finer, and no root quads: those of the base and those that
operations made. The new quads are of the same level and are refined as others are; points on finer levels are placed by Catmull-Clark subdivision.
Returns the new quads' numbers. Raises InvalidInput with the reason if it cannot be done, and then nothing has changed. Numbers stay as they are while
the hierarchy is worked on, but not when it is saved and loaded.)";

}  // namespace

void bind_modelling(py::module_& module) {
  using py::arg;
  auto type = py::reinterpret_borrow<py::class_<PythonHierarchy>>(module.attr("Hierarchy"));
  type.def(py::init(&from_quads), arg("points"), arg("quads"),
           "A hierarchy of one level, N0: points (n, 3) and quads (m, 4), counter-clockwise, that are a 2-manifold.")
      .def("refine", &refine_to, arg("level"), kRefine)
      .def("complete", &complete, kComplete)
      .def("boundary", &boundary_of, arg("quads"), arg("start") = py::none(), kBoundary);
  const auto def_operation = [&](const char* name, const auto& function, const char* what, const auto&... arguments) {
    type.def(name, function, arguments..., (std::string(what) + kOperation).c_str());
  };
  def_operation(
      "add_cubes",
      [](PythonHierarchy& hierarchy, const Quads& quads, int height) {
        return change_by(hierarchy, [&](const HybridMesh& mesh) { return add_cubes(mesh, quads, height); });
      },
      kAddCubes, arg("quads"), arg("height") = 1);
  def_operation(
      "connect",
      [](PythonHierarchy& hierarchy, const Quads& region_a, const Quads& region_b, int turn) {
        return change_by(hierarchy, [&](const HybridMesh& mesh) { return connect(mesh, region_a, region_b, turn); });
      },
      kConnect, arg("region_a"), arg("region_b"), arg("turn") = 0);
  def_operation(
      "open_boundary",
      [](PythonHierarchy& hierarchy, const Quads& quads) {
        return change_by(hierarchy, [&](const HybridMesh& mesh) { return open_boundary(mesh, quads); });
      },
      kOpenBoundary, arg("quads"));
  def_operation(
      "free_layout",
      [](PythonHierarchy& hierarchy, const Quads& quads, const std::vector<std::array<int, 4>>& new_quads, const std::optional<Side>& start) {
        return change_by(hierarchy, [&](const HybridMesh& mesh) { return free_layout(mesh, quads, new_quads, half_edge_at(mesh, start)); });
      },
      kFreeLayout, arg("quads"), arg("new_quads"), arg("start") = py::none());
}

}  // namespace hybrid_mesh
