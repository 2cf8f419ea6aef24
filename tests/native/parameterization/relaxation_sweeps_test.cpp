// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/relaxation_sweeps.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "generated_surfaces.h"
#include "layout/base/base_domain.h"
#include "layouts.h"
#include "parameterization/initial_map.h"

namespace hybrid_mesh {
namespace {

using testing::expect_bijective;

ChartMesh charts_of(const PolygonSoup& soup) {
  const TriangleSurface surface = testing::unit(testing::repaired(soup));
  Context context;
  BaseDomainOptions options;
  options.size = 40;
  PatchedSurface patches = BaseDomain(surface, {}, options, Progress(context)).cut(testing::whole_surface, Progress(context)).patches;
  return ChartMesh(patches, map_patches(patches, Progress(context)));
}

double energy(const ChartMesh& charts, const Distortion& density) {
  ChartMesh copy = charts;
  const StarRelaxation stars(copy, density);
  double sum = 0;
  for (int f = 0; f < static_cast<int>(copy.mesh.alive.size()); ++f) sum += stars.face_energy(f);
  return sum;
}

TEST(RelaxationSweeps, LowerTheEnergyAndDoNotDependOnTheNumberOfThreads) {
  const Distortion density{0.5};
  // Enough vertices for many blocks.
  const ChartMesh before = charts_of(testing::torus(120, 60));
  std::vector<ChartMesh> after;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    ChartMesh& charts = after.emplace_back(before);
    Context context;
    relax_in_sweeps(charts, density, 3, Progress(context));
    expect_bijective(charts);
  }
  EXPECT_LT(energy(after[0], density), energy(before, density));
  EXPECT_EQ(after[0].uv, after[1].uv);
  EXPECT_EQ(after[0].uv, after[2].uv);
}

}  // namespace
}  // namespace hybrid_mesh
