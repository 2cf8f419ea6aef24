// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "layout/regions/region_layout.h"
#include "layout/search/carried_map.h"

namespace hybrid_mesh {

// The map of a layout, and beside it the map of a changed layout that is tried out and kept or dropped.
class TrialMap {
 public:
  explicit TrialMap(CarriedMap map) : best_(std::move(map)) {}

  // Maps the patches of the layout that it was made with. To be called first.
  void map_patches_and_keep(const GlobalMapOptions& options, const Progress& progress);
  const CarriedMap& best() const { return best_; }

  // Begins a trial with the best layout: the surface cut along its sides, and the energy of its patches.
  void begin(double theta, const Progress& progress);
  const MappedSurface& mapped() const { return mapped_; }        // of the trial
  const std::vector<double>& energy() const { return energy_; }  // per patch as it began, beyond an isometry's, in patches
  double scale() const { return scale_; }                        // of lengths, see ChartMesh
  // Edits the trial's layout.
  void change(const LayoutEdit& edit, const Progress& progress);
  // Smooths the trial's map. Throws NoMap.
  void smooth(const GlobalMapOptions& options, const Progress& progress);
  // Whether the trial's map has less energy than the best.
  bool is_better() const { return excess_ < least_; }
  void keep();
  CarriedMap take() { return std::move(best_); }

 private:
  CarriedMap best_;
  MappedSurface mapped_;  // cut along the best layout, or an edited one
  std::optional<ChartMesh> fresh_;
  std::vector<double> energy_;
  double least_ = 0, excess_ = 0;  // energy of the best and of the fresh map beyond an isometry's, in patches
  double scale_ = 1;
};

// Edits disjoint regions of the trial's layout, and smooths its map: most of that is as it was before.
void apply_edits(TrialMap& map, const std::vector<LayoutEdit>& edits, GlobalMapOptions options, const Progress& progress);

}  // namespace hybrid_mesh
