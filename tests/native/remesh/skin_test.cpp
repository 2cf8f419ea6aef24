// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/skin.h"

#include <gtest/gtest.h>

#include "codec/container.h"
#include "remesh/plans.h"

namespace hybrid_mesh {
namespace {

using testing::Json;
using testing::run;

RemeshOptions fitted_options() {
  RemeshOptions options;
  options.vertices = 12000;
  options.stretch_threshold = 1.5;  // low: a fitted base leaves little to do
  return options;
}

TEST(Skin, GrowsOnWhatSticksOutOfAFittedBaseAndIsReplayed) {
  const PolygonSoup soup = testing::spiked_ball(40);
  const RemeshResult made = run(soup, fitted_options());
  ASSERT_GT(made.hierarchy.operation_count(), 0);
  EXPECT_TRUE(find_defects(made.hierarchy).empty());
  for (int i = 0; i < made.hierarchy.operation_count(); ++i) EXPECT_EQ(made.hierarchy.operation(i).repatch.level, 2);
  // What was found by itself stands in the plan as what is asked for by hand does, and is done by the same function.
  const Json plan = Json::parse(made.plan);
  for (const Json& operation : plan["operations"]) EXPECT_NE(operation["layout"], "even");
  EXPECT_GE(plan["operations"].size(), static_cast<std::size_t>(made.hierarchy.operation_count()));
  const RemeshResult again = run(soup, fitted_options(), made.plan);
  EXPECT_EQ(encode_hierarchy(made.hierarchy, "{}"), encode_hierarchy(again.hierarchy, "{}"));
  EXPECT_EQ(made.plan_root, again.plan_root);
  RemeshOptions semi_regular = fitted_options();
  semi_regular.semi_regular = true;
  EXPECT_EQ(run(soup, semi_regular).hierarchy.operation_count(), 0);
}

TEST(Skin, DoesNotGrowWhereNothingIsStretched) { EXPECT_EQ(run(testing::ball(40), fitted_options()).hierarchy.operation_count(), 0); }

}  // namespace
}  // namespace hybrid_mesh
