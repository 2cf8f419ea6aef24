// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/search/layout_search.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "layout/regions/patch_sets.h"
#include "layout/regions/region_pattern.h"
#include "parameterization/global_map.h"
#include "parameterization/initial_map.h"

namespace hybrid_mesh {
namespace {

struct Candidate {
  PatchRegion region;
  LayoutEdit edit;
  int irregular = 0;  // further irregular nodes
  double excess = 0;  // energy of the region's patches beyond an isometry's
  double gain = 0;    // energy that the edit saves
};

// Throws Error{Internal} for an edit that is none of this layout's: a script may have been made for another one.
void require_fit(const PatchedSurface& s, const LayoutEdit& edit) {
  const auto fails = [] [[noreturn]] { throw Error(ErrorCode::Internal, "an edit does not fit its layout"); };
  const std::set<int> patches(edit.patches.begin(), edit.patches.end());
  if (patches.empty() || *patches.begin() < 0 || *patches.rbegin() >= s.patch_count() || !patches.count(edit.start.patch)) fails();
  if (patches.count(s.neighbours[edit.start.patch][edit.start.side].patch)) fails();
  const std::optional<PatchRegion> region = make_region(s, edit.patches, edit.start);
  if (!region) fails();
  const int corners = static_cast<int>(region->corners.size());
  if (!find_filling_defect(edit.quads, corners).empty()) fails();
  int nodes = corners;
  for (const auto& quad : edit.quads) nodes = std::max(nodes, *std::max_element(quad.begin(), quad.end()) + 1);
  if (nodes - corners != edit.inner_nodes || edit.rings < 0 || static_cast<std::int64_t>(corners) * edit.rings > edit.inner_nodes) fails();
}

class LayoutSearch {
 public:
  // With a script its decisions are taken, and none looked for.
  explicit LayoutSearch(CarriedMap map, const LayoutScript* script = nullptr) : best_(std::move(map)), script_(script) {}

  LayoutSearchResult run(const LayoutSearchOptions& options, const Progress& progress) {
    const double parts = 2.0 + static_cast<double>(options.finer.size());
    options_ = &options;
    begin_level();
    mapped_.corners = map_patches(best_.layout, progress.part(0, 0.05));
    mapped_.surface = best_.layout;
    smooth(options.map, progress.part(0.05, 1 / parts));
    accept();
    improve(progress.part(1 / parts, 2 / parts));
    LayoutSearchResult result;
    const bool optional = !script_ && options.stretch > 0;
    if (optional && !(largest_stretch(static_cast<int>(options.finer.size())) > options.stretch)) {
      result.stages.push_back({0, best_});
    } else {
      try {
        search_finer(result, options, progress.part(2 / parts, 1));
      } catch (const Error& e) {
        if (e.code() != ErrorCode::Internal || !optional) throw;
        // The base alone does, too. If it is that which cannot be carried, the caller tries a finer surface.
        while (result.stages.size() > 1) result.stages.pop_back();
        if (result.stages.empty()) result.stages.push_back({0, best_});
        best_edits_.resize(1);
        made_.levels.resize(1);
      }
    }
    result.edits = std::move(best_edits_);
    result.script = std::move(made_);
    return result;
  }

 private:
  // Maps on their way to the surface itself, each beside what is done meanwhile.
  class Carriers {
   public:
    ~Carriers() {
      try {
        tasks_.cancel();
        tasks_.wait();
      } catch (...) {
        // Another exception is on its way already.
      }
    }
    void carry(CarriedMap& map, const GlobalMapOptions& options, const Progress& progress) {
      tasks_.run([this, &map, &options, progress] {
        try {
          map.carry(std::numeric_limits<double>::infinity(), options, progress);
        } catch (...) {
          failed_.store(true, std::memory_order_relaxed);
          throw;
        }
      });
    }
    // Throws what a carrier has thrown: where one map cannot be carried, further search is in vain.
    void check() {
      if (failed_.load(std::memory_order_relaxed)) tasks_.wait();
    }
    void wait() { tasks_.wait(); }

