// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "layout/operations/region_repatch.h"
#include "topology/surface_series.h"

namespace hybrid_mesh {

// Words and bounds of a plan's JSON text that reading and writing share.
namespace plan_format {
using Json = nlohmann::ordered_json;
inline constexpr const char* kFormat = "hybrid-mesh plan";
inline constexpr int kVersion = 1;
inline constexpr const char* kAutomatic = "automatic";
// Words for the ways in which a region is laid out without curves.
inline constexpr std::array<std::pair<RegionPattern::Kind, const char*>, 5> kRegionLayouts{{{RegionPattern::Kind::Automatic, kAutomatic},
                                                                                            {RegionPattern::Kind::Cubes, "cubes"},
                                                                                            {RegionPattern::Kind::Rows, "rows"},
                                                                                            {RegionPattern::Kind::Even, "even"},
                                                                                            {RegionPattern::Kind::Template, "template"}}};
inline constexpr std::array<std::pair<EventKind, const char*>, 3> kEventKinds{
    {{EventKind::Cut, "cut"}, {EventKind::Tube, "tube"}, {EventKind::Boundary, "boundary"}}};
}  // namespace plan_format

// A value of the plan and its place in it, for messages.
class PlanEntry {
 public:
  PlanEntry(const plan_format::Json& json, std::string place) : json_(&json), place_(std::move(place)) {}

  [[noreturn]] void refuse(const std::string& what) const { throw Error(ErrorCode::InvalidInput, "the plan's " + place_ + " " + what); }

  bool has(const char* key) const { return object().json_->contains(key); }
  PlanEntry at(const char* key) const {
    if (!has(key)) refuse(std::string("has no \"") + key + "\"");
    return {(*json_)[key], place_ == kTop ? std::string(key) : place_ + "." + key};
  }
  void only(const std::set<std::string>& keys) const {
    for (const auto& [key, value] : object().json_->items())
      if (!keys.count(key)) refuse("has \"" + key + "\", which means nothing");
  }
  std::vector<PlanEntry> list() const {
    if (!json_->is_array()) refuse("must be a list");
    std::vector<PlanEntry> out;
    for (std::size_t i = 0; i < json_->size(); ++i) out.push_back({(*json_)[i], place_ + "[" + std::to_string(i) + "]"});
    return out;
  }
  std::vector<PlanEntry> list(std::size_t size) const {
    std::vector<PlanEntry> out = list();
    if (out.size() != size) refuse("must have " + std::to_string(size) + " entries, not " + std::to_string(out.size()));
    return out;
  }
  std::int64_t integer(std::int64_t least, std::int64_t most) const {
    // What is larger than any signed number would become a negative one.
    const bool huge =
        json_->is_number_unsigned() && json_->get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (!json_->is_number_integer() || huge || json_->get<std::int64_t>() < least || json_->get<std::int64_t>() > most)
      refuse("must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return json_->get<std::int64_t>();
  }
  int index(std::size_t count) const { return static_cast<int>(integer(0, static_cast<std::int64_t>(count) - 1)); }
  double number(double least) const {
    if (!json_->is_number() || !std::isfinite(json_->get<double>()) || json_->get<double>() < least)
      refuse("must be a finite number, at least " + plan_format::Json(least).dump());
    return json_->get<double>();
  }
  std::string text() const {
    if (!json_->is_string()) refuse("must be text");
    return json_->get<std::string>();
  }
  bool is(const char* word) const { return json_->is_string() && json_->get<std::string>() == word; }
  Vec3 point() const {
    const std::vector<PlanEntry> c = list(3);
    constexpr double any = -std::numeric_limits<double>::max();
    return {c[0].number(any), c[1].number(any), c[2].number(any)};
  }

  static constexpr const char* kTop = "top level";

 private:
  const PlanEntry& object() const {
    if (!json_->is_object()) refuse("must be an object");
    return *this;
  }
  const plan_format::Json* json_;
  std::string place_;
};

}  // namespace hybrid_mesh
