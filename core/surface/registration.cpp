// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/registration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/surface/mesh.h"
#include "core/surface/mesh_topology.h"
#include "core/surface/registration_starts.h"

namespace glint {
namespace {
using Eigen::Vector3d;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

constexpr std::size_t kFewest = 20;                        // points on the mesh: 7 unknowns, and some must contradict
constexpr double kLeastShare = 0.1;                        // of the points on the mesh: fewer lie on any surface by chance
constexpr std::size_t kMostPoints = 2000;                  // of a cloud: more do not change the answer
constexpr std::size_t kShortPoints = 400, kMostLong = 12;  // a first round sorts the starts, a second one is exact
constexpr int kShortRounds = 14, kLongRounds = 40;
constexpr double kStill = 1e-10;                            // radii of the mesh: a step that changes nothing
constexpr int kCoarseSamples = 4000, kFineSamples = 10000;  // of the mesh, for starts and for its nearest triangles
constexpr int kNearest = 3;                // samples whose triangles are asked: the nearest sample may lie on a neighbour
constexpr double kFirstScale = 0.1;        // radii of the mesh: the error of a start
constexpr double kWorstSigma = 0.02;       // of the mesh's size: points that scatter more show no surface
constexpr double kSigmaOfMedian = 1.4826;  // standard deviation of a normal distribution over its median absolute deviation
constexpr double kOn = 2.5;                // standard deviations: 99 % of the mesh's points are nearer, few of another place are
constexpr double kLeastScatter = 0.002;    // of the mesh's size, where solutions are compared: facets are off by as much
constexpr double kElsewhere = 0.02;        // of the mesh's size, that another solution moves a corner by
constexpr double kSameSurface = 0.005;     // of the mesh's size, from one to the other: no highlight tells them apart
constexpr double kNearlyAsMany = 0.8;      // of the explained points: noise could turn the order
constexpr double kMostHidden = 0.1;        // of the explained points; edges and noise hide a few
constexpr double kAlong = 0.999;           // cosine of 2.6 degrees, from the normal: facets' normals are no more exact
constexpr double kElsewherePoint = 1e100;  // the distance of a point beside the border
constexpr double kSlides = 1e-3;           // mean square of the motion across the surface over that of the motion
constexpr double kMostUncertain = 0.02;    // of the mesh's size, standard deviation of a corner

/// Nearest point of a triangle. @see Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5.
Vector3d nearestOnTriangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return d1 > d3 ? Vector3d(a + d1 / (d1 - d3) * ab) : a;
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return d2 > d6 ? Vector3d(a + d2 / (d2 - d6) * ac) : a;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return sum > 0 ? Vector3d(a + vb / sum * ab + vc / sum * ac) : a;
}

/// Nearest points of a mesh, in its own frame: from the triangles of the nearest samples over neighbours that are nearer.
class NearestOnMesh {
 public:
  NearestOnMesh(const TriangleMesh& mesh, const MeshSamples& samples) : mesh_(mesh), samples_(samples) {
    first_.assign(mesh.vertices.size() + 1, 0);
    for (const Eigen::Vector3i& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) ++first_[std::size_t(t[k]) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    around_.resize(3 * mesh.triangles.size());
    std::vector<int> at(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) around_[std::size_t(at[std::size_t(mesh.triangles[i][k])]++)] = static_cast<int>(i);
    const MeshTopology topology = topologyOf(mesh);
    ofBorder_.assign(mesh.vertices.size(), false);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k)
        if (topology.alive[i] && topology.neighbours[i][k] < 0)
          for (const int end : {k, (k + 1) % 3}) ofBorder_[std::size_t(mesh.triangles[i][end])] = true;
  }
  struct Foot {
    Vector3d point, normal;  ///< normal: of the triangle, unit; zero where it has no area
    bool onBorder = false;   ///< the mesh ends there
    /// Whether a point at this offset from the foot lies on what the mesh does not show, beside its border.
    bool isBeside(const Vector3d& away, const Vector3d& turnedNormal) const {
      return onBorder && std::abs(away.dot(turnedNormal)) < kAlong * away.norm();
    }
  };
  Foot operator()(const Vector3d& p) const {
    Vector3d best = Vector3d::Zero();
    double least = std::numeric_limits<double>::max();
    int on = -1;
    const auto offer = [&](int triangle) {
      const auto& [a, b, c] = cornersOfTriangle(triangle);
      const Vector3d foot = nearestOnTriangle(p, a, b, c);
      const double d = (foot - p).squaredNorm();
      if (d < least) least = d, best = foot, on = triangle;
    };
    for (const int i : samples_.nearest(p, kNearest)) offer(samples_.triangles()[std::size_t(i)]);
    for (int from = -1; from != on;) {
      from = on;
      for (int k = 0; k < 3; ++k) {
        const auto corner = std::size_t(mesh_.triangles[std::size_t(from)][k]);
        for (int n = first_[corner]; n < first_[corner + 1]; ++n) offer(around_[std::size_t(n)]);
      }
    }
    if (on < 0) return {Vector3d::Constant(std::numeric_limits<double>::max()), Vector3d::Zero(), false};  // p is out of range
    const auto& [a, b, c] = cornersOfTriangle(on);
    return {best, (b - a).cross(c - a).normalized(), isOnBorder(best, on)};
  }

