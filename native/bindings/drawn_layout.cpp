// SPDX-License-Identifier: GPL-3.0-or-later
// Layouts drawn on a mesh.

#include <cmath>
#include <limits>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/job.h"
#include "bindings/layout_problems.h"
#include "layout/drawn/face_filling.h"
#include "layout/drawn/layout_transfer.h"
#include "remesh/plan.h"
#include "surface/repair.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

// A copy of an (n, 3) array of numbers, which need not be finite.
std::vector<Vec3> points_from_array(const py::handle& object, const std::string& name) {
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(object);
  if (!array) {
    PyErr_Clear();
    refuse(name + " must be an array of numbers");
  }
  std::vector<Vec3> points;
  if (array.size() == 0) return points;
  if (array.ndim() != 2 || array.shape(1) != 3) refuse(name + " must have the shape (n, 3), not " + py::str(array.attr("shape")).cast<std::string>());
  const double* p = array.data();
  for (py::ssize_t i = 0; i < array.shape(0); ++i) points.push_back(Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2]));
  return points;
}

DrawnStroke stroke_from_dict(const py::handle& object, std::size_t number) {
  const std::string name = "stroke " + std::to_string(number);
  if (!py::isinstance<py::dict>(object)) refuse(name + " must be a dict");
  const auto dict = py::reinterpret_borrow<py::dict>(object);
  DrawnStroke stroke;
  for (const auto& [key, value] : dict) {
    const std::string word = py::isinstance<py::str>(key) ? key.cast<std::string>() : "";
    if (word == "points") {
      stroke.points = points_from_array(value, "points of " + name);
    } else if (word == "fit") {
      const std::string fit = py::isinstance<py::str>(value) ? value.cast<std::string>() : "";
      if (fit != "tight" && fit != "drawn") refuse("the fit of " + name + " must be 'tight' or 'drawn', not " + py::repr(value).cast<std::string>());
      stroke.fit = fit == "tight" ? DrawnStroke::Fit::Tight : DrawnStroke::Fit::AsDrawn;
    } else {
      refuse(name + " has an entry " + py::repr(key).cast<std::string>() + ", which means nothing");
    }
  }
  if (!dict.contains("points")) refuse(name + " has no points");
  return stroke;
}

py::array_t<double> positions(const PatchLayout& layout, const std::vector<int>& points) {
  std::vector<Vec3> out;
  for (const int v : points) out.push_back(layout.mesh.points[v]);
  return rows_to_array<double>(out);
}

// A layout and what its faces are filled with.
struct FilledLayout {
  DrawnLayout drawn;
  std::vector<int> quads;  // per face, 0 where it cannot be filled
  std::string plan;        // as the base domain of a plan: JSON text; empty if that was not asked for, or there are problems
};

py::dict to_dict(const FilledLayout& filled) {
  const DrawnLayout& drawn = filled.drawn;
  const PatchLayout& layout = drawn.layout;
  py::list curves, faces, quads;
  for (const PatchLayout::Curve& c : layout.curves) {
    py::dict curve;
    curve["nodes"] = py::make_tuple(c.from, c.to);
    curve["points"] = positions(layout, c.points);
    curve["stroke"] = c.stroke;
    curve["boundary"] = c.boundary;
    curves.append(curve);
  }
  for (const PatchLayout::Face& f : layout.faces) {
    // The rims of a face that is no disk follow one another.
    py::list sides;
    for (const auto& cycle : f.cycles)
      for (const PatchLayout::Side& s : cycle) sides.append(py::make_tuple(s.curve, s.forward));
    faces.append(sides);
  }
  py::dict result;
  result["nodes"] = positions(layout, layout.nodes);
  result["curves"] = curves;
  for (const int count : filled.quads) quads.append(count);
  result["faces"] = faces;
  result["quads"] = quads;
  result["problems"] = to_list(drawn.problems);
  return result;
}

// What strokes are drawn on, and how they become a layout: what Python gives, without Python.
struct Drawing {
  PolygonSoup soup;
  std::vector<DrawnStroke> strokes;
  DrawnLayoutOptions options;
};

