// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/fit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "remesh/block_matrix.h"
#include "remesh/quality.h"

namespace hybrid_mesh {
namespace {

constexpr double kMostLever = 3;  // times the distance of its samples, a vertex moves in a round

// The mesh split into triangles, quads along the diagonal that leaves the flatter pair, and what lies across each triangle's edges. A coarse mesh may
// have two faces with the same diagonal, so that adjacency goes by faces' sides, not by pairs of vertices of triangles.
struct TriangleCover {
  std::vector<std::array<int, 3>> faces;
  std::vector<int> opposite;  // per half-edge 3 t + i, -1: none
  std::vector<int> first;     // per face of the mesh: its first triangle
  std::vector<int> face_of;   // per triangle

  explicit TriangleCover(const QuadMesh& mesh) {
    const std::vector<Vec3>& p = mesh.points;
    const auto flatness = [&](int a, int b, int c, int d) {
      const Vec3 n1 = (p[b] - p[a]).cross(p[c] - p[a]), n2 = (p[c] - p[a]).cross(p[d] - p[a]);
      const double l = std::sqrt(n1.squaredNorm() * n2.squaredNorm());
      return l > 0 ? n1.dot(n2) / l : -1.0;
    };
    struct Side {
      std::int64_t key;
      int half_edge;
      bool operator<(const Side& o) const { return key != o.key ? key < o.key : half_edge < o.half_edge; }
    };
    std::vector<Side> sides;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      first.push_back(static_cast<int>(faces.size()));
      const std::int32_t* v = &mesh.indices[mesh.offsets[f]];
      const int n = static_cast<int>(mesh.offsets[f + 1] - mesh.offsets[f]);
      const int start = n == 4 && flatness(v[1], v[2], v[3], v[0]) > flatness(v[0], v[1], v[2], v[3]) ? 1 : 0;
      for (int i = 1; i + 1 < n; ++i) {
        const int t = static_cast<int>(faces.size());
        faces.push_back({v[start], v[(start + i) % n], v[(start + i + 1) % n]});
        face_of.push_back(static_cast<int>(f));
        opposite.insert(opposite.end(), {-1, -1, -1});
        if (i > 1) {
          opposite[3 * t] = 3 * (t - 1) + 2;
          opposite[3 * (t - 1) + 2] = 3 * t;
        }
        for (const int k : {0, 1, 2}) {
          if ((k == 0 && i > 1) || (k == 2 && i + 2 < n)) continue;  // a diagonal
          const auto [low, high] = std::minmax(faces[t][k], faces[t][(k + 1) % 3]);
          sides.push_back({(static_cast<std::int64_t>(low) << 32) | high, 3 * t + k});
        }
      }
    }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0; i < sides.size();) {
      std::size_t j = i + 1;
      while (j < sides.size() && sides[j].key == sides[i].key) ++j;
      if (j == i + 2) {
        opposite[sides[i].half_edge] = sides[i + 1].half_edge;
        opposite[sides[i + 1].half_edge] = sides[i].half_edge;
      }
      i = j;
    }
  }
};

struct Closest {
  double squared;
  std::array<double, 3> weights;
};

// Closest point of a triangle (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
Closest closest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  double v = 0, w = 0;
  if (d1 > 0 || d2 > 0) {
    const Vec3 bx = x - b, cx = x - c;
    const double d3 = ab.dot(bx), d4 = ac.dot(bx), d5 = ab.dot(cx), d6 = ac.dot(cx);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (d3 >= 0 && d4 <= d3) {
      v = 1;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
      v = d1 / (d1 - d3);
    } else if (d6 >= 0 && d5 <= d6) {
      w = 1;
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
      w = d2 / (d2 - d6);
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
      w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
      v = 1 - w;
    } else {
      const double s = va + vb + vc;
      if (s > 0) v = vb / s, w = vc / s;
    }
  }
  const Vec3 q = a + v * ab + w * ac;
  return {(x - q).squaredNorm(), {1 - v - w, v, w}};
}

