// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid_mesh {

// The real models to test with, in order: all .ply files of $HYBRID_MESH_MODELS, or of ../shared/models beside the checkout.
// Empty where there is no such folder: a test that needs them is then skipped.
inline std::vector<std::filesystem::path> real_models() {
  namespace fs = std::filesystem;
  const char* variable = std::getenv("HYBRID_MESH_MODELS");
  const fs::path folder = variable ? fs::path(variable) : fs::path(HYBRID_MESH_CHECKOUT) / ".." / "shared" / "models";
  std::vector<fs::path> models;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".ply") models.push_back(it->path());
  std::sort(models.begin(), models.end());
  return models;
}

}  // namespace hybrid_mesh