Drawing drawing_from_python(const py::object& points, const py::object& faces, const py::iterable& strokes, double snap) {
  Drawing drawing{soup_from_faces(points, faces), {}, {}};
  for (const auto& s : strokes) drawing.strokes.push_back(stroke_from_dict(s, drawing.strokes.size()));
  drawing.options.snap = snap;
  return drawing;
}

FilledLayout make_layout(const Drawing& drawing, Context& context) {
  RepairReport report;
  const Progress progress(context);
  progress.stage("layout");
  FilledLayout filled;
  filled.drawn =
      make_layout(repair(drawing.soup, RepairOptions(), report, progress.part(0, 0.2)), drawing.strokes, drawing.options, progress.part(0.2, 1));
  for (const DiskLayout& filling : find_fillings(filled.drawn.layout, {}, progress)) filled.quads.push_back(static_cast<int>(filling.quads.size()));
  return filled;
}

py::dict make_layout_from_arrays(const py::object& points, const py::object& faces, const py::iterable& strokes, double snap) {
  const Drawing drawing = drawing_from_python(points, faces, strokes, snap);
  return to_dict(run_interruptibly([&](Context& context) { return make_layout(drawing, context); }));
}

FilledLayout plan_layout(const Drawing& drawing, Context& context) {
  FilledLayout planned = make_layout(drawing, context);
  Plan plan;
  const PatchedSurface quads = fill_faces(planned.drawn, {}, Progress(context));
  if (!planned.drawn.problems.empty()) return planned;
  plan.base = outline_of(quads);
  planned.plan = to_json(plan);
  return planned;
}

py::dict to_dict_with_plan(const FilledLayout& planned) {
  py::dict result = to_dict(planned);
  result["plan"] = planned.plan;
  return result;
}

py::dict layout_plan(const py::object& points, const py::object& faces, const py::iterable& strokes, double snap) {
  const Drawing drawing = drawing_from_python(points, faces, strokes, snap);
  return to_dict_with_plan(run_interruptibly([&](Context& context) { return plan_layout(drawing, context); }));
}

std::shared_ptr<PythonJob> start_layout_plan(const py::object& points, const py::object& faces, const py::iterable& strokes, double snap) {
  auto planned = std::make_shared<FilledLayout>();  // written by the job's thread until it is done
  return start_job(
      [drawing = drawing_from_python(points, faces, strokes, snap), planned](Context& context) { *planned = plan_layout(drawing, context); },
      [planned]() -> py::object { return to_dict_with_plan(*planned); });
}

}  // namespace

py::list to_list(const std::vector<LayoutProblem>& problems) {
  py::list list;
  for (const LayoutProblem& p : problems) {
    py::dict problem;
    problem["kind"] = name_of(p.kind);
    problem["message"] = p.message;
    problem["points"] = rows_to_array<double>(p.where);
    problem["stroke"] = p.stroke;
    problem["face"] = p.face;
    list.append(problem);
  }
  return list;
}

void bind_drawn_layout(py::module_& module) {
  using py::arg;
  module.def("make_layout", &make_layout_from_arrays, arg("points"), arg("faces"), arg("strokes"), arg("snap") = DrawnLayoutOptions().snap,
             "Makes a patch layout of strokes drawn on or near a mesh: a dict of nodes (n, 3), curves, faces, quads and problems. A stroke is a dict "
             "of points (n, 3) and fit, 'tight' or "
             "'drawn'; snap is a fraction of the bounding-box diagonal. A face is its sides (curve, forward), counter-clockwise; quads says "
             "how many each face is filled with, 0 where it cannot be.");
  module.def("layout_plan", &layout_plan, arg("points"), arg("faces"), arg("strokes"), arg("snap") = DrawnLayoutOptions().snap,
             "The same, and its faces, filled with quads, as the base domain of a plan: the entry plan is JSON text, empty if there are problems.");
  module.def("start_layout_plan", &start_layout_plan, arg("points"), arg("faces"), arg("strokes"), arg("snap") = DrawnLayoutOptions().snap,
             "Starts layout_plan and returns its Job at once; the job's result is what layout_plan returns.");
}

}  // namespace hybrid_mesh
