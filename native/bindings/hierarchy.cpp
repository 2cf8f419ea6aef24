// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/hierarchy.h"

#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "codec/container.h"
#include "hierarchy/operation_template.h"
#include "surface/topology_summary.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

// Runs something that reads the hierarchy while Python's other threads go on.
template <typename Function>
auto locked(const PythonHierarchy& hierarchy, Function&& function) {
  return without_gil([&] { return hierarchy.locked(function); });
}

// From the base to the finest. M^j is there only where an irregular operation separates it from N^j.
std::vector<Level> levels_of(const HybridMesh& mesh) {
  const int depth = mesh.depth();
  std::vector<bool> changed(depth + 1, false);
  for (int i = 0; i < mesh.operation_count(); ++i) {
    const HybridMesh::Operation& operation = mesh.operation(i);
    if (operation.enabled && operation.repatch.level <= depth) changed[operation.repatch.level] = true;
  }
  std::vector<Level> levels;
  for (int j = 0; j <= depth; ++j) {
    if (changed[j]) levels.push_back({LevelKind::M, j});
    levels.push_back({LevelKind::N, j});
  }
  return levels;
}

// Counts of a mesh for info(), and its topology.
nlohmann::ordered_json counts_of(const QuadMesh& mesh) {
  std::int64_t quads = 0, triangles = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t corners = mesh.offsets[f + 1] - mesh.offsets[f];
    quads += corners == 4;
    triangles += corners == 3;
  }
  const TopologySummary topology = summarize_topology(to_soup(mesh));
  return {{"vertices", mesh.vertex_count()},
          {"faces", mesh.face_count()},
          {"quads", quads},
          {"triangles", triangles},
          {"genus", topology.genus},
          {"components", topology.components},
          {"boundary_loops", topology.boundary_loops}};
}

std::string info(const HybridMesh& mesh) {
  nlohmann::ordered_json result;
  result["base"] = {{"quads", mesh.base_count()}, {"vertices", mesh.base_vertex_count()}};
  result["operations"] = mesh.operation_count();
  result["maps"] = mesh.has_maps();
  nlohmann::ordered_json levels = nlohmann::ordered_json::array();
  for (const Level& level : levels_of(mesh)) {
    nlohmann::ordered_json entry;
    entry["name"] = level.name();
    entry.update(counts_of(mesh.level_mesh(level.number, level.kind)));
    levels.push_back(entry);
  }
  result["levels"] = levels;
  result["final"] = counts_of(mesh.final_mesh());
  return result.dump();
}

// Adds what is wrong with a mesh. Returns its topology.
TopologySummary check_mesh(const QuadMesh& mesh, const std::string& name, std::vector<std::string>& defects) {
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if (!mesh.points[v].allFinite()) defects.push_back("vertex " + std::to_string(v) + " of " + name + " is not finite");
  const TopologySummary topology = summarize_topology(to_soup(mesh));
  const auto count = [&](std::int64_t number, const char* what) {
    if (number != 0) defects.push_back(name + " has " + std::to_string(number) + " " + what);
  };
  count(topology.nonmanifold_edges, "edges of more than two faces");
  count(topology.nonmanifold_vertices, "vertices of more than one fan");
  count(topology.misoriented_edges, "edges with faces of opposite orientation");
  return topology;
}

bool same_topology(const TopologySummary& a, const TopologySummary& b) {
  return a.genus == b.genus && a.components == b.components && a.boundary_loops == b.boundary_loops;
}

// Broken invariants of the hierarchy and its maps; of its levels, whose topology is that of the one before but where operations are between them; and
// of its final mesh.
std::vector<std::string> check(const HybridMesh& mesh) {
  std::vector<std::string> defects = find_defects(mesh);
  for (int node = 0; node < mesh.node_count(); ++node) {
    const PatchMap* map = mesh.map(node);
    const std::string defect = map ? find_map_defect(*map) : "";
    if (!defect.empty()) defects.push_back("the map of node " + std::to_string(node) + ": " + defect);
  }
  if (!defects.empty()) return defects;
  std::optional<TopologySummary> before;
  LevelKind last = LevelKind::N;
  for (const Level& level : levels_of(mesh)) {
    const TopologySummary topology = check_mesh(mesh.level_mesh(level.number, level.kind), "level " + level.name(), defects);
    // Operations are between an M and its N alone.
    if (before && last == LevelKind::N && !same_topology(topology, *before))
      defects.push_back("level " + level.name() + " has another topology than the one before");
    before = topology;
    last = level.kind;
  }
  const TopologySummary topology = check_mesh(mesh.final_mesh(), "the final mesh", defects);
  if (!same_topology(topology, *before)) defects.push_back("the final mesh has another topology than the finest level");
  return defects;
}

std::vector<std::string> level_names(const PythonHierarchy& hierarchy) {
  return locked(hierarchy, [](const HybridMesh& mesh) {
    std::vector<std::string> names;
    for (const Level& level : levels_of(mesh)) names.push_back(level.name());
    return names;
  });
}

py::dict level(const PythonHierarchy& hierarchy, const std::string& name) {
  return to_dict(without_gil([&] {
    return hierarchy.annotated([&](const HybridMesh& mesh) {
      const Level level = find_level(mesh, name);
      return mesh.level_mesh(level.number, level.kind);
    });
  }));
}

py::array_t<double> level_points(const PythonHierarchy& hierarchy, const std::string& name) {
  return rows_to_array<double>(locked(hierarchy, [&](const HybridMesh& mesh) {
    const Level level = find_level(mesh, name);
    return mesh.level_mesh(level.number, level.kind).points;
  }));
}