 private:
  /// Whether the place is on a corner of the border, or between two of them: an edge between border corners counts as border.
  bool isOnBorder(const Vector3d& p, int triangle) const {
    constexpr double kOnEdge = 1e-9;  // of the edge's length: nearestOnTriangle is as exact
    const std::array<Vector3d, 3> corners = cornersOfTriangle(triangle);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const Eigen::Vector3i& t = mesh_.triangles[std::size_t(triangle)];
      if (!ofBorder_[std::size_t(t[k])]) continue;
      const Vector3d &a = corners[std::size_t(k)], along = corners[std::size_t(next)] - a;
      if ((p - a).norm() <= kOnEdge * along.norm()) return true;
      if (ofBorder_[std::size_t(t[next])] && (p - a).cross(along).norm() <= kOnEdge * along.squaredNorm()) return true;
    }
    return false;
  }
  std::array<Vector3d, 3> cornersOfTriangle(int triangle) const {
    const Eigen::Vector3i& t = mesh_.triangles[std::size_t(triangle)];
    return {mesh_.vertices[std::size_t(t[0])], mesh_.vertices[std::size_t(t[1])], mesh_.vertices[std::size_t(t[2])]};
  }
  const TriangleMesh& mesh_;
  const MeshSamples& samples_;
  std::vector<int> first_, around_;  // triangles of a vertex: around_[first_[v]] to before around_[first_[v + 1]]
  std::vector<bool> ofBorder_;       // of a vertex
};

/// One place of the mesh and how it explains the points.
struct Solution {
  Similarity pointsFromMesh;
  std::vector<double> distances;  ///< of each point from the mesh
  double sigma = 0;               ///< of the points on it, robustly
  double logLikelihood = -std::numeric_limits<double>::max();
  std::size_t explained(double tolerance) const {
    return std::size_t(std::count_if(distances.begin(), distances.end(), [&](double d) { return d <= tolerance; }));
  }
};

class Refinement {
 public:
  Refinement(const TriangleMesh& mesh, const MeshSamples& coarse, const MeshSamples& fine, std::vector<SeenPoint> points)
      : samples_(coarse), nearest_(mesh, fine), points_(std::move(points)) {
    for (const Vector3d& v : mesh.vertices) box_.extend(v);
    std::array<std::vector<double>, 3> values;
    for (const SeenPoint& p : points_)
      for (int k = 0; k < 3; ++k) values[std::size_t(k)].push_back(p.point[k]);
    volume_ = 1;
    for (std::vector<double>& v : values) {  // of nine tenths of the cloud: single points may lie anywhere
      const double low = ranked(v, v.size() / 20), high = ranked(v, v.size() - 1 - v.size() / 20);
      volume_ *= high - low;
    }
  }
  const std::vector<SeenPoint>& points() const { return points_; }
  const Eigen::AlignedBox3d& box() const { return box_; }
  double sizeOf(const Similarity& s) const { return s.scale * box_.sizes().norm(); }

