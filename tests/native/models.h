// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace hybrid_mesh {

// $HYBRID_MESH_MODELS, or ../shared/models beside the checkout.
inline std::filesystem::path models_folder() {
  const char* variable = std::getenv("HYBRID_MESH_MODELS");
  return variable ? std::filesystem::path(variable) : std::filesystem::path(HYBRID_MESH_CHECKOUT) / ".." / "shared" / "models";
}

// The real models to test with, in order: all .ply files of that folder. Empty where there is none: a test that needs them is then skipped, for the
// reason no_models().
inline std::vector<std::filesystem::path> real_models() {
  namespace fs = std::filesystem;
  std::vector<fs::path> models;
  std::error_code error;
  for (fs::directory_iterator it(models_folder(), error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".ply") models.push_back(it->path());
  std::sort(models.begin(), models.end());
  return models;
}

inline std::string no_models() {
  return "there are no .ply files in " + models_folder().lexically_normal().string() + "; HYBRID_MESH_MODELS may name another folder";
}

}  // namespace hybrid_mesh
