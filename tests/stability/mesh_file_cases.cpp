// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/base/number_text.h"
#include "core/scene/surface_source.h"
#include "core/surface/brightest_point.h"
#include "core/surface/mesh.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real_mesh.h"
#include "tests/stability/scene.h"

namespace glint::stability {
namespace {

using Whole = Eigen::Matrix<std::int64_t, 3, 1>;

constexpr int kSide = 13;                // vertices a side
constexpr std::int64_t kEdge = 100'000;  // between them
constexpr double kEdgeMetres = 0.1;

/// A bowl turned over, z = -k (x^2 + y^2) / 2, in whole micrometres, so that a file's decimals hold it at any offset without
/// error.
struct Bowl {
  std::vector<Whole> vertices, normals;  ///< normals: unit times 1e6 or so
  std::vector<Eigen::Vector3i> triangles;
  explicit Bowl(double curvature) {
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const std::int64_t x = (i - kSide / 2) * kEdge, y = (j - kSide / 2) * kEdge;
        vertices.emplace_back(x, y, std::llround(-0.5e-6 * curvature * double(x * x + y * y)));
        normals.emplace_back(std::llround(curvature * double(x)), std::llround(curvature * double(y)), 1'000'000);
      }
    for (int j = 0; j + 1 < kSide; ++j)
      for (int i = 0; i + 1 < kSide; ++i) {
        const int n = j * kSide + i;
        triangles.emplace_back(n, n + 1, n + kSide + 1);
        triangles.emplace_back(n, n + kSide + 1, n + kSide);
      }
  }
  /// The same mesh at the origin, in metres.
  RealMesh<Real> exact() const {
    RealMesh<Real> mesh;
    for (const Whole& v : vertices)
      mesh.vertices.push_back({Real(v.x()) / 1'000'000, Real(v.y()) / 1'000'000, Real(v.z()) / 1'000'000});
    for (const Whole& n : normals) mesh.normals.push_back({Real(n.x()), Real(n.y()), Real(n.z())});
    mesh.triangles = triangles;
    return mesh;
  }
};

/// "-12.000345" of -12'000'345.
std::string decimal(std::int64_t millionths) {
  const std::int64_t size = millionths < 0 ? -millionths : millionths;
  std::string digits = std::to_string(size % 1'000'000);
  digits.insert(0, 6 - digits.size(), '0');
  return (millionths < 0 ? "-" : "") + std::to_string(size / 1'000'000) + "." + digits;
}
double nearestDouble(const std::string& text) {
  double x = 0;
  std::from_chars(text.data(), text.data() + text.size(), x);
  return x;
}

enum class Format { PlyDoubles, PlyText, Obj };

/// The bytes of a file with the bowl at an offset of whole metres.
std::string fileOf(const Bowl& bowl, const Eigen::Vector3d& offset, Format format) {
  const Whole move = (1e6 * offset).cast<std::int64_t>();
  std::string out;
  if (format != Format::Obj) {
    out = std::string("ply\nformat ") + (format == Format::PlyText ? "ascii" : "binary_little_endian") + " 1.0\nelement vertex " +
          std::to_string(bowl.vertices.size()) + "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) out += std::string("property double ") + name + "\n";
    out += "element face " + std::to_string(bowl.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  }
  const auto put = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (std::size_t i = 0; i < bowl.vertices.size(); ++i) {
    std::string text[6];
    for (int k = 0; k < 3; ++k) {
      text[k] = decimal(bowl.vertices[i][k] + move[k]);
      text[3 + k] = decimal(bowl.normals[i][k]);
    }
    if (format == Format::PlyDoubles)
      for (const std::string& t : text) put(nearestDouble(t));  // little endian, as every machine this is built for
    else if (format == Format::PlyText)
      for (int k = 0; k < 6; ++k) out += text[k] + (k < 5 ? " " : "\n");
    else
      out += "v " + text[0] + " " + text[1] + " " + text[2] + "\nvn " + text[3] + " " + text[4] + " " + text[5] + "\n";
  }
  for (const Eigen::Vector3i& t : bowl.triangles) {
    if (format == Format::PlyDoubles) {
      put(std::uint8_t(3));
      for (const int v : t) put(std::int32_t(v));
    } else if (format == Format::PlyText) {
      out += "3 " + std::to_string(t.x()) + " " + std::to_string(t.y()) + " " + std::to_string(t.z()) + "\n";
    } else {
      out += "f";
      for (const int v : t) out += " " + std::to_string(v + 1) + "//" + std::to_string(v + 1);
      out += "\n";
    }
  }
  return out;
}

/// The surface that Glint makes of the file.
std::shared_ptr<const Surface> surfaceOf(const Bowl& bowl, const Eigen::Vector3d& offset, Format format, NormalPolicy policy) {
  return makeMesh(glint::meshOf(fileOf(bowl, offset, format), format == Format::Obj ? "case.obj" : "case.ply"), policy);
}

/// A place inside a triangle of the inner part of the bowl, another one for every i.
struct Place {
  int element;
  double b, c;
};
Place placeOf(int i) {
  const int cells = kSide - 1, column = 2 + (5 * i) % (cells - 4), row = 2 + (3 * i + i / 8) % (cells - 4);
  return {2 * (row * cells + column) + i % 2, 0.2 + 0.03 * (i % 7), 0.25 + 0.04 * (i % 5)};
}

struct FileScene {
  Eigen::Vector3d offset{0, 0, 0};
  Format format = Format::PlyDoubles;
  NormalPolicy policy = NormalPolicy::Interpolated;
  double curvature = 0.5, condition = 1;
};
/// A point of the world relative to the offset.
Vec<Real> local(const Vec<Real>& world, const Eigen::Vector3d& offset) { return world - exactly<Real>(offset); }

/// Rays at forty places: worst position over 1 m, and worst normal over what a shift of the vertices by that error turns it.
Outcome<Measured> hitCase(const FileScene& f) {
  const Bowl bowl(f.curvature);
  const RealMesh<Real> exact = bowl.exact();
  const auto surface = surfaceOf(bowl, f.offset, f.format, f.policy);
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    const Place place = placeOf(i);
    const Vec<Real> target = exact.at(f.policy, place.element, Real(place.b), Real(place.c)).point;
    const Eigen::Vector3d from = f.offset + Eigen::Vector3d(std::cos(0.7 * i), std::sin(0.7 * i), 0.4 + 0.02 * i);
    const Vec<Real> origin = local(exactly<Real>(from), f.offset);
    const Ray ray{from, rounded(target - origin).normalized()};
    const Outcome<SurfacePoint> hit = surface->firstHit(ray);
    if (!hit) return hit.failure();
    const auto reference =
        exact.hitNear(f.policy, place.element, Real(place.b), Real(place.c), origin, exactly<Real>(ray.direction));
    const double position = static_cast<double>(length(local(exactly<Real>(hit->position), f.offset) - reference.point));
    const double normal = apart(hit->normal, reference.normal);
    // A facet's normal turns by the error of its vertices over its edge.
    worst = worstOf({worst, position, f.policy == NormalPolicy::Facet ? normal * kEdgeMetres : normal});
  }
  return Measured{worst, f.condition};
}

/// Eight cameras on the reflected ray of a known place: the brightest point that is found nearest to it, over the distance of 1
/// m.
/// @param degrees  from the normal, of the light that is 2 m away
Outcome<Measured> mirrorCase(const FileScene& f, double degrees) {
  const Bowl bowl(f.curvature);
  const RealMesh<Real> exact = bowl.exact();
  const auto surface = surfaceOf(bowl, f.offset, f.format, f.policy);
  const double a = degrees * std::numbers::pi / 180;
  double worst = 0;
  for (int i = 0; i < 8; ++i) {
    const Place place = placeOf(i);
    const auto at = exact.at(f.policy, place.element, Real(place.b), Real(place.c));
    const Eigen::Vector3d n = rounded(at.normal),
                          t = n.cross(Eigen::Vector3d(std::cos(1.0 * i), std::sin(1.0 * i), 0.1)).normalized();
    const Eigen::Vector3d toLight = std::cos(a) * n + std::sin(a) * t, toEye = 2 * toLight.dot(n) * n - toLight;
    const Light light = Light::at(f.offset + rounded(at.point) + 2 * toLight);
    const Camera camera =
        cameraTowards(f.offset + rounded(at.point) + toEye, f.offset + rounded(at.point) + 0.02 * t.cross(n), 800);
    Lamp<Real> lamp = lampOf<Real>(light);
    lamp = {local(Real(1 / lamp.w) * lamp.l, f.offset), Real(1)};
    const auto reference = exact.mirrorNear(f.policy, place.element, Real(place.b), Real(place.c),
                                            local(RealCamera<Real>(camera).eye(), f.offset), lamp);
    const Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(*surface, camera, light);
    if (!found) return found.failure();
    double best = std::numeric_limits<double>::infinity();
    for (const BrightestPoint& p : *found)
      best = std::min(best, static_cast<double>(length(local(exactly<Real>(p.point.position), f.offset) - reference.point)));
    worst = worstOf({worst, best});
  }
  return Measured{worst, f.condition};
}

}  // namespace

