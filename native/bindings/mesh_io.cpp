// SPDX-License-Identifier: GPL-3.0-or-later
// Reading, writing, repairing and comparing meshes.
#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/job.h"
#include "surface/distance.h"
#include "surface/repair.h"
#include "surface/topology_summary.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

py::tuple read_mesh(const py::object& path_object, const std::string& density) {
  const std::string path = path_from_python(path_object);
  const PolygonSoup soup = without_gil([&] { return read_polygon_soup(path, density); });
  return density.empty() ? soup_to_arrays(soup) : py::tuple(soup_to_arrays(soup) + py::make_tuple(to_array(soup.density)));
}

void write_mesh(const py::object& path_object, const py::object& points, const py::object& offsets, const py::object& indices) {
  const std::string path = path_from_python(path_object);
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  without_gil([&] { write_polygon_soup(soup, path); });
}

py::dict topology(const py::object& points, const py::object& offsets, const py::object& indices) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  const TopologySummary summary = without_gil([&] { return summarize_topology(soup); });
  py::dict result;
  result["vertices"] = summary.vertices;
  result["edges"] = summary.edges;
  result["faces"] = summary.faces;
  result["components"] = summary.components;
  result["boundary_loops"] = summary.boundary_loops;
  result["nonmanifold_edges"] = summary.nonmanifold_edges;
  result["nonmanifold_vertices"] = summary.nonmanifold_vertices;
  result["misoriented_edges"] = summary.misoriented_edges;
  result["euler"] = summary.euler;
  result["genus"] = summary.genus;
  return result;
}

py::tuple repair_mesh(const py::object& points, const py::object& offsets, const py::object& indices, double drop_components) {
  const PolygonSoup soup = soup_from_arrays(points, offsets, indices);
  if (!(drop_components >= 0 && drop_components < 1)) throw Error(ErrorCode::InvalidInput, "drop_components must be in [0, 1)");
  RepairReport report;
  const PolygonSoup repaired =
      run_interruptibly([&](Context& context) { return to_soup(repair(soup, RepairOptions{drop_components}, report, Progress(context))); });
  py::dict counts;
  counts["merged_points"] = report.merged_points;
  counts["isolated_points"] = report.isolated_points;
  counts["duplicate_faces"] = report.duplicate_faces;
  counts["degenerate_faces"] = report.degenerate_faces;
  counts["reoriented_faces"] = report.reoriented_faces;
  counts["nonmanifold_edges"] = report.nonmanifold_edges;
  counts["nonmanifold_vertices"] = report.nonmanifold_vertices;
  counts["one_sided_cuts"] = report.one_sided_cuts;
  counts["dropped_components"] = report.dropped_components;
  counts["changed"] = report.changed();
  return soup_to_arrays(repaired) + py::make_tuple(counts);
}

py::dict compare(const py::object& points_a, const py::object& offsets_a, const py::object& indices_a, const py::object& points_b,
                 const py::object& offsets_b, const py::object& indices_b, std::int64_t samples) {
  const PolygonSoup a = soup_from_arrays(points_a, offsets_a, indices_a), b = soup_from_arrays(points_b, offsets_b, indices_b);
  if (samples < 1) throw Error(ErrorCode::InvalidInput, "samples must be at least 1");
  const SurfaceDistance distance = run_interruptibly([&](Context& context) {
    DistanceOptions options;
    options.samples = samples;
    return surface_distance(a, b, options, Progress(context));
  });
  py::dict result;
  result["l2"] = distance.l2;
  result["l2_ab"] = distance.l2_ab;
  result["l2_ba"] = distance.l2_ba;
  result["mean"] = distance.mean;
  result["hausdorff"] = distance.hausdorff;
  result["boundary_hausdorff"] = distance.boundary_hausdorff;
  result["diagonal"] = distance.diagonal;
  return result;
}

}  // namespace

void bind_mesh_io(py::module_& module) {
  using py::arg;
  module.def("read_mesh", &read_mesh, arg("path"), arg("density") = "",
             "Reads .ply, .obj, .off or .stl: (points, face_offsets, face_indices). density: name of a property of a .ply's vertices, whose values "
             "are returned as well, as a fourth; 'color' is the brightness of red, green and blue.");
  module.def("write_mesh", &write_mesh, arg("path"), arg("points"), arg("face_offsets"), arg("face_indices"),
             "Writes .ply or .obj; the file appears when it is complete.");
  module.def("topology", &topology, arg("points"), arg("face_offsets"), arg("face_indices"), "Counts of a mesh, as a dict.");
  module.def("repair", &repair_mesh, arg("points"), arg("face_offsets"), arg("face_indices"), arg("drop_components") = 0.0,
             "Makes an oriented 2-manifold of triangles: (points, face_offsets, face_indices, counts of what was changed).");
  module.def("compare", &compare, arg("points_a"), arg("face_offsets_a"), arg("face_indices_a"), arg("points_b"), arg("face_offsets_b"),
             arg("face_indices_b"), arg("samples") = 200000,
             "Distances between two surfaces, relative to the bounding-box diagonal of the first, as a dict.");
}

}  // namespace hybrid_mesh