  /// @param points  that are used, evenly taken from all
  Solution refined(Similarity s, int rounds, std::size_t points) const {
    const std::vector<SeenPoint> used = evenly(points_, points);
    constexpr double kRounding = 1e-12;  // of the mesh's size: no point is nearer
    double scale = kFirstScale * s.scale * samples_.radius();
    Solution solution;
    for (int round = 0; round < rounds; ++round) {
      Matrix7 normal = Matrix7::Zero();
      Vector7 right = Vector7::Zero();
      std::vector<double> distances;
      if (equations(used, s, 3 * scale, scale, normal, right, &distances) <= 0) return {};
      const Vector7 step = stepOf(normal, right);
      if (!step.allFinite() || step.norm() > 1) return {};  // more than the mesh's own size: nothing holds it
      s = moved(s, step, s * samples_.mean(), s.scale * samples_.radius());
      const double next = std::max(kOn * sigmaOf(distances, 3 * scale), kRounding * sizeOf(s));
      if (std::abs(next - scale) < 0.02 * scale && step.norm() < kStill) break;
      scale = std::max(next, 0.6 * scale);  // gradually: another part of the points could hold it
    }
    solution.pointsFromMesh = s;
    const Similarity back = s.inverse();
    for (const SeenPoint& p : used) {
      const Vector3d q = back * p.point;
      const double least = box_.exteriorDistance(q);  // far points need no better
      solution.distances.push_back(s.scale * (s.scale * least < 3 * scale ? distanceOf(q) : least));
    }
    solution.sigma = sigmaOf(solution.distances, 3 * scale);
    solution.logLikelihood = likelihood(solution);
    return solution;
  }

  /// Normal equations of the distances that count; unknowns: turn, shift and growth about the middle of the mesh, in its radii.
  /// @return their sum of weights
  double equations(const std::vector<SeenPoint>& points, const Similarity& s, double reach, double scale, Matrix7& normal,
                   Vector7& right, std::vector<double>* distances = nullptr) const {
    const Vector3d middle = s * samples_.mean();
    const double radius = s.scale * samples_.radius();
    const Similarity back = s.inverse();
    double sum = 0;
    for (const SeenPoint& p : points) {
      const Vector3d q = back * p.point;
      if (const double least = s.scale * box_.exteriorDistance(q); !(least < reach)) {
        if (distances) distances->push_back(least);
        continue;
      }
      const NearestOnMesh::Foot foot = nearest_(q);
      const Vector3d f = s * foot.point, away = p.point - f;
      const double r = away.norm();
      Vector3d n = s.rotation * foot.normal;
      const bool beside = foot.isBeside(away, n);
      if (distances) distances->push_back(beside ? kElsewherePoint : r);
      if (!(r < reach) || beside) continue;
      if (std::abs(away.dot(n)) < kAlong * r) n = away / r;  // over an edge
      Vector7 row;
      row << (f - middle).cross(n) / radius, n, n.dot(f - middle) / radius;
      const double w = std::pow(scale * scale / (scale * scale + r * r), 2);  // Geman and McClure
      normal += w * row * row.transpose();
      right += w * row * (away.dot(n) / radius);
      sum += w;
    }
    return sum;
  }