   private:
    tbb::task_group tasks_;
    std::atomic<bool> failed_{false};
  };

  void search_finer(LayoutSearchResult& result, const LayoutSearchOptions& options, const Progress& progress) {
    const auto parts = static_cast<double>(options.finer.size());
    result.stages.reserve(options.finer.size() + 1);  // carriers hold on to them
    Carriers carriers;
    const auto keep = [&] {
      result.stages.push_back({static_cast<int>(best_edits_.size()) - 1, best_});
      if (!options.finer.empty()) carriers.carry(result.stages.back().map, options.map, progress.part(0, 0));
    };
    for (std::size_t i = 0; i < options.finer.size(); ++i) {
      const LayoutSearchOptions& finer = options.finer[i];
      const Progress part = progress.part(static_cast<double>(i) / parts, static_cast<double>(i + 1) / parts);
      if (result.stages.empty() || !best_edits_.back().empty()) keep();
      options_ = &finer;
      try {
        best_.carry(finer.vertices, finer.map, part.part(0.1, 0.2));
      } catch (const Error& e) {
        if (e.code() != ErrorCode::Internal) throw;  // a coarser surface than wished does as well as it can
      }
      best_.quadrisect();
      least_ *= 4;
      best_edits_.emplace_back();
      edits_ = best_edits_;
      begin_level();
      carriers.check();
      if (script_ ? !scripted().even.empty() : finer.even_quads > 0) relayout(part);
      carriers.check();
      improve(part.part(0.2, 1));
    }
    if (result.stages.empty() || !best_edits_.back().empty()) keep();
    carriers.wait();
  }

  // Of the quads of a level so many above the present one: how many times the mean area the largest covers, by the faces whose middles lie in it.
  double largest_stretch(int levels) const {
    const ChartMesh& c = best_.charts;
    const int cells = 1 << levels;
    std::vector<double> on_surface(static_cast<std::size_t>(best_.layout.patch_count()) * cells * cells, 0), in_chart = on_surface;
    for (int f = 0; f < c.mesh.face_count; ++f) {
      if (!c.mesh.alive[f]) continue;
      const Complex p = c.at(3 * f), q = c.at(3 * f + 1), r = c.at(3 * f + 2), middle = (p + q + r) / 3.0;
      const auto cell = [&](double x) { return std::clamp(static_cast<int>(x * cells), 0, cells - 1); };
      const std::size_t at = (static_cast<std::size_t>(c.chart[f]) * cells + cell(middle.real())) * cells + cell(middle.imag());
      on_surface[at] += c.flat(f).area;
      in_chart[at] += 0.5 * (std::conj(q - p) * (r - p)).imag();
    }
    double largest = 0;
    for (std::size_t i = 0; i < in_chart.size(); ++i)
      if (in_chart[i] > 0) largest = std::max(largest, on_surface[i] / in_chart[i]);
    return largest;
  }

  void begin_level() { made_.levels.push_back({options_->vertices, options_->map.vertices_a_quad, {}, {}}); }
  const LayoutScript::Level& scripted() const { return script_->levels[made_.levels.size() - 1]; }

  static LayoutOutline outline_of(const DrawnEdit& drawn, const PatchRegion& region) {
    constexpr std::size_t parts = 4;
    LayoutOutline outline;
    outline.quads = drawn.edit.quads;
    outline.nodes.resize(region.corners.size() + drawn.edit.inner_nodes);
    outline.sides.resize(outline.quads.size());
    for (std::size_t q = 0; q < outline.quads.size(); ++q)
      for (int i = 0; i < 4; ++i) {
        const std::vector<int>& side = drawn.piece.sides[q][i];
        const auto at = [&](std::size_t k) { return drawn.piece.mesh.points[side[k]]; };
        outline.nodes[outline.quads[q][i]] = at(0);
        const std::size_t last = side.size() - 1, count = std::min(parts, last);
        // Each line once; the boundary's is known.
        if (outline.quads[q][i] > outline.quads[q][(i + 1) % 4]) continue;
        for (std::size_t k = 0; k <= count; ++k) outline.sides[q][i].push_back(at(k * last / count));
      }
    return outline;
  }

