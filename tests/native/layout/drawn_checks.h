// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of drawn layouts ask of the result.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "layout/drawn/drawn_layout.h"

namespace hybrid_mesh::testing {

inline std::string all_messages(const DrawnLayout& d) {
  std::string text;
  for (const LayoutProblem& p : d.problems) text += std::string(name_of(p.kind)) + ": " + p.message + " (stroke " + std::to_string(p.stroke) + ")\n";
  return text;
}

inline int count(const DrawnLayout& d, LayoutProblem::Kind kind) {
  return static_cast<int>(std::count_if(d.problems.begin(), d.problems.end(), [&](const LayoutProblem& p) { return p.kind == kind; }));
}

// Every curve is a piece of a stroke or of the boundary; of every stroke there is a curve, or it is said why not.
inline void expect_origins(const DrawnLayout& d, int strokes) {
  std::set<int> found;
  for (const PatchLayout::Curve& c : d.layout.curves) {
    EXPECT_EQ(c.boundary, c.stroke < 0);
    EXPECT_LT(c.stroke, strokes);
    found.insert(c.stroke);
  }
  for (const LayoutProblem& p : d.problems) {
    found.insert(p.stroke);
    EXPECT_FALSE(p.message.empty());
  }
  for (int s = 0; s < strokes; ++s) EXPECT_TRUE(found.count(s)) << "stroke " << s << " is lost";
}

inline std::multiset<int> face_sizes(const PatchLayout& l) {
  std::multiset<int> sizes;
  for (const auto& f : l.faces) sizes.insert(f.side_count());
  return sizes;
}

}  // namespace hybrid_mesh::testing
