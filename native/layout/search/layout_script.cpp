// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_script.h"

namespace hybrid_mesh {

std::vector<std::vector<LayoutEdit>> rounds_of(const LayoutScript& script) {
  std::vector<std::vector<LayoutEdit>> rounds;
  int last = -1;
  for (const LayoutScript::Edit& of : script.edits) {
    if (rounds.empty() || of.round != last) rounds.emplace_back();
    last = of.round;
    rounds.back().push_back(of.edit);
  }
  return rounds;
}

}  // namespace hybrid_mesh
