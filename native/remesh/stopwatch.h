// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>

namespace hybrid_mesh {

// Seconds of wall time a stage. Stages follow one another, and one that comes again is added to.
class Stopwatch {
 public:
  void start(const char* stage) {
    stop();
    stage_ = stage;
    begin_ = Clock::now();
  }
  void stop() {
    if (!stage_) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    total_ += seconds;
    json_[stage_] = json_.value(stage_, 0.0) + seconds;
    stage_ = nullptr;
  }
  nlohmann::ordered_json json() const {
    nlohmann::ordered_json j = json_;
    j["total"] = total_;
    return j;
  }

 private:
  using Clock = std::chrono::steady_clock;
  const char* stage_ = nullptr;
  Clock::time_point begin_;
  double total_ = 0;
  nlohmann::ordered_json json_ = nlohmann::ordered_json::object();
};

}  // namespace hybrid_mesh