// Walks from a triangle to neighbours that are closer.
Closest walk(const TriangleCover& t, const std::vector<Vec3>& p, const Vec3& x, int& face) {
  Closest best = closest_on_triangle(x, p[t.faces[face][0]], p[t.faces[face][1]], p[t.faces[face][2]]);
  for (int step = 0; step < 24; ++step) {
    int better = -1;
    Closest found = best;
    const auto look = [&](int h) {
      if (h < 0) return;
      const int g = h / 3;
      const Closest c = closest_on_triangle(x, p[t.faces[g][0]], p[t.faces[g][1]], p[t.faces[g][2]]);
      if (c.squared < found.squared) found = c, better = g;
    };
    const int h = 3 * face;
    for (int i = 0; i < 3; ++i) {
      // On the edge opposite to corner i + 2, that is half-edge i.
      if (best.weights[(i + 2) % 3] <= 1e-12) look(t.opposite[h + i]);
      // At corner i: every triangle around it may be closer.
      if (best.weights[i] < 1 - 1e-12) continue;
      int g = t.opposite[h + (i + 2) % 3];
      for (int turn = 0; turn < 32 && g >= 0 && g / 3 != face; ++turn) {
        look(g);
        g = t.opposite[TriangleSurface::previous(g)];
      }
      if (g >= 0) continue;
      // A boundary: the other way round.
      g = t.opposite[h + i];
      for (int turn = 0; turn < 32 && g >= 0 && g / 3 != face; ++turn) {
        look(g);
        g = t.opposite[TriangleSurface::next(g)];
      }
    }
    if (better < 0) break;
    best = found;
    face = better;
  }
  return best;
}

// Edge neighbours of every vertex, for the uniform Laplacian (the mean of the neighbours less the vertex).
struct Neighbours : CompressedRows {
  explicit Neighbours(const QuadMesh& mesh) : CompressedRows(along_edges(mesh)) {}

  static std::vector<std::vector<int>> along_edges(const QuadMesh& mesh) {
    std::vector<std::vector<int>> lists(mesh.points.size());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) {
        const int a = mesh.indices[i], b = mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]];
        lists[a].push_back(b);
        lists[b].push_back(a);
      }
    return lists;
  }
  Vec3 laplacian(const std::vector<Vec3>& x, int v) const {
    Vec3 sum = Vec3::Zero();
    for (int k = row[v]; k < row[v + 1]; ++k) sum += x[column[k]];
    return sum / std::max(1, row[v + 1] - row[v]) - x[v];
  }
  // The transposed operator.
  Vec3 transposed(const std::vector<Vec3>& x, int v) const {
    Vec3 sum = -x[v];
    for (int k = row[v]; k < row[v + 1]; ++k) {
      const int w = column[k];
      sum += x[w] / std::max(1, row[w + 1] - row[w]);
    }
    return sum;
  }
};

template <class Body>
void for_all(int n, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<int>(0, n, 2048), [&](const tbb::blocked_range<int>& r) {
    for (int i = r.begin(); i < r.end(); ++i) body(i);
  });
}

// In a fixed order, whatever the number of threads.
double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

// As long as the face is large, twice.
Vec3 area_vector(const QuadMesh& mesh, const std::vector<Vec3>& points, std::size_t f) {
  const std::int64_t begin = mesh.offsets[f], end = mesh.offsets[f + 1];
  const Vec3& origin = points[mesh.indices[begin]];
  Vec3 sum = Vec3::Zero();
  for (std::int64_t i = begin + 1; i + 1 < end; ++i) sum += (points[mesh.indices[i]] - origin).cross(points[mesh.indices[i + 1]] - origin);
  return sum;
}

