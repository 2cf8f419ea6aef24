// SPDX-License-Identifier: GPL-3.0-or-later
// Loops that make a surface's genus, and surfaces with their topology closed.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/job.h"
#include "surface/repair.h"
#include "surface/topology_summary.h"
#include "topology/component_tubes.h"
#include "topology/loop_search.h"
#include "topology/topological_noise.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

TriangleSurface repaired(const PolygonSoup& soup, const Progress& progress) {
  RepairReport report;
  return repair(soup, RepairOptions(), report, progress);
}

// (n, 3) finite coordinates.
std::vector<Vec3> line_from(const py::handle& object, const std::string& what) {
  const auto array = py::array_t<double, py::array::forcecast>::ensure(object);
  if (!array || array.ndim() != 2 || array.shape(1) != 3 || array.shape(0) < 2) {
    PyErr_Clear();
    throw Error(ErrorCode::InvalidInput, what + " must be (n, 3) coordinates of two points at least");
  }
  std::vector<Vec3> line;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) line.emplace_back(array.at(i, 0), array.at(i, 1), array.at(i, 2));
  return line;
}

EarlierLoop loop_from(const py::handle& object, const std::string& what) {
  if (!py::isinstance<py::dict>(object)) throw Error(ErrorCode::InvalidInput, what + " must be a dict with points and drawn");
  const auto dict = py::reinterpret_borrow<py::dict>(object);
  for (const char* key : {"points", "drawn"})
    if (!dict.contains(key)) throw Error(ErrorCode::InvalidInput, what + " has no " + key);
  return {line_from(dict["points"], what), py::bool_(dict["drawn"])};
}

std::string name_of(const char* what, std::size_t number) { return std::string(what) + " " + std::to_string(number + 1); }

struct LoopWork {
  PolygonSoup soup;
  LoopRequest request;
};

struct FoundLoops {
  std::vector<RequestedLoop> loops;
  std::vector<std::vector<Vec3>> positions;
};

LoopWork loop_work_from(const py::object& points, const py::object& offsets, const py::object& indices, const py::iterable& loops,
                        const py::iterable& strokes, double detour, std::optional<double> longest) {
  LoopWork work{soup_from_arrays(points, offsets, indices), {}};
  LoopRequest& request = work.request;
  for (const py::handle loop : loops) request.loops.push_back(loop_from(loop, name_of("loop", request.loops.size())));
  for (const py::handle stroke : strokes) request.strokes.push_back(line_from(stroke, name_of("stroke", request.strokes.size())));
  if (!(detour > 0)) throw Error(ErrorCode::InvalidInput, "detour must be above 0");
  request.options.detour = detour;
  if (longest && !(*longest >= 0)) throw Error(ErrorCode::InvalidInput, "longest must not be negative");
  if (longest) request.options.longest = *longest;
  return work;
}

FoundLoops find(const LoopWork& work, Context& context) {
  const Progress progress(context);
  progress.stage("repair");
  const TriangleSurface surface = repaired(work.soup, progress.part(0, 0.1));
  FoundLoops found{search_loops(surface, work.request, progress.part(0.1, 1)), {}};
  for (const RequestedLoop& requested : found.loops) {
    std::vector<Vec3>& line = found.positions.emplace_back();
    for (const int v : requested.loop.points) line.push_back(surface.points[v]);
  }
  return found;
}

py::list to_list(const FoundLoops& found) {
  py::list list;
  for (std::size_t i = 0; i < found.loops.size(); ++i) {
    const auto& [loop, drawn, source] = found.loops[i];
    py::dict dict;
    dict["points"] = to_array(loop.points);
    dict["positions"] = rows_to_array<double>(found.positions[i]);
    dict["length"] = loop.length;
    dict["kind"] = loop.kind == LoopKind::Handle ? "handle" : "tunnel";
    dict["drawn"] = drawn;
    dict["source"] = source;
    list.append(dict);
  }
  return list;
}

py::list find_loops_of(const py::object& points, const py::object& offsets, const py::object& indices, const py::iterable& loops,
                       const py::iterable& strokes, double detour, std::optional<double> longest) {
  const LoopWork work = loop_work_from(points, offsets, indices, loops, strokes, detour, longest);
  return to_list(run_interruptibly([&](Context& context) { return find(work, context); }));
}

std::shared_ptr<PythonJob> start_find_loops(const py::object& points, const py::object& offsets, const py::object& indices, const py::iterable& loops,
                                            const py::iterable& strokes, double detour, std::optional<double> longest) {
  auto found = std::make_shared<FoundLoops>();  // written by the job's thread until it is done
  return start_job(
      [work = loop_work_from(points, offsets, indices, loops, strokes, detour, longest), found](Context& context) { *found = find(work, context); },
      [found]() -> py::object { return to_list(*found); });
}

py::tuple close_noise_of(const py::object& points, const py::object& offsets, const py::object& indices, double length) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  if (!(length > 0)) throw Error(ErrorCode::InvalidInput, "length must be above 0");
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
  const auto define = [&](const char* name, auto function, const char* help) {
    module.def(name, function, arg("points"), arg("face_offsets"), arg("face_indices"), arg("loops") = py::tuple(), arg("strokes") = py::tuple(),
               arg("detour") = LoopOptions().detour, arg("longest") = py::none(), help);
  };
  define(
      "find_loops", &find_loops_of,
      "Short disjoint loops that separate nothing together, one for each unit of genus, as a list of dicts: points (n,) int32, numbers of points of\n"
      "what repair() makes of the mesh; positions (n, 3); length, in the mesh's unit; kind, 'handle' or 'tunnel'; drawn; source.\n"
      "loops: dicts with points (n, 3) and drawn, those that the mesh has already; source is the place among them, -1 for others. strokes: closed\n"
      "lines (n, 3), each of which becomes the shortest loop around what it goes around, and is drawn then. What is drawn comes first, then those\n"
      "of `loops` that can be kept beside it, then what is missing. detour: how many times longer than the shortest a loop may be if its cap meets\n"
      "the surface less. longest: longer ones are not looked for; 0: none is. InvalidInput and Unsupported name what is drawn and cannot be kept;\n"
      "Unsupported: the triangles leave no room for as many loops.");
  define("start_find_loops", &start_find_loops, "Starts find_loops() as a Job, whose result is what find_loops() returns.");
  module.def("close_noise", &close_noise_of, arg("points"), arg("face_offsets"), arg("face_indices"), arg("length"),
             "Cuts and caps all handles and tunnels whose loops are shorter than `length`: (points, face_offsets, face_indices, how many).");
  module.def(
      "close_topology", &close_topology_of, arg("points"), arg("face_offsets"), arg("face_indices"),
      "The mesh cut along its loops and capped, components joined by tubes, boundaries capped: (points, face_offsets, face_indices, events, kinds).\n"
      "events (m,): of each face, -1 or the number of the event whose cap or tube it is; kinds: of each event, 'cut', 'boundary' or 'tube'.");
}

}  // namespace hybrid_mesh