 private:
  double distanceOf(const Vector3d& q) const {
    const NearestOnMesh::Foot foot = nearest_(q);
    return foot.isBeside(q - foot.point, foot.normal) ? kElsewherePoint : (q - foot.point).norm();
  }
  static Similarity moved(const Similarity& s, const Vector7& step, const Vector3d& middle, double radius) {
    const Vector3d turn = step.head<3>();
    const Eigen::Matrix3d r =
        turn.norm() > 0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() : Eigen::Matrix3d::Identity();
    const double growth = std::exp(step[6]);
    const Similarity about{growth, r, middle + radius * step.segment<3>(3) - growth * (r * middle)};
    Similarity result = about * s;
    result.rotation = Eigen::Quaterniond(result.rotation).normalized().toRotationMatrix();
    return result;
  }
  /// Directions in which the mesh slides along itself get no step.
  static Vector7 stepOf(const Matrix7& normal, const Vector7& right) {
    constexpr double kDamping = 1e-9;  // of the trace: below what matters, above rounding
    Matrix7 damped = normal;
    damped.diagonal().array() += kDamping * normal.trace();
    return damped.ldlt().solve(right);
  }
  static double sigmaOf(const std::vector<double>& distances, double reach) {
    std::vector<double> near;
    std::copy_if(distances.begin(), distances.end(), std::back_inserter(near), [reach](double d) { return d < reach; });
    return near.empty() ? 0 : kSigmaOfMedian * upperMedian(near);
  }
  /// Mean over the points of log(e on the mesh + (1 - e) anywhere), for the best share e.
  double likelihood(const Solution& s) const {
    const double area = s.pointsFromMesh.scale * s.pointsFromMesh.scale * samples_.area();
    const double sigma = std::max(s.sigma, kLeastScatter * sizeOf(s.pointsFromMesh));
    const double anywhere = 1 / std::max(volume_, 2 * kOn * sigma * area), on = 1 / (area * sigma * std::sqrt(2 * EIGEN_PI));
    double best = -std::numeric_limits<double>::max();
    for (double e = 0.05; e < 0.99; e += 0.05) {
      double sum = 0;
      for (const double d : s.distances) sum += std::log(e * on * std::exp(-d * d / (2 * sigma * sigma)) + (1 - e) * anywhere);
      best = std::max(best, sum / double(s.distances.size()));
    }
    return best;
  }

  const MeshSamples& samples_;
  NearestOnMesh nearest_;
  std::vector<SeenPoint> points_;
  Eigen::AlignedBox3d box_;
  double volume_ = 0;
};

std::array<Vector3d, 8> cornersOf(const Eigen::AlignedBox3d& box) {
  std::array<Vector3d, 8> corners;
  for (int k = 0; k < 8; ++k) corners[std::size_t(k)] = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
  return corners;
}

/// The largest motion of a corner of the mesh from one place to another.
double apart(const Similarity& a, const Similarity& b, const Eigen::AlignedBox3d& box) {
  double most = 0;
  for (const Vector3d& c : cornersOf(box)) most = std::max(most, (a * c - b * c).norm());
  return most;
}

/// Whether the mesh in both places is one surface: its points in one place lie on it in the other.
bool sameSurface(const Similarity& a, const Similarity& b, const NearestOnMesh& nearest, const MeshSamples& samples,
                 double tolerance) {
  const Similarity meshFromOther = a.inverse() * b;
  const std::size_t step = std::max<std::size_t>(1, samples.points().size() / 1000);
  for (std::size_t i = 0; i < samples.points().size(); i += step) {
    const Vector3d q = meshFromOther * samples.points()[i];
    if (a.scale * (nearest(q).point - q).norm() > tolerance) return false;
  }
  return true;
}

/// Points that the mesh hides from the camera that saw them, or from all that may have seen them.
std::size_t hiddenPoints(const TriangleMesh& mesh, const Refinement& r, const Solution& s, double tolerance) {
  const std::shared_ptr<const Surface> surface = makeMesh(mesh, MeshPolicy{NormalPolicy::Facet}, false);
  const Similarity back = s.pointsFromMesh.inverse();
  const auto hides = [&](const Vector3d& seen, const Vector3d& from) {
    const Vector3d eye = back * from, sight = back * seen - eye;
    if (!(sight.norm() > 0)) return false;
    const Outcome<SurfacePoint> hit = surface->firstHit({eye, sight.normalized()});
    // Twice: a point on a surface that is seen at a slant lies farther behind it than it is off.
    return hit && s.pointsFromMesh.scale * (sight.norm() - (hit->position - eye).norm()) > 2 * tolerance;
  };
  std::size_t hidden = 0;
  for (const SeenPoint& p : r.points())
    hidden += hides(p.point, p.eye) &&
              std::all_of(p.orEyes.begin(), p.orEyes.end(), [&](const Vector3d& eye) { return hides(p.point, eye); });
  return hidden;
}

double spacingOf(const std::vector<Vector3d>& points) {
  std::vector<double> nearest;
  const std::size_t step = std::max<std::size_t>(1, points.size() / 300);  // as many determine a median
  for (std::size_t i = 0; i < points.size(); i += step) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < points.size(); ++k)
      if (k != i) least = std::min(least, (points[k] - points[i]).squaredNorm());
    nearest.push_back(std::sqrt(least));
  }
  return upperMedian(nearest);
}

