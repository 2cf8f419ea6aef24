// SPDX-License-Identifier: GPL-3.0-or-later
// Regions of a level that are laid out anew in a finished hierarchy.
#include "remesh/region_update.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/hierarchy.h"
#include "bindings/job.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

RegionUpdate repatch(PythonHierarchy hierarchy, const Plan::Region& region, Context& context) {
  const auto [mesh, notes] = hierarchy.snapshot();
  if (notes.edited)
    throw Error(ErrorCode::Unsupported,
                "levels of the hierarchy were edited, and new quads would lie where the surface is: lay regions out before levels are edited");
  RegionUpdate update = repatch_hierarchy(*mesh, root_numbers(*mesh, notes.plan_root), region, Progress(context));
  if (!hierarchy.replace(mesh, std::make_shared<const HybridMesh>(std::move(update.hierarchy)), std::move(update.root_numbers)))
    throw Error(ErrorCode::InvalidInput, "the hierarchy was changed while a region of it was laid out anew: nothing was done");
  return update;
}

py::dict to_dict(const RegionUpdate& outcome) {
  py::dict result;
  result["operation"] = outcome.operation;
  result["energy_before"] = outcome.energy_before;
  result["energy_after"] = outcome.energy_after;
  py::dict levels;
  for (const RegionUpdate::Level& of : outcome.levels) {
    py::dict counts;
    counts["vertices"] = of.vertices;
    counts["quads"] = of.faces;
    levels[py::int_(of.level)] = counts;
  }
  result["levels"] = levels;
  return result;
}

// A dict as a plan has it, or its JSON text.
Plan::Region region_from_python(const py::object& operation) {
  const py::object text = py::isinstance<py::str>(operation) ? operation : py::module_::import("json").attr("dumps")(operation);
  return plan_region_from_json(text.cast<std::string>());
}

constexpr const char* kRepatch = R"(Lays out quads of one level anew, and rebuilds what lies above them: at their cost alone.

operation is one of a plan's "operations", a dict or JSON text: the level, the addresses of the quads, curves or a layout ("automatic", "cubes", "template"), buffer_rings. No finer level
may have operations, and none of the quads may have been put in by another operation of the level. Returns a dict: operation, its number; levels, the vertices and quads of that
level and all finer ones; energy_before and energy_after, of the maps of
the region and of the rings around it beyond an isometry's, in quads of mean size: the region is better only where that has fallen. Raises InvalidInput, LayoutError or Unsupported with the
reason if it cannot be done, as where levels were edited, and then nothing has changed.)";

}  // namespace

void bind_region_update(py::module_& module) {
  using py::arg;
  auto type = py::reinterpret_borrow<py::class_<PythonHierarchy>>(module.attr("Hierarchy"));
  type.def(
          "copy",
          [](const PythonHierarchy& hierarchy) {
            auto [mesh, notes] = hierarchy.snapshot();
            return PythonHierarchy(std::move(mesh), hierarchy.metadata(), std::move(notes));
          },
          "A hierarchy of its own, which starts as this one is. Maps are shared.")
      .def(
          "repatch",
          [](PythonHierarchy& hierarchy, const py::object& operation) {
            const Plan::Region region = region_from_python(operation);
            return to_dict(run_interruptibly([&](Context& context) { return repatch(hierarchy, region, context); }));
          },
          arg("operation"), kRepatch)
      .def(
          "start_repatch",
          [](const PythonHierarchy& hierarchy, const py::object& operation) {
            auto outcome = std::make_shared<RegionUpdate>();  // written by the job's thread until it is done
            return start_job(
                [hierarchy, region = region_from_python(operation), outcome](Context& context) { *outcome = repatch(hierarchy, region, context); },
                [outcome]() -> py::object { return to_dict(*outcome); });
          },
          arg("operation"), "Starts repatch() as a Job, whose result is what repatch() returns.");
}

}  // namespace hybrid_mesh