std::vector<Vec3> vertex_normals(const QuadMesh& mesh) {
  std::vector<Vec3> normals(mesh.points.size(), Vec3::Zero());
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Vec3 sum = area_vector(mesh, mesh.points, f);
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) normals[mesh.indices[i]] += sum;
  }
  for (Vec3& n : normals) {
    const double l = n.norm();
    if (l > 0) n /= l;
  }
  return normals;
}

// Per vertex, by the worst of its quads.
std::vector<double> smoothness_at(const QuadMesh& mesh, const FitOptions& options) {
  std::vector<double> smoothness(mesh.points.size(), options.smoothness);
  if (options.square_smoothness == options.smoothness) return smoothness;
  std::vector<double> worst(mesh.points.size(), 1);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    // What is no quad has the shape that its hanging nodes give it.
    const double jacobian = mesh.offsets[f + 1] - mesh.offsets[f] == 4 ? scaled_jacobian(mesh, f) : 0.5;
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) worst[mesh.indices[i]] = std::min(worst[mesh.indices[i]], jacobian);
  }
  const double ratio = options.square_smoothness / options.smoothness;
  for (std::size_t v = 0; v < worst.size(); ++v)
    smoothness[v] *= std::pow(ratio, std::clamp((worst[v] - options.poor) / (options.square - options.poor), 0.0, 1.0));
  return smoothness;
}

// The sine of a face's corner, seen along a normal: negative where the face is folded there.
double corner_sine(const QuadMesh& mesh, const std::vector<Vec3>& points, std::size_t f, int i, const Vec3& normal) {
  const std::int32_t* v = &mesh.indices[mesh.offsets[f]];
  const int n = static_cast<int>(mesh.offsets[f + 1] - mesh.offsets[f]);
  const Vec3 out = points[v[(i + 1) % n]] - points[v[i]], in = points[v[(i + n - 1) % n]] - points[v[i]];
  const double l = out.norm() * in.norm();
  return l > 0 ? out.cross(in).dot(normal) / l : 0.0;
}

constexpr double kLeastSine = 0.05;
constexpr int kHalvings = 3;  // of a vertex's way, before it stays where it was

// Takes back the ways of vertices that would fold a face, seen from where it looked to before: no corner gets below the least sine, unless it was
// there.
void keep_unfolded(QuadMesh& mesh, const std::vector<Vec3>& before) {
  const std::vector<Vec3> after = mesh.points;
  std::vector<int> halved(before.size(), 0);
  std::vector<std::size_t> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), std::size_t{0});
  std::vector<std::vector<int>> around;
  while (!faces.empty()) {
    std::vector<int> back;
    for (const std::size_t f : faces) {
      const std::int64_t begin = mesh.offsets[f];
      const int n = static_cast<int>(mesh.offsets[f + 1] - begin);
      const Vec3 normal = area_vector(mesh, before, f).normalized();
      bool folded = false;
      for (int i = 0; i < n && !folded; ++i) {
        const double sine = corner_sine(mesh, mesh.points, f, i, normal);
        folded = sine < kLeastSine && sine < corner_sine(mesh, before, f, i, normal);
      }
      if (folded)
        for (int i = 0; i < n; ++i)
          if (halved[mesh.indices[begin + i]] <= kHalvings) back.push_back(mesh.indices[begin + i]);
    }
    std::sort(back.begin(), back.end());
    back.erase(std::unique(back.begin(), back.end()), back.end());
    if (back.empty()) return;
    if (around.empty()) {
      around.resize(before.size());
      for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) around[mesh.indices[i]].push_back(static_cast<int>(f));
    }
    faces.clear();
    for (const int v : back) {
      mesh.points[v] = ++halved[v] > kHalvings ? before[v] : Vec3(before[v] + std::ldexp(1.0, -halved[v]) * (after[v] - before[v]));
      faces.insert(faces.end(), around[v].begin(), around[v].end());
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  }
}

}  // namespace

