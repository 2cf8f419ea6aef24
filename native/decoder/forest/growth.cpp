// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/forest/growth.h"

#include <algorithm>
#include <string>

#include "decoder/error.h"

namespace hybrid_mesh {

QuadForest grow(QuadForest forest, Growth& growth, int most_nodes) {
  const auto refuse = [](const std::string& reason) { throw Error(ErrorCode::InvalidInput, reason); };
  int n = 0;
  for (int j = 0; n < forest.node_count(); ++j) {
    for (const int end = forest.node_count(); n < end; ++n)
      if (growth.refined(forest, n)) {
        if (j == QuadForest::max_level) refuse("too many levels");
        if (forest.node_count() + 4 > most_nodes) refuse("too many quads");
        forest.instantiate(n);
      }
    for (QuadForest::Operation op; j < QuadForest::max_level && growth.operation(forest, j + 1, op.repatch); op = {}) {
      op.repatch.level = j + 1;
      const std::string reason = forest.validate(op.repatch);
      if (!reason.empty()) refuse(reason);
      if (forest.node_count() + static_cast<int>(op.repatch.quads.size()) > most_nodes) refuse("too many quads");
      forest.append(std::move(op));
    }
  }
  const std::string reason = forest.find_choice_defect();
  if (!reason.empty()) refuse(reason);
  return forest;
}

}  // namespace hybrid_mesh