void addMeshFileCases(Cases& cases) {
  struct Offset {
    const char* name;
    Eigen::Vector3d metres;
  };
  const Offset offsets[] = {{"UTM (5e5, 4e6, 300 m)", {5e5, 4e6, 300}}, {"1e6 m", {1e6, -1e6, 1e6}}, {"1e7 m", {1e7, -1e7, 1e7}}};
  const std::pair<const char*, Format> formats[] = {
      {"PLY of doubles", Format::PlyDoubles}, {"text PLY", Format::PlyText}, {"OBJ", Format::Obj}};
  const std::pair<const char*, NormalPolicy> policies[] = {
      {"facets", NormalPolicy::Facet}, {"interpolated", NormalPolicy::Interpolated}, {"curved", NormalPolicy::Curved}};
  // Offset and eye are doubles of that size: a few dozen roundings of an ulp each, and the pose multiplies three of them.
  const char* const note = "a double's own rounding at that offset; in metres, of a mesh of 1 m";
  for (const Offset& o : offsets) {
    const double size = o.metres.cwiseAbs().maxCoeff(), tolerance = std::max(1e-9, 64 * kRound * size);
    for (const auto& [format, f] : formats)
      for (const auto& [policy, p] : policies) {
        const FileScene scene{o.metres, f, p, 0.5, size};
        const std::string name = std::string(format) + " at " + o.name + ", " + policy;
        cases.push_back(answerCase("mesh file", name + ": hits and normals", size, tolerance, tolerance > 1e-9 ? note : "",
                                   [scene] { return hitCase(scene); }));
        // On facets of a curved mesh and on their edges the mirror point turns by the slope of one facet against the next: the
        // same places.
        cases.push_back(answerCase("mesh file", name + ": brightest point", size, tolerance, tolerance > 1e-9 ? note : "",
                                   [scene] { return mirrorCase(scene, 30); }));
      }
  }
  for (const double degrees : {80.0, 85.0, 89.0, 89.9, 89.99}) {
    const FileScene flat{
        .policy = NormalPolicy::Facet, .curvature = 0, .condition = 1 / std::cos(degrees * std::numbers::pi / 180)};
    const std::string name = formatted("flat mesh, grazing %g degrees", degrees);
    cases.push_back(
        answerCase("brightest point", name, degrees, 1e-9, "", [flat, degrees] { return mirrorCase(flat, degrees); }));
    if (degrees > 89.95) {
      cases.back().name = "flat mesh, 0.2 mm under the eye: 89.99 degrees";
      cases.back().note = "the mesh takes a pixel's height of the image, between the rays of the search";
      cases.back().expect = Expect::AnswerOrFailure;
      cases.back().reasons = {Reason::NoBrightestPoint};
    }
  }
}

}  // namespace glint::stability