  // The region cut along the sides of an outline's quads; without patches if there is no way to lay them out.
  PatchedSurface laid_out(LayoutOutline outline, const PatchRegion& region, const Progress& progress) const {
    const PatchedPart part = part_of(mapped_.surface, region.patches);
    for (std::size_t k = 0; k < region.corners.size(); ++k) {
      const PatchSide& s = region.boundary[k];
      const auto patch = std::find(region.patches.begin(), region.patches.end(), s.patch) - region.patches.begin();
      outline.nodes[k] = part.surface.mesh.points[part.surface.sides[patch][s.side].front()];
    }
    const TransferredLayout laid = transfer_layout(part.surface.mesh, outline, progress);
    return laid.failure.empty() ? to_patched_surface(laid.layout) : PatchedSurface();
  }

  // Share of the surface's area, a patch.
  std::vector<double> area_shares() const {
    const PatchedSurface& s = mapped_.surface;
    std::vector<double> share(s.patch_count(), 0);
    double all = 0;
    for (std::size_t f = 0; f < s.mesh.faces.size(); ++f) {
      const auto& c = s.mesh.faces[f];
      const double area = 0.5 * (s.mesh.points[c[1]] - s.mesh.points[c[0]]).cross(s.mesh.points[c[2]] - s.mesh.points[c[0]]).norm();
      share[s.patch[f]] += area;
      all += area;
    }
    for (double& x : share) x /= all;
    return share;
  }

  // Disks of patches of more energy than `least`, the smallest first.
  std::vector<PatchRegion> uneven_regions(const std::vector<double>& share, double least) const {
    const PatchedSurface& s = mapped_.surface;
    std::vector<char> uneven(s.patch_count(), 0);
    for (int q = 0; q < s.patch_count(); ++q) uneven[q] = energy_[q] > least || energy_[q] > least * share[q] * s.patch_count();
    std::vector<char> wide = dilated(s, uneven);
    // A region has a boundary: where all is uneven, the best stays.
    if (std::find(wide.begin(), wide.end(), 0) == wide.end()) wide[std::min_element(energy_.begin(), energy_.end()) - energy_.begin()] = 0;
    if (const std::vector<char> rim = boundary_nodes(s); std::find(rim.begin(), rim.end(), 1) != rim.end()) {
      open_to_loops(s, wide, energy_);
      part_at_nodes(s, wide);
    }
    std::vector<PatchRegion> regions = disks_around(s, wide);
    std::stable_sort(regions.begin(), regions.end(),
                     [&](const PatchRegion& a, const PatchRegion& b) { return sum_over(a, share) < sum_over(b, share); });
    return regions;
  }
  static double sum_over(const PatchRegion& region, const std::vector<double>& of) {
    double sum = 0;
    for (const int q : region.patches) sum += of[q];
    return sum;
  }

  // Even quads for the regions that need them.
  std::vector<LayoutScript::EvenLayout> find_even(std::vector<DrawnEdit>& drawn, const Progress& progress) const {
    const PatchedSurface& s = mapped_.surface;
    const std::vector<double> share = area_shares();
    std::vector<PatchRegion> regions;
    // How many new quads a region gets where there are `count` in all. The last one makes up for what those that stay are more or fewer than even
    // ones, as far as its own may differ.
    const auto wanted = [&](std::size_t i, double count) {
      const double even = std::max(1.0, sum_over(regions[i], share) * options_->even_quads);
      if (i + 1 < regions.size()) return even;
      return std::clamp(options_->even_quads - (count - static_cast<double>(regions[i].patches.size())), 0.7 * even, 1.3 * even);
    };
    // Quads that would do stay, unless there would be too many in all.
    for (const double part : {1.0, 0.5, 0.25, 0.0}) {
      regions = uneven_regions(share, part * options_->uneven);
      double count = s.patch_count();
      for (std::size_t i = 0; i < regions.size(); ++i) count += wanted(i, count) - static_cast<double>(regions[i].patches.size());
      if (count <= options_->quads) break;
    }
    double count = s.patch_count();
    std::vector<LayoutScript::EvenLayout> chosen;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const double quads = wanted(i, count);
      std::optional<DrawnEdit> edit = even_edit(s, regions[i], quads, 1, progress);
      if (!edit) continue;
      chosen.push_back({edit->edit, quads, outline_of(*edit, regions[i])});
      count += edit->edit.growth();
      drawn.push_back(std::move(*edit));
    }
    return chosen;
  }

