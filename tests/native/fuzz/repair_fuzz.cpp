// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes as a soup over a few points, so that nothing is lost to syntax: every kind of tangle, coincident and collinear points.
#include "read_and_repair.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hybrid_mesh;
  if (size < 8 || size > 4096) return 0;
  const int point_count = 3 + data[0] % 24, lattice = 2 + data[1] % 6;
  PolygonSoup soup;
  std::size_t at = 2;
  const auto next = [&] { return at < size ? data[at++] : 0; };
  for (int i = 0; i < point_count; ++i) {
    const double x = next() % lattice, y = next() % lattice, z = next() % lattice;
    soup.points.push_back({x, y, z});
  }
  while (at < size) {
    const int corners = data[at] & 0x80 ? 3 + (data[at] >> 5 & 3) : 3;
    for (int i = 0; i < corners; ++i) soup.indices.push_back((next() & 0x1f) % point_count);
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  try {
    Context context;
    RepairReport report;
    const TriangleSurface surface = repair(soup, {}, report, Progress(context));
    const TopologySummary t = summarize_topology(to_soup(surface));
    if (t.nonmanifold_edges || t.nonmanifold_vertices || t.misoriented_edges || t.genus != std::floor(t.genus) || t.genus < 0) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::InvalidInput) std::abort();
  }
  return 0;
}