/// Standard deviation of the least certain corner of the mesh; nothing where the points let it slide.
std::optional<double> uncertaintyOf(const Refinement& r, const Solution& best, const MeshSamples& coarse, double tolerance,
                                    std::size_t explained) {
  Matrix7 normal = Matrix7::Zero();
  Vector7 right = Vector7::Zero();
  r.equations(r.points(), best.pointsFromMesh, tolerance, std::numeric_limits<double>::max() / 1e200, normal, right);
  const Eigen::SelfAdjointEigenSolver<Matrix7> modes(normal);
  if (modes.eigenvalues()[0] < kSlides * double(explained)) return std::nullopt;
  const Matrix7 covariance = std::pow(best.sigma / (best.pointsFromMesh.scale * coarse.radius()), 2) * normal.inverse();
  const Vector3d middle = best.pointsFromMesh * coarse.mean();
  const double radius = best.pointsFromMesh.scale * coarse.radius();
  double sigma = 0;
  for (const Vector3d& c : cornersOf(r.box())) {
    const Vector3d d = (best.pointsFromMesh * c - middle) / radius;
    Eigen::Matrix<double, 3, 7> by;
    by << 0, d.z(), -d.y(), 1, 0, 0, d.x(), -d.z(), 0, d.x(), 0, 1, 0, d.y(), d.y(), -d.x(), 0, 0, 0, 1, d.z();
    sigma = std::max(sigma, radius * std::sqrt((by * covariance * by.transpose()).trace()));
  }
  return sigma;
}

/// Points that the solutions explain which put the mesh elsewhere.
void compareOthers(const Refinement& r, const MeshSamples& coarse, const MeshSamples& fine, const TriangleMesh& mesh,
                   const std::vector<Solution>& solutions, Registration& result) {
  const NearestOnMesh nearest(mesh, fine);
  const Solution& best = solutions.front();
  for (std::size_t i = 1; i < solutions.size(); ++i) {
    const Solution& other = solutions[i];
    if (apart(best.pointsFromMesh, other.pointsFromMesh, r.box()) < kElsewhere * result.size) continue;
    const std::size_t explained = other.explained(result.tolerance);
    if (double(explained) >= kNearlyAsMany * double(result.explained) &&
        sameSurface(best.pointsFromMesh, other.pointsFromMesh, nearest, coarse, kSameSurface * result.size))
      ++result.alike;
    else
      result.second = std::max(result.second, explained);
  }
}

Outcome<Registration> judged(const TriangleMesh& mesh, const Refinement& r, const MeshSamples& coarse, const MeshSamples& fine,
                             const std::vector<Solution>& solutions) {
  constexpr double kRounded = 1e-9;  // of the mesh's size: points that were stored with 9 digits are off by as much
  const Solution& best = solutions.front();
  Registration result;
  result.pointsFromMesh = best.pointsFromMesh;
  result.points = r.points().size();
  result.size = r.sizeOf(best.pointsFromMesh);
  result.tolerance = kOn * std::max(best.sigma, kRounded * result.size);
  std::vector<Vector3d> on;
  double squares = 0;
  for (std::size_t i = 0; i < best.distances.size(); ++i)
    if (best.distances[i] <= result.tolerance) {
      on.push_back(r.points()[i].point);
      squares += best.distances[i] * best.distances[i];
    }
  result.explained = on.size();
  if (on.size() < kFewest)
    return Failure{Reason::TooFewPoints,
                   formatted("%zu of %zu sparse points could lie on the mesh, wherever it is put; %zu are needed", on.size(),
                             result.points, kFewest)};
  result.rms = std::sqrt(squares / double(on.size()));
  result.spacing = spacingOf(on);
  if (best.sigma > kWorstSigma * result.size || double(on.size()) < kLeastShare * double(result.points))
    return Failure{Reason::NotConverged,
                   formatted("the mesh explains %zu of %zu sparse points, which scatter about it by %.2g %% of its size",
                             on.size(), result.points, 100 * best.sigma / result.size)};
  result.hidden = hiddenPoints(mesh, r, best, std::max(result.tolerance, kLeastScatter * result.size));
  if (double(result.hidden) > kMostHidden * double(on.size()))
    return Failure{Reason::NotConverged,
                   formatted("the best place of the mesh explains %zu of %zu sparse points, but hides %zu from the "
                             "cameras that saw them",
                             on.size(), result.points, result.hidden)};
  const std::optional<double> sigma = uncertaintyOf(r, best, coarse, result.tolerance, on.size());
  if (!sigma)
    return Failure{
        Reason::RankDeficient,
        "ambiguous: the sparse points let the mesh slide or turn along itself (a ball, a body of revolution, a flat part?)"};
  result.sigma = *sigma;
  compareOthers(r, coarse, fine, mesh, solutions, result);
  if (double(result.second) >= kNearlyAsMany * double(on.size()))
    return Failure{Reason::RankDeficient,
                   formatted("ambiguous: the mesh explains %zu of %zu sparse points in one place and %zu in another", on.size(),
                             result.points, result.second)};
  if (result.sigma > kMostUncertain * result.size)
    return Failure{Reason::RankDeficient,
                   formatted("ambiguous: the sparse points leave a corner of the mesh uncertain by %.2g %% of its size",
                             100 * result.sigma / result.size)};
  return result;
}

