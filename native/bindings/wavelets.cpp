// SPDX-License-Identifier: GPL-3.0-or-later
// Levels edited and analysed by scripts.
#include <string>
#include <utility>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/hierarchy.h"
#include "bindings/job.h"
#include "wavelets/level_editing.h"
#include "wavelets/wavelet_step.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

void set_level(PythonHierarchy& hierarchy, const std::string& name, const py::object& points, bool coarser) {
  LevelEdit edit;
  edit.points = vectors_from_array(points, "points");
  edit.coarser = coarser ? CoarserLevels::Follow : CoarserLevels::Stay;
  run_interruptibly([&](Context& context) {
    hierarchy.edit([&](const HybridMesh& mesh) {
      const Level level = find_level(mesh, name);
      edit.level = level.number;
      edit.kind = level.kind;
      return edited(mesh, edit, Progress(context));
    });
    return true;
  });
}

constexpr const char* name_of(DetailKind kind) {
  switch (kind) {
    case DetailKind::Edge:
      return "edge";
    case DetailKind::Face:
      return "face";
    case DetailKind::Inserted:
      return "inserted";
    case DetailKind::Closing:
      return "closing";
  }
  return "";
}

py::dict analyse(const PythonHierarchy& hierarchy, int level, const py::object& points) {
  std::vector<Vec3> fine;
  if (!points.is_none()) fine = vectors_from_array(points, "points");
  LevelAnalysis analysis;
  std::vector<int> vertices;
  std::vector<DetailKind> kinds;
  run_interruptibly([&](Context&) {
    return hierarchy.locked([&](const HybridMesh& mesh) {
      const WaveletStep step(mesh, level);
      analysis = step.analyse(points.is_none() ? step.fine().points : fine);
      for (const DetailVertex& detail : step.details()) {
        vertices.push_back(detail.vertex);
        kinds.push_back(detail.kind);
      }
      return true;
    });
  });
  py::dict result;
  result["coarse"] = rows_to_array<double>(analysis.coarse);
  result["details"] = rows_to_array<double>(analysis.details);
  result["detail_vertices"] = to_array(vertices);
  py::list names;
  for (const DetailKind kind : kinds) names.append(name_of(kind));
  result["detail_kinds"] = names;
  result["remainder"] = rows_to_array<double>(analysis.remainder);
  return result;
}

py::array_t<double> synthesise(const PythonHierarchy& hierarchy, int level, const py::object& coarse, const py::object& details,
                               const py::object& remainder) {
  LevelAnalysis analysis{vectors_from_array(coarse, "coarse"), vectors_from_array(details, "details"), {}};
  if (!remainder.is_none()) analysis.remainder = vectors_from_array(remainder, "remainder");
  return rows_to_array<double>(run_interruptibly(
      [&](Context&) { return hierarchy.locked([&](const HybridMesh& mesh) { return WaveletStep(mesh, level).synthesise(analysis); }); }));
}

constexpr const char* kSetLevel = R"(Puts the points of a level elsewhere; the finer levels and the final mesh follow.

level    its name: "N1", or "M1" for the level before its operations
points   (n, 3), in the order of level(level)["points"] and in its units
coarser  whether the coarser levels follow, too

Finer levels keep what they differ by from subdivision of the level before, turned and scaled as the surface turns and grows at each place. What
is far from an edit stays as it is, byte for byte; a level that is set to what it was changes nothing. The coarser levels follow by analysis. Maps stay as
they are, and with them what of the original surface a point carries. Raises InvalidInput if there is no such level or the points are too few, too many or not finite, and then nothing has changed.)";

constexpr const char* kAnalyse = R"(One step of the wavelet transform, from N<level> to N<level - 1>.

level   1 or finer
points  (n, 3), in the order of level("N<level>")["points"]; those if none are given

Returns a dict: coarse, (m, 3), low-pass positions in the order of level("N<level - 1>")["points"]; details, (k, 3), in the units and directions of the
points; detail_vertices, (k,), which point each belongs to; detail_kinds, k words: "edge" and "face", coefficients of the midpoint of a side and the
centre of a quad, "inserted", of a vertex that an operation makes, relative to its boundary, "closing", of one that closes leaves with hanging nodes;
remainder, (n, 3), what these do not give, (0, 3) but in meshes like a cube's. Raises InvalidInput if there is no such step, or points are too few, too many
or not finite.)";

constexpr const char* kSynthesise = R"(The inverse of analyse(): the points of N<level>, (n, 3), from arrays as its dict has them.)";

}  // namespace

void bind_wavelets(py::module_& module) {
  using py::arg;
  auto type = py::reinterpret_borrow<py::class_<PythonHierarchy>>(module.attr("Hierarchy"));
  type.def("set_level", &set_level, arg("level"), arg("points"), py::kw_only(), arg("coarser") = false, kSetLevel)
      .def("analyse", &analyse, arg("level"), arg("points") = py::none(), kAnalyse)
      .def("synthesise", &synthesise, arg("level"), arg("coarse"), arg("details"), arg("remainder") = py::none(), kSynthesise);
}

}  // namespace hybrid_mesh