py::dict final_mesh(const PythonHierarchy& hierarchy) {
  return to_dict(without_gil([&] { return hierarchy.annotated([](const HybridMesh& mesh) { return mesh.final_mesh(); }); }));
}

std::string address_of(const HybridMesh& mesh, const std::vector<int>& root_number, int node) {
  std::string children;
  for (; !mesh.is_root(node); node = mesh.parent(node)) children = "." + std::to_string(node - mesh.first_child(mesh.parent(node))) + children;
  return std::to_string(root_number[node]) + children;
}

// An irregular operation with what it takes to do the same elsewhere.
struct OperationRecord {
  std::string kind;
  int level = 0;
  std::vector<std::string> quads;
  std::set<int> opens;
  std::optional<OperationTemplate> pattern;
  std::string start;  // the address of its start's quad
};

OperationRecord record_of(const HybridMesh& mesh, const RootNotes& notes, int operation) {
  if (operation < 0 || operation >= mesh.operation_count())
    throw Error(ErrorCode::InvalidInput,
                "there is no operation " + std::to_string(operation) + ": the hierarchy has " + std::to_string(mesh.operation_count()));
  const std::vector<int> number = root_numbers(mesh, notes.plan_root);
  const Repatch& repatch = mesh.operation(operation).repatch;
  OperationRecord record{repatch.kind, repatch.level, {}, {}, template_of(mesh, operation), {}};
  for (const int node : repatch.removed) record.quads.push_back(address_of(mesh, number, node));
  for (const int root : mesh.operation(operation).roots)
    if (const int event = notes.opened_at(root); event >= 0) record.opens.insert(event);
  if (record.pattern) record.start = address_of(mesh, number, record.pattern->start.node);
  return record;
}

py::dict operation(const PythonHierarchy& hierarchy, int number) {
  const OperationRecord record = locked(hierarchy, [&](const HybridMesh& mesh) { return record_of(mesh, hierarchy.notes(), number); });
  py::dict result;
  result["kind"] = record.kind;
  result["level"] = record.level;
  result["quads"] = record.quads;
  result["opens"] = std::vector<int>(record.opens.begin(), record.opens.end());
  result["corners"] = record.pattern ? record.pattern->corners : 0;
  result["start"] = record.pattern ? py::object(py::make_tuple(record.start, record.pattern->start.side)) : py::none();
  py::list new_quads;
  if (record.pattern)
    for (const std::array<int, 4>& quad : record.pattern->quads) new_quads.append(std::vector<int>(quad.begin(), quad.end()));
  result["new_quads"] = new_quads;
  return result;
}

void save(const PythonHierarchy& hierarchy, const py::object& path_object, const std::optional<std::string>& metadata) {
  const std::string path = path_from_python(path_object);
  locked(hierarchy, [&](const HybridMesh& mesh) { save_hierarchy(mesh, metadata ? *metadata : hierarchy.metadata(), path); });
}

PythonHierarchy load(const py::object& path_object, std::size_t most_bytes) {
  const std::string path = path_from_python(path_object);
  LoadedHierarchy loaded = without_gil([&] { return load_hierarchy(path, most_bytes); });
  return {std::make_shared<const HybridMesh>(std::move(loaded.hierarchy)), std::move(loaded.metadata_json)};
}

}  // namespace

Level find_level(const HybridMesh& mesh, const std::string& name) {
  for (const Level& level : levels_of(mesh)) {
    if (level.name() == name) return level;
  }
  throw Error(ErrorCode::InvalidInput, "there is no level " + name);
}

void bind_hierarchy(py::module_& module) {
  using py::arg;
  py::class_<PythonHierarchy>(module, "Hierarchy", "The quad meshes of a remesh, level by level.")
      .def_property_readonly("level_names", &level_names, "From the base to the finest: N0, M1, N1, ...")
      .def("level", &level, arg("name"),
           "The mesh of a level, as a dict of arrays. Where there are sharp edges, `sharp` says for each corner whether the edge to the face's next "
           "one is one.")
      .def("level_points", &level_points, arg("name"), "The points of a level alone, (n, 3), as level(name) has them: in a fraction of the time.")
      .def("final_mesh", &final_mesh, "The remesh, as a dict of arrays.")
      .def_property_readonly(
          "operation_count",
          [](const PythonHierarchy& hierarchy) { return locked(hierarchy, [](const HybridMesh& mesh) { return mesh.operation_count(); }); },
          "How many irregular operations there are.")
      .def("operation", &operation, arg("number"),
           "An irregular operation: its kind, its level, the addresses of the quads that it replaces, which events of the plan's topology it opens, "
           "and its new_quads, numbered as a template in a plan: nodes 0 .. corners - 1 are the "
           "region's corners from the side start, (address, side), on. Where it does not replace a disk by a disk, corners is 0, start None and "
           "new_quads empty.")
      .def("save", &save, arg("path"), arg("metadata") = py::none(), "Writes the hierarchy; the file appears when it is complete.")
      .def_property_readonly("metadata", &PythonHierarchy::metadata, "The JSON text that was saved with it.")
      .def(
          "check", [](const PythonHierarchy& hierarchy) { return locked(hierarchy, check); }, "What is wrong with it; empty if nothing is.")
      .def(
          "info", [](const PythonHierarchy& hierarchy) { return locked(hierarchy, info); }, "Counts, as JSON text.");
  module.def("load_hierarchy", &load, arg("path"), py::kw_only(), arg("most_bytes") = 0,
             "Reads what Hierarchy.save() or Hierarchy.save_stream() wrote; of a stream no more than so many bytes, if that is not 0.");
}

}  // namespace hybrid_mesh