std::vector<char> held_vertices(const QuadMesh& mesh) {
  std::vector<char> held = boundary_vertices(mesh);
  if (mesh.sharp.empty()) return held;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
      if (mesh.sharp[i]) held[mesh.indices[i]] = held[mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]]] = 1;
  return held;
}

std::vector<char> boundary_vertices(const QuadMesh& mesh) {
  std::vector<std::pair<int, int>> edges;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
      edges.push_back(std::minmax<int>(mesh.indices[i], mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]]));
  std::sort(edges.begin(), edges.end());
  std::vector<char> boundary(mesh.points.size(), 0);
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i + 1;
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j == i + 1) boundary[edges[i].first] = boundary[edges[i].second] = 1;
    i = j;
  }
  return boundary;
}

std::vector<FitAnchor> closest_anchors(const QuadMesh& mesh, std::vector<FitSample>& samples) {
  const TriangleCover cover(mesh);
  std::vector<FitAnchor> anchors(samples.size());
  for_all(static_cast<int>(samples.size()), [&](int i) {
    int t = cover.first[samples[i].face];
    const Closest closest = walk(cover, mesh.points, samples[i].position, t);
    samples[i].face = cover.face_of[t];
    anchors[i] = {cover.faces[t], closest.weights, closest.squared};
  });
  return anchors;
}

std::vector<double> squared_distances(const QuadMesh& mesh, std::vector<FitSample>& samples) {
  std::vector<double> result;
  result.reserve(samples.size());
  for (const FitAnchor& anchor : closest_anchors(mesh, samples)) result.push_back(anchor.squared_distance);
  return result;
}