/// Solutions, the best first; starts that end nowhere are left out.
std::vector<Solution> refinedAll(const Refinement& refinement, const std::vector<Similarity>& starts, int rounds,
                                 std::size_t points, const ProgressFn& progress) {
  std::vector<Solution> solutions(starts.size());
  parallelFor(
      static_cast<int>(starts.size()),
      [&](int i) { solutions[std::size_t(i)] = refinement.refined(starts[std::size_t(i)], rounds, points); }, progress,
      "mesh in the cameras' frame");
  std::erase_if(solutions, [](const Solution& s) { return s.distances.empty(); });
  std::stable_sort(solutions.begin(), solutions.end(),
                   [](const Solution& a, const Solution& b) { return a.logLikelihood > b.logLikelihood; });
  return solutions;
}

}  // namespace

std::string Registration::text() const {
  return formatted(
             "%zu of %zu sparse points lie on it, %.2g (rms) off, their spacing is %.2g and its size %.3g; elsewhere it explains "
             "at most %zu",
             explained, points, rms, spacing, size, second) +
         (alike > 0 ? "; the mesh is symmetric: turned onto itself it fits as well" : "");
}

Outcome<Registration> registerMesh(const TriangleMesh& mesh, const std::vector<SeenPoint>& points, const ProgressFn& progress) {
  if (points.size() < kFewest)
    return Failure{Reason::TooFewPoints, formatted("%zu sparse points; %zu are needed on the object", points.size(), kFewest)};
  const auto finite = [](const SeenPoint& p) {
    return p.point.allFinite() && p.eye.allFinite() &&
           std::all_of(p.orEyes.begin(), p.orEyes.end(), [](const Vector3d& eye) { return eye.allFinite(); });
  };
  if (!std::all_of(points.begin(), points.end(), finite)) return Failure{Reason::NotFinite, "a sparse point"};
  std::vector<SeenPoint> few = evenly(points, kMostPoints);
  const MeshSamples coarse(mesh, kCoarseSamples), fine(mesh, kFineSamples);
  const std::vector<Similarity> starts = registrationStarts(coarse, few, progress);
  const Refinement refinement(mesh, coarse, fine, std::move(few));
  std::vector<Solution> solutions = refinedAll(refinement, starts, kShortRounds, kShortPoints, progress);
  std::vector<Similarity> kept;
  for (const Solution& s : solutions) {
    const auto alike = [&](const Similarity& k) {
      return apart(s.pointsFromMesh, k, refinement.box()) < kElsewhere / 2 * refinement.sizeOf(k);
    };
    if (kept.size() < kMostLong && std::none_of(kept.begin(), kept.end(), alike)) kept.push_back(s.pointsFromMesh);
  }
  solutions = refinedAll(refinement, kept, kLongRounds, kMostPoints, progress);
  if (solutions.empty()) return Failure{Reason::NotConverged, "no place of the mesh explains the sparse points"};
  return judged(mesh, refinement, coarse, fine, solutions);
}

}  // namespace glint
