// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_script.h"

namespace hybrid_mesh {

std::vector<std::vector<LayoutScript::Edit>> rounds_of(const LayoutScript::Level& level) {
  std::vector<std::vector<LayoutScript::Edit>> rounds;
  for (const LayoutScript::Edit& edit : level.edits) {
    if (rounds.empty() || rounds.back().front().round != edit.round) rounds.emplace_back();
    rounds.back().push_back(edit);
  }
  return rounds;
}

}  // namespace hybrid_mesh
