// SPDX-License-Identifier: GPL-3.0-or-later
// Loops that make a surface's genus, and surfaces with their topology closed.
#include <limits>
#include <optional>
#include <string>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/job.h"
#include "surface/repair.h"
#include "surface/topology_summary.h"
#include "topology/component_tubes.h"
#include "topology/topological_noise.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

TriangleSurface repaired(const PolygonSoup& soup, const Progress& progress) {
  RepairReport report;
  return repair(soup, RepairOptions(), report, progress);
}

std::vector<int> points_from(const py::handle& object) {
  const auto array = py::array_t<std::int64_t, py::array::forcecast>::ensure(object);
  if (!array || array.ndim() != 1) {
    PyErr_Clear();
    throw Error(ErrorCode::InvalidInput, "a given loop must be the numbers of its points");
  }
  std::vector<int> points;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    // What fits no int is no point either.
    const std::int64_t v = array.at(i);
    points.push_back(v < 0 || v > std::numeric_limits<int>::max() ? -1 : static_cast<int>(v));
  }
  return points;
}

std::vector<Vec3> stroke_from(const py::object& object) {
  const auto array = py::array_t<double, py::array::forcecast>::ensure(object);
  if (!array || array.ndim() != 2 || array.shape(1) != 3) {
    PyErr_Clear();
    throw Error(ErrorCode::InvalidInput, "a stroke must be (n, 3) coordinates");
  }
  std::vector<Vec3> stroke;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) stroke.emplace_back(array.at(i, 0), array.at(i, 1), array.at(i, 2));
  return stroke;
}

py::dict to_dict(const TriangleSurface& surface, const SurfaceLoop& loop) {
  std::vector<Vec3> positions;
  for (const int v : loop.points) positions.push_back(surface.points[v]);
  py::dict dict;
  dict["points"] = to_array(loop.points);
  dict["positions"] = rows_to_array<double>(positions);
  dict["length"] = loop.length;
  dict["kind"] = loop.kind == LoopKind::Handle ? "handle" : "tunnel";
  return dict;
}

double positive(double value, const char* name) {
  if (!(value > 0)) throw Error(ErrorCode::InvalidInput, std::string(name) + " must be above 0");
  return value;
}

py::list find_loops_of(const py::object& points, const py::object& offsets, const py::object& indices, const py::iterable& given, double detour,
                       std::optional<double> longest) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  std::vector<std::vector<int>> kept;
  for (const py::handle loop : given) kept.push_back(points_from(loop));
  LoopOptions options;
  options.detour = positive(detour, "detour");
  if (longest) options.longest = positive(*longest, "longest");
  std::vector<SurfaceLoop> found;
  const TriangleSurface surface = run_interruptibly([&](Context& context) {
    const Progress progress(context);
    TriangleSurface clean = repaired(soup, progress.part(0, 0.1));
    found = find_loops(clean, kept, options, progress.part(0.1, 1));
    return clean;
  });
  py::list loops;
  for (const SurfaceLoop& loop : found) loops.append(to_dict(surface, loop));
  return loops;
}

py::array_t<int> snap_loop_to(const py::object& points, const py::object& offsets, const py::object& indices, const py::object& stroke_object,
                              bool tighten) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  const std::vector<Vec3> stroke = stroke_from(stroke_object);
  const auto loop = run_interruptibly([&](Context& context) {
    const Progress progress(context);
    return snap_loop(repaired(soup, progress.part(0, 0.1)), stroke, tighten ? SnapTightening::Shortest : SnapTightening::None, progress.part(0.1, 1));
  });
  if (!loop) throw Error(ErrorCode::Unsupported, loop.reason);
  return to_array(*loop);
}

py::tuple close_noise_of(const py::object& points, const py::object& offsets, const py::object& indices, double length) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  positive(length, "length");
  int handles = 0;
  const PolygonSoup closed = run_interruptibly([&](Context& context) {
    const Progress progress(context);
    const ClosedNoise result = close_noise(repaired(soup, progress.part(0, 0.1)), length, progress.part(0.1, 1));
    handles = result.handles;
    return to_soup(result.surface);
  });
  return soup_to_arrays(closed) + py::make_tuple(handles);
}

// Everything closed: loops cut, components joined, boundaries capped.
py::tuple close_topology_of(const py::object& points, const py::object& offsets, const py::object& indices) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  const SurfaceSeries series = run_interruptibly([&](Context& context) {
    const Progress progress(context);
    const TriangleSurface surface = repaired(soup, progress.part(0, 0.1));
    std::vector<TopologyEvent> events;
    for (const SurfaceLoop& loop : find_loops(surface, {}, LoopOptions(), progress.part(0.1, 0.7)))
      events.push_back({EventKind::Cut, {loop.points, {}}, loop.length, loop.kind});
    for (TopologyEvent& event : find_boundary_events(surface)) events.push_back(std::move(event));
    for (TopologyEvent& event : find_tubes(surface, events, progress.part(0.7, 1))) events.push_back(std::move(event));
    return close_topology(surface, std::move(events));
  });
  py::list kinds;
  for (const TopologyEvent& event : series.events)
    kinds.append(event.kind == EventKind::Cut ? "cut" : event.kind == EventKind::Tube ? "tube" : "boundary");
  return soup_to_arrays(to_soup(series.closed)) + py::make_tuple(to_array(series.face_event), kinds);
}

}  // namespace

void bind_topology(py::module_& module) {
  using py::arg;
  module.def(
      "find_loops", &find_loops_of, arg("points"), arg("face_offsets"), arg("face_indices"), arg("given") = py::tuple(),
      arg("detour") = LoopOptions().detour, arg("longest") = py::none(),
      "Short disjoint loops that separate nothing together, one for each unit of genus, as a list of dicts: points (n,) int32, numbers of points of\n"
      "what repair() makes of the mesh; positions (n, 3); length, in the mesh's unit; kind, 'handle' or 'tunnel'. The loops of `given`, each the\n"
      "numbers of its points, come first and are kept as they are. detour: how many times longer than the shortest a loop may be if its cap meets\n"
      "the surface less. longest: longer loops are left out. InvalidInput names a given loop that cannot be kept; Unsupported: the triangles\n"
      "leave no room for as many loops.");
  module.def("snap_loop", &snap_loop_to, arg("points"), arg("face_offsets"), arg("face_indices"), arg("stroke"), arg("tighten") = true,
             "A closed stroke, (n, 3), as a simple cycle along edges near it: (n,) int32, numbers of points of what repair() makes of the mesh. "
             "tighten: it\n"
             "is replaced by shorter loops around the same handles. Unsupported: the stroke leaves the surface.");
  module.def("close_noise", &close_noise_of, arg("points"), arg("face_offsets"), arg("face_indices"), arg("length"),
             "Cuts and caps all handles and tunnels whose loops are shorter than `length`: (points, face_offsets, face_indices, how many).");
  module.def(
      "close_topology", &close_topology_of, arg("points"), arg("face_offsets"), arg("face_indices"),
      "The mesh cut along its loops and capped, components joined by tubes, boundaries capped: (points, face_offsets, face_indices, events, kinds).\n"
      "events (m,): of each face, -1 or the number of the event whose cap or tube it is; kinds: of each event, 'cut', 'boundary' or 'tube'.");
}

}  // namespace hybrid_mesh