  // The same quads as a script has them, along the same lines if this is the surface that it was made on; else their lines are left to the map.
  std::vector<LayoutScript::EvenLayout> repeat_even(std::vector<DrawnEdit>& drawn, const Progress& progress) const {
    for (const LayoutScript::EvenLayout& even : scripted().even) {
      require_fit(mapped_.surface, even.edit);
      DrawnEdit edit{even.edit, {}};
      const std::optional<PatchRegion> region = make_region(mapped_.surface, even.edit.patches, even.edit.start);
      if (!region) throw Error(ErrorCode::Internal, "the quads of an operation are no disk");
      std::optional<DrawnEdit> found = even.quads > 0 ? even_edit(mapped_.surface, *region, even.quads, 1, progress) : std::nullopt;
      if (found && found->edit.quads == even.edit.quads)
        edit = std::move(*found);
      else if (!even.outline.nodes.empty())
        edit.piece = laid_out(even.outline, *region, progress);
      drawn.push_back(std::move(edit));
    }
    return scripted().even;
  }

  void relayout(const Progress& progress) {
    try {
      cut(progress);
      std::vector<DrawnEdit> drawn;
      std::vector<LayoutScript::EvenLayout> chosen = script_ ? repeat_even(drawn, progress) : find_even(drawn, progress);
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        edits_.back().push_back(drawn[i].edit);
        const bool has_lines = !drawn[i].piece.patch.empty();
        const LayoutChange change = has_lines ? apply_edit(mapped_, std::move(drawn[i])) : apply_edit(mapped_, drawn[i].edit);
        map_patches(mapped_.surface, change.added, mapped_.corners, progress);
        for (std::size_t k = i + 1; k < drawn.size(); ++k) drawn[k].edit = renumbered(std::move(drawn[k].edit), change);
      }
      if (drawn.empty()) return;
      smooth(options_->map, progress);
      if (script_ || excess_ < least_) {
        accept();
        made_.levels.back().even = std::move(chosen);
      }
    } catch (const Error& e) {
      if (script_ || e.code() != ErrorCode::Internal) throw;
    }
    edits_ = best_edits_;
  }

