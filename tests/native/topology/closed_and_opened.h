// SPDX-License-Identifier: GPL-3.0-or-later
// What holds of every series of surfaces.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "base/error.h"
#include "handled_surfaces.h"
#include "surface/topology_summary.h"
#include "topology/surface_series.h"

namespace hybrid_mesh::testing {

inline std::vector<SurfaceLoop> loops_of(const TriangleSurface& s, const std::vector<std::vector<int>>& given = {}, const LoopOptions& options = {}) {
  Context context;
  std::vector<GivenLoop> named;
  for (const std::vector<int>& loop : given) named.push_back({loop, "loop " + std::to_string(named.size())});
  return find_loops(s, named, options, Progress(context));
}

inline std::vector<TopologyEvent> cuts_of(const std::vector<SurfaceLoop>& loops) {
  std::vector<TopologyEvent> events;
  for (const SurfaceLoop& loop : loops) events.push_back({EventKind::Cut, {loop.points, {}}, loop.length, loop.kind});
  return events;
}
inline std::vector<TopologyEvent> cuts_of(const TriangleSurface& s) { return cuts_of(loops_of(s)); }

template <class Function>
ErrorCode code_of(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::Internal;
}

inline void expect_manifold(const TriangleSurface& s) {
  const TopologySummary summary = summarize_topology(to_soup(s));
  EXPECT_EQ(summary.nonmanifold_edges, 0);
  EXPECT_EQ(summary.nonmanifold_vertices, 0);
  EXPECT_EQ(summary.misoriented_edges, 0);
  EXPECT_EQ(summary.vertices, static_cast<std::int64_t>(s.points.size()));
  TriangleSurface again = s;
  connect_half_edges(again);
  EXPECT_EQ(again.opposite, s.opposite);
  EXPECT_EQ(s.source_face.size(), s.faces.size());
}

// The faces and points of a version are those of `closed` and of the input that it says they are.
inline void expect_same_places(const SurfaceSeries& series, const OpenedSurface& opened) {
  expect_manifold(opened.surface);
  std::vector<int> hidden;
  for (const auto& ends : series.hidden)
    for (const auto& faces : ends) hidden.insert(hidden.end(), faces.begin(), faces.end());
  const int closed_faces = static_cast<int>(series.closed.faces.size());
  ASSERT_EQ(opened.faces.size(), opened.surface.faces.size());
  for (std::size_t f = 0; f < opened.faces.size(); ++f) {
    const int name = opened.faces[f];
    ASSERT_GE(name, 0);
    ASSERT_LT(name, closed_faces + static_cast<int>(hidden.size()));
    for (int k = 0; k < 3; ++k) {
      const int v = opened.surface.faces[f][k];
      if (name < closed_faces) {
        ASSERT_EQ(opened.of_closed[series.closed.faces[name][k]], v);
      } else {
        ASSERT_EQ(series.input.faces[hidden[name - closed_faces]][k], opened.point_origin[v]);
      }
    }
  }
  ASSERT_EQ(opened.of_closed.size(), series.closed.points.size());
  for (std::size_t v = 0; v < opened.of_closed.size(); ++v)
    if (opened.of_closed[v] >= 0) {
      EXPECT_EQ(opened.surface.points[opened.of_closed[v]], series.closed.points[v]);
      EXPECT_EQ(opened.point_origin[opened.of_closed[v]], series.point_origin[v]);
    }
  for (std::size_t v = 0; v < opened.point_origin.size(); ++v)
    if (opened.point_origin[v] >= 0) {
      EXPECT_EQ(opened.surface.points[v], series.input.points[opened.point_origin[v]]);
    }
}

inline void expect_sound(const SurfaceSeries& series) {
  expect_manifold(series.closed);
  for (std::size_t f = 0; f < series.closed.faces.size(); ++f) {
    const int origin = series.face_origin[f];
    EXPECT_EQ(origin < 0, series.face_event[f] >= 0);
    EXPECT_EQ(series.closed.source_face[f], origin < 0 ? -1 : series.input.source_face[origin]);
    for (int k = 0; origin >= 0 && k < 3; ++k) ASSERT_EQ(series.point_origin[series.closed.faces[f][k]], series.input.faces[origin][k]);
  }
  const OpenedSurface none = open_topology(series, std::vector<bool>(series.events.size(), false));
  expect_same_places(series, none);
  EXPECT_EQ(none.surface.faces, series.closed.faces);
  EXPECT_EQ(none.surface.points, series.closed.points);
  const OpenedSurface all = open_topology(series, std::vector<bool>(series.events.size(), true));
  expect_same_places(series, all);
  EXPECT_EQ(all.surface.faces, series.input.faces);
  EXPECT_EQ(all.surface.points, series.input.points);
  EXPECT_EQ(all.surface.opposite, series.input.opposite);
  EXPECT_EQ(all.surface.source_face, series.input.source_face);
}

}  // namespace hybrid_mesh::testing