void fit_mesh(QuadMesh& mesh, const std::vector<char>& fixed, const std::vector<double>& share, std::vector<FitSample>& samples,
              const FitOptions& options, const Progress& progress) {
  const int n = static_cast<int>(mesh.points.size());
  if (n == 0 || samples.empty()) return;
  BlockMatrix matrix(mesh);
  const Neighbours neighbours(mesh);
  // The regulariser of a vertex is measured against the samples' weight that is meant to fall to it. (Not what does fall to it: at creases some get
  // none.)
  std::vector<double> part(n), regularizer(n);
  double weight_sum = 0, share_sum = 0;
  for (const FitSample& s : samples) weight_sum += s.weight;
  for (const double x : share) share_sum += x;
  for (int v = 0; v < n; ++v) part[v] = weight_sum * (share.empty() ? 1.0 / n : share[v] / share_sum);
  for (int round = 0; round < options.rounds; ++round) {
    progress(static_cast<double>(round) / options.rounds);
    const std::vector<double> smoothness = smoothness_at(mesh, options);
    for (int v = 0; v < n; ++v) regularizer[v] = smoothness[v] * part[v];
    const std::vector<FitAnchor> anchors = closest_anchors(mesh, samples);
    progress.check();
    for (Eigen::Matrix3d& b : matrix.block) b.setZero();
    std::vector<Vec3> right(n, Vec3::Zero());
    std::vector<double> pull(n, 0), hold(n, 0);  // of the samples at each vertex, and how firmly they hold it
    const double a = options.tangential;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i % 65536 == 0) progress.check();
      const Vec3& normal = samples[i].normal;
      const double weight = samples[i].weight;
      const Eigen::Matrix3d metric = weight * (a * Eigen::Matrix3d::Identity() + (1 - a) * normal * normal.transpose());
      const Vec3 target = metric * samples[i].position;
      for (int p = 0; p < 3; ++p) {
        if (anchors[i].weights[p] == 0) continue;
        right[anchors[i].vertices[p]] += anchors[i].weights[p] * target;
        pull[anchors[i].vertices[p]] += anchors[i].weights[p] * weight;
        hold[anchors[i].vertices[p]] += anchors[i].weights[p] * anchors[i].weights[p] * weight;
        for (int q = 0; q < 3; ++q)
          if (anchors[i].weights[q] != 0)
            matrix.block[matrix.find(anchors[i].vertices[p], anchors[i].vertices[q])] += anchors[i].weights[p] * anchors[i].weights[q] * metric;
      }
    }
    // A vertex all of whose samples are at the far ends of its faces would be thrown by the lever that they are: this much holds it where it is.
    std::vector<double> damping(n);
    for (int v = 0; v < n; ++v) damping[v] = std::max(0.0, pull[v] / kMostLever - hold[v]);
    // The Laplacian's normal part stays what it is (curvature), its tangential part is drawn to zero.
    const std::vector<Vec3> normals = vertex_normals(mesh);
    std::vector<Vec3> wanted(n);
    for_all(n, [&](int v) { wanted[v] = fixed[v] ? Vec3(Vec3::Zero()) : Vec3(normals[v] * normals[v].dot(neighbours.laplacian(mesh.points, v))); });
    std::vector<Vec3> bent(n);
    const auto apply = [&](const std::vector<Vec3>& x, std::vector<Vec3>& y) {
      for_all(n, [&](int v) { bent[v] = fixed[v] ? Vec3(Vec3::Zero()) : Vec3(regularizer[v] * neighbours.laplacian(x, v)); });
      for_all(n, [&](int v) {
        Vec3 sum = neighbours.transposed(bent, v) + damping[v] * x[v];
        for (int k = matrix.row[v]; k < matrix.row[v + 1]; ++k) sum.noalias() += matrix.block[k] * x[matrix.column[k]];
        y[v] = fixed[v] ? Vec3(Vec3::Zero()) : sum;
      });
    };
    // Conjugate gradients on the free vertices, preconditioned by the diagonal blocks.
    std::vector<Eigen::Matrix3d> inverse(n);
    for_all(n, [&](int v) {
      const double diagonal = 1.25 * regularizer[v] + damping[v];
      inverse[v] = (matrix.block[matrix.find(v, v)] + (diagonal + 1e-300) * Eigen::Matrix3d::Identity()).inverse();
    });
    std::vector<Vec3> residual(n), z(n), direction(n), image(n);
    const std::vector<Vec3> before = mesh.points;
    {
      // The residual at the present positions; fixed vertices enter as data, their own Laplacian being no term.
      std::vector<Vec3> y(n);
      for_all(n, [&](int v) { bent[v] = fixed[v] ? Vec3(Vec3::Zero()) : Vec3(regularizer[v] * (neighbours.laplacian(mesh.points, v) - wanted[v])); });
      for_all(n, [&](int v) {
        Vec3 sum = neighbours.transposed(bent, v);
        for (int k = matrix.row[v]; k < matrix.row[v + 1]; ++k) sum.noalias() += matrix.block[k] * mesh.points[matrix.column[k]];
        residual[v] = fixed[v] ? Vec3(Vec3::Zero()) : Vec3(right[v] - sum);
      });
    }
    for_all(n, [&](int v) { z[v] = inverse[v] * residual[v]; });
    direction = z;
    double rho = dot(residual, z);
    const double first = rho;
    for (int iteration = 0; iteration < options.iterations && rho > 1e-10 * first; ++iteration) {
      progress.check();
      apply(direction, image);
      const double curvature = dot(direction, image);
      if (!(curvature > 0)) break;
      const double step = rho / curvature;
      for_all(n, [&](int v) {
        mesh.points[v] += step * direction[v];
        residual[v] -= step * image[v];
        z[v] = inverse[v] * residual[v];
      });
      const double fresh = dot(residual, z);
      const double ratio = fresh / rho;
      rho = fresh;
      for_all(n, [&](int v) { direction[v] = z[v] + ratio * direction[v]; });
    }
    // Elsewhere quads that fold for a round find a way around what is bent (a buddha's L2 is 4 % larger without).
    if (!mesh.sharp.empty()) keep_unfolded(mesh, before);
  }
  progress(1);
}

}  // namespace hybrid_mesh