  // Rounds of edits, and of smoothing after each, for as long as that gains.
  void improve(const Progress& progress) {
    if (script_) return repeat_rounds(progress);
    const int now = best_.layout.patch_count();
    most_ = now <= options_->quads ? options_->quads : now + now / 3;
    for (int round = 0; round < options_->rounds; ++round) {
      const Progress part = progress.part(static_cast<double>(round) / options_->rounds, (round + 1.0) / options_->rounds);
      try {
        cut(part.part(0, 0.1));
        std::vector<Candidate> candidates = find_candidates();
        tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
          part.check();
          candidates[i].gain = measure_gain(candidates[i], part.part(0.1, 0.1));
        });
        const std::vector<LayoutEdit> chosen = choose_best(candidates);
        if (chosen.empty()) return;
        apply(chosen, part);
        if (!(excess_ < least_)) return;
        accept();
        made_.levels.back().rounds.push_back(chosen);
      } catch (const Error& e) {
        // What was found before stays.
        if (e.code() != ErrorCode::Internal) throw;
        return;
      }
      part(1);
    }
  }

  void repeat_rounds(const Progress& progress) {
    for (const std::vector<LayoutEdit>& round : scripted().rounds) {
      cut(progress);
      apply(round, progress);
      accept();
      made_.levels.back().rounds.push_back(round);
    }
  }

  // Edits that do not shrink leave other patches' numbers alone.
  void apply(const std::vector<LayoutEdit>& edits, const Progress& progress) {
    for (const LayoutEdit& edit : edits) {
      if (script_) require_fit(mapped_.surface, edit);
      map_patches(mapped_.surface, apply_edit(mapped_, edit).added, mapped_.corners, progress.part(0.6, 0.6));
      edits_.back().push_back(edit);
    }
    GlobalMapOptions map = options_->map;
    // Most of the map is as it was the round before.
    map.newton_steps /= 2;
    map.cone_rounds /= 2;
    smooth(map, progress.part(0.6, 1));
  }

  // Where a vertex of the collapse hierarchy finds no place, a flatter hierarchy is tried.
  void smooth(GlobalMapOptions options, const Progress& progress) {
    for (int attempt = 0;; ++attempt) {
      try {
        fresh_.emplace(mapped_.surface, mapped_.corners);
        const GlobalMapReport report = smooth_map(*fresh_, mapped_.surface, options, progress);
        excess_ = (report.energy - 1) * mapped_.surface.patch_count();
        return;
      } catch (const Error& e) {
        if (e.code() != ErrorCode::Internal || attempt == 2) throw;
        options.vertices_a_quad *= 3;
      }
    }
  }

  void accept() {
    least_ = excess_;
    best_edits_ = edits_;
    best_.layout = mapped_.surface;
    best_.charts = std::move(*fresh_);
  }

  void cut(const Progress& progress) {
    scale_ = best_.charts.scale;
    mapped_ = best_.cut(progress);
    energy_.assign(mapped_.surface.patch_count(), 0);
    const Distortion density{options_->map.theta};
    for (int f = 0; f < static_cast<int>(mapped_.surface.patch.size()); ++f) energy_[mapped_.surface.patch[f]] += face_excess(f, density);
  }

  // Of one face: its energy less its area. A face is a piece of one on which the map is linear, and slivers count for as little as they cover.
  double face_excess(int f, const Distortion& density) const {
    const std::array<int, 3>& c = mapped_.surface.mesh.faces[f];
    const std::vector<Vec3>& p = mapped_.surface.mesh.points;
    const Vec3 e1 = scale_ * (p[c[1]] - p[c[0]]), e2 = scale_ * (p[c[2]] - p[c[0]]);
    const double l = e1.norm(), twice_area = e1.cross(e2).norm();
    if (!(l > 0 && twice_area > 1e-12)) return 0;
    const double x = e1.dot(e2) / l, y = twice_area / l;
    const std::array<Vec2, 3>& uv = mapped_.corners[f];
    const Vec2 du = (uv[1] - uv[0]) / l, dv = (uv[2] - uv[0] - x * du) / y;
    const Complex a = 0.5 * Complex(du.x() + dv.y(), du.y() - dv.x()), b = 0.5 * Complex(du.x() - dv.y(), du.y() + dv.x());
    const double s = std::norm(a), t = std::norm(b);
    return 0.5 * twice_area * ((s > t ? std::min(density.value(s, t), 100.0) : 100.0) - 1);
  }

  std::vector<Candidate> find_candidates() const {
    const PatchedSurface& s = mapped_.surface;
    const std::vector<int> valence = node_valences(s);
    const std::vector<char> on_boundary = boundary_nodes(s);
    std::vector<std::vector<int>> around(s.node_count);
    for (int q = 0; q < s.patch_count(); ++q)
      for (const int n : s.nodes[q]) around[n].push_back(q);
    // Two nodes are joined by one side at most, or the base's quads would be no manifold mesh.
    std::set<std::pair<int, int>> joined;
    for (const auto& nodes : s.nodes)
      for (int i = 0; i < 4; ++i) joined.insert(std::minmax(nodes[i], nodes[(i + 1) % 4]));
    std::vector<Candidate> found;
    const auto add = [&](const PatchRegion& region, const LayoutEdit& edit) {
      const std::optional<int> irregular = irregular_growth(s, region, edit, valence, on_boundary);
      if (!irregular) return;
      Candidate c{region, edit};
      c.irregular = *irregular;
      for (const int q : region.patches) c.excess += energy_[q];
      if (c.excess < options_->threshold * static_cast<double>(region.patches.size())) return;
      found.push_back(std::move(c));
    };
    const bool room = s.patch_count() < most_;
    const auto add_ring = [&](const std::vector<int>& patches) {
      if (!room) return;
      if (const auto region = make_region(s, patches))
        if (const LayoutEdit edit = tower_edit(s, *region, 1); s.patch_count() + edit.growth() <= most_) add(*region, edit);
    };
    for (int q = 0; q < s.patch_count(); ++q) {
      add_ring({q});
      for (int i = 0; i < 4; ++i) {
        const PatchSide other = s.neighbours[q][i];
        if (other.patch <= q) continue;
        add_ring({q, other.patch});
        if (const auto region = make_region(s, {q, other.patch}); region && region->corners.size() == 6) {
          // Corner `now` is where the side between them starts today.
          const int now = static_cast<int>(std::find(region->corners.begin(), region->corners.end(), s.nodes[q][i]) - region->corners.begin());
          for (const int from : {(now + 1) % 3, (now + 2) % 3})
            if (!joined.count(std::minmax(region->corners[from], region->corners[from + 3]))) add(*region, chord_edit(*region, from));
        }
      }
    }
    for (int n = 0; n < s.node_count; ++n) {
      if (on_boundary[n]) continue;
      std::vector<int> patches = around[n];
      std::sort(patches.begin(), patches.end());
      if (std::unique(patches.begin(), patches.end()) != patches.end()) continue;
      add_ring(patches);
      if (const auto region = make_region(s, patches); region && region->inner_nodes.size() == 1) {
        // The corner that the node is joined to now has an even or odd place; the other parity turns the star.
        int parity = 0;
        for (std::size_t k = 0; k < region->corners.size(); ++k) {
          const PatchSide& side = region->boundary[k];
          if (s.nodes[side.patch][(side.side + 3) % 4] == n) parity = static_cast<int>(k % 2);
        }
        add(*region, star_edit(*region, 1 - parity));
      }
    }
    std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
      const double x = a.excess / (a.region.patches.size() + a.edit.growth()), y = b.excess / (b.region.patches.size() + b.edit.growth());
      return x != y ? x > y : a.region.patches < b.region.patches;
    });
    if (static_cast<int>(found.size()) > options_->trials) found.resize(options_->trials);
    for (std::size_t i = 0, n = found.size(); i < n; ++i) {
      if (found[i].edit.rings == 0) continue;
      const int height = std::min(8, tower_height(s, found[i].region));
      if (height < 2) continue;
      Candidate tall = found[i];
      tall.edit = tower_edit(s, tall.region, height);
      if (s.patch_count() + tall.edit.growth() > most_) continue;
      found.push_back(std::move(tall));
    }
    return found;
  }

  // The region's patches, then those that share a node with it.
  std::vector<int> with_surroundings(const PatchRegion& region) const {
    const PatchedSurface& s = mapped_.surface;
    std::vector<char> in_region(s.patch_count(), 0), node(s.node_count, 0);
    for (const int q : region.patches) {
      in_region[q] = 1;
      for (const int n : s.nodes[q]) node[n] = 1;
    }
    std::vector<int> patches = region.patches;
    for (int q = 0; q < s.patch_count(); ++q)
      if (!in_region[q] && std::any_of(s.nodes[q].begin(), s.nodes[q].end(), [&](int n) { return node[n]; })) patches.push_back(q);
    return patches;
  }

  // How much energy the edit saves in the region and its surroundings, once they have relaxed within their rim.
  double measure_gain(const Candidate& candidate, const Progress& progress) const {
    const std::vector<int> patches = with_surroundings(candidate.region);
    double before = 0;
    for (const int q : patches) before += energy_[q];
    MappedSurface local;
    PatchedPart part = part_of(mapped_.surface, patches);
    local.surface = std::move(part.surface);
    for (const int f : part.face) local.corners.push_back(mapped_.corners[f]);
    // The region's patches come first in the part.
    LayoutEdit edit = candidate.edit;
    for (std::size_t k = 0; k < edit.patches.size(); ++k) edit.patches[k] = static_cast<int>(k);
    for (std::size_t k = 0; k < candidate.edit.patches.size(); ++k)
      if (candidate.edit.patches[k] == candidate.edit.start.patch) edit.start.patch = static_cast<int>(k);
    try {
      const std::vector<int> fresh = apply_edit(local, edit).added;
      map_patches(local.surface, fresh, local.corners, progress);
      ChartMesh charts(local.surface, local.corners);
      charts.scale = scale_;
      double area = 0;
      for (int f = 0; f < charts.mesh.face_count; ++f) area += charts.flat(f).area;
      GlobalMapOptions options = options_->map;
      options.newton_steps = 3;
      options.cone_rounds = 1;
      options.corners_move = false;  // the rim is held
      options.sweeps = 1;
      const GlobalMapReport report = smooth_map(charts, local.surface, options, progress);
      return before - (report.energy - 1) * area;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::Internal) throw;
      return -1e300;
    }
  }

  std::vector<LayoutEdit> choose_best(std::vector<Candidate>& candidates) const {
    std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) { return worth(a) > worth(b); });
    const PatchedSurface& s = mapped_.surface;
    std::vector<char> touched(s.patch_count(), 0);
    std::vector<LayoutEdit> chosen;
    int size = s.patch_count();
    for (const Candidate& c : candidates) {
      if (worth(c) <= 0.05) break;
      if (size + c.edit.growth() > most_) continue;
      const std::vector<int> patches = with_surroundings(c.region);
      if (std::any_of(patches.begin(), patches.end(), [&](int q) { return touched[q]; })) continue;
      for (const int q : patches) touched[q] = 1;
      size += c.edit.growth();
      chosen.push_back(c.edit);
    }
    return chosen;
  }

  double worth(const Candidate& c) const { return c.gain - options_->price * c.edit.growth() - options_->irregular_price * c.irregular; }

  CarriedMap best_;  // the best found
  const LayoutScript* script_;
  LayoutScript made_;
  std::optional<ChartMesh> fresh_;
  MappedSurface mapped_;                          // cut along the best layout, or an edited one
  const LayoutSearchOptions* options_ = nullptr;  // of the present level
  std::vector<LevelEdits> best_edits_, edits_{1};
  int most_ = 0;                   // quads that the layout may grow to
  double least_ = 0, excess_ = 0;  // energy of the best and of the fresh map beyond an isometry's, in quads of the present level
  double scale_ = 1;
  std::vector<double> energy_;  // per patch, beyond an isometry's
};

}  // namespace

LayoutSearchResult search_layout(CarriedMap map, const LayoutSearchOptions& options, const Progress& progress) {
  return LayoutSearch(std::move(map)).run(options, progress);
}

LayoutSearchResult repeat_search(CarriedMap map, const LayoutScript& script, const Progress& progress) {
  if (script.levels.empty()) throw Error(ErrorCode::Internal, "a script has no level");
  std::vector<LayoutSearchOptions> levels(script.levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].vertices = script.levels[i].vertices;
    if (script.levels[i].vertices_a_quad > 0) levels[i].map.vertices_a_quad = script.levels[i].vertices_a_quad;
  }
  LayoutSearchOptions options = levels.front();
  options.finer.assign(levels.begin() + 1, levels.end());
  return LayoutSearch(std::move(map), &script).run(options, progress);
}

}  // namespace hybrid_mesh
