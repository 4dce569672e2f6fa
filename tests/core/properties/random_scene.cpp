// SPDX-License-Identifier: BSD-3-Clause
#include "tests/core/properties/random_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iomanip>
#include <numbers>
#include <random>
#include <stdexcept>

#include "core/geometry/conic.h"
#include "core/geometry/light.h"
#include "core/reflectance/lobe.h"
#include "core/surface/brightest_point.h"
#include "core/surface/mesh.h"

namespace glint::testing_support {
namespace {

using std::numbers::pi;
constexpr int kContourPoints = 72;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  double gauss(double sigma) { return std::normal_distribution<double>(0, sigma)(engine_); }
  Eigen::Vector3d direction() {
    Eigen::Vector3d d(gauss(1), gauss(1), gauss(1));
    return d.normalized();
  }

 private:
  std::mt19937_64 engine_;
};

/// A bumpy cap over a square, normals of its formula.
TriangleMesh cap(Random& random) {
  const double k1 = random.uniform(0.2, 0.8), k2 = random.uniform(0.1, 0.6), bump = random.uniform(0.001, 0.003),
               phase = random.uniform(0, 6);
  constexpr double kHalf = 0.9;
  constexpr int kCells = 48;
  TriangleMesh mesh;
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      const double x = kHalf * (2.0 * i / kCells - 1), y = kHalf * (2.0 * j / kCells - 1);
      mesh.vertices.emplace_back(x, y, -0.5 * (k1 * x * x + k2 * y * y) + bump * std::sin(4 * x + phase) * std::cos(3 * y));
      mesh.normals.push_back(Eigen::Vector3d(k1 * x - 4 * bump * std::cos(4 * x + phase) * std::cos(3 * y),
                                             k2 * y + 3 * bump * std::sin(4 * x + phase) * std::sin(3 * y), 1)
                                 .normalized());
    }
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const int a = i * (kCells + 1) + j, b = a + kCells + 1;
      mesh.triangles.emplace_back(a, b, b + 1);
      mesh.triangles.emplace_back(a, b + 1, a + 1);
    }
  return mesh;
}

std::filesystem::path writeMesh(const TriangleMesh& mesh, const std::filesystem::path& folder) {
  static int number = 0;
  const std::filesystem::path file = folder / ("mesh" + std::to_string(number++) + ".ply");
  std::ofstream out(file);
  out << std::setprecision(17) << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nproperty double nx\nproperty double ny\nproperty double "
         "nz\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    out << mesh.vertices[i].transpose() << " " << mesh.normals[i].transpose() << "\n";
  for (const Eigen::Vector3i& t : mesh.triangles) out << "3 " << t.transpose() << "\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
  return file;
}

AnalyticSpec analytic(Kind kind, Random& random) {
  AnalyticSpec spec;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(random.uniform(0, pi), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  switch (kind) {
    case Kind::Plane: spec.type = "plane"; break;
    case Kind::Sphere:
      spec.type = "sphere";
      spec.radius = random.uniform(0.8, 3);
      pose.translation().z() = -spec.radius;
      break;
    case Kind::Cylinder:
      spec.type = "cylinder";
      spec.radius = random.uniform(0.8, 3);
      pose.translation().z() = -spec.radius;
      break;
    default:
      spec.type = "ellipsoid";
      spec.semiAxes = Eigen::Vector3d(random.uniform(1, 2.5), random.uniform(1, 2.5), random.uniform(0.7, 1.2));
      pose.translation().z() = -spec.semiAxes.z();
  }
  pose.linear() = turned;
  spec.worldFromSurface = pose;
  return spec;
}

Camera cameraAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, Random& random) {
  Camera c;
  c.width = 641;
  c.height = 481;
  c.pixelFromRay(0, 0) = random.uniform(700, 900);
  c.pixelFromRay(1, 1) = c.pixelFromRay(0, 0) * random.uniform(0.99, 1.01);
  c.pixelFromRay(0, 2) = 320 + random.uniform(-10, 10);
  c.pixelFromRay(1, 2) = 240 + random.uniform(-10, 10);
  const Eigen::Vector3d z = (target - eye).normalized(), x = z.cross(Eigen::Vector3d::UnitY()).normalized();
  Eigen::Matrix3d r;
  r.row(0) = x;
  r.row(1) = z.cross(x);
  r.row(2) = z;
  c.camFromWorld.linear() = Eigen::AngleAxisd(random.uniform(-pi, pi), Eigen::Vector3d::UnitZ()).toRotationMatrix() * r;
  c.camFromWorld.translation() = -c.camFromWorld.linear() * eye;
  return c;
}

using Field = std::function<std::optional<double>(const Pixel&)>;

/// The level set `level` of a field that rises away from `centre`, at 72 points of equal chords. Nothing if it is no star or
/// leaves the image.
std::optional<std::vector<Pixel>> contourOf(const Field& field, const Pixel& centre, double level, const Camera& camera) {
  const auto at = [&](double angle) -> std::optional<Pixel> {
    const Pixel direction(std::cos(angle), std::sin(angle));
    double low = 0, high = 2;
    const auto above = [&](double r) {
      const std::optional<double> v = field(centre + r * direction);
      return v ? std::optional<bool>(*v > level) : std::nullopt;
    };
    for (;; high *= 1.3) {
      const std::optional<bool> out = above(high);
      if (!out || high > 400) return std::nullopt;
      if (*out) break;
      low = high;
    }
    for (int i = 0; i < 100 && high - low > 1e-13 * high; ++i) {
      const double middle = 0.5 * (low + high);
      const std::optional<bool> out = above(middle);
      if (!out) return std::nullopt;
      (*out ? high : low) = middle;
    }
    const Pixel p = centre + high * direction;
    if (!(p.minCoeff() > 5 && p.x() < camera.width - 6 && p.y() < camera.height - 6)) return std::nullopt;
    return p;
  };
  std::vector<double> angles(kContourPoints);
  for (int i = 0; i < kContourPoints; ++i) angles[i] = 2 * pi * i / kContourPoints;
  std::vector<Pixel> points(kContourPoints);
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < kContourPoints; ++i) {
      const std::optional<Pixel> p = at(angles[i]);
      if (!p) return std::nullopt;
      points[i] = *p;
    }
    // Angles at equal shares of the chords' sum, linear between the vertices: a fixed point has equal chords.
    std::vector<double> along(kContourPoints + 1, 0);
    for (int i = 0; i < kContourPoints; ++i) along[i + 1] = along[i] + (points[(i + 1) % kContourPoints] - points[i]).norm();
    double worst = 0;
    std::vector<double> next(kContourPoints, 0);
    int k = 0;
    for (int i = 1; i < kContourPoints; ++i) {
      const double wanted = along.back() * i / kContourPoints;
      while (along[k + 1] < wanted) ++k;
      const double a = angles[k], b = k + 1 < kContourPoints ? angles[k + 1] : 2 * pi;
      next[i] = a + (b - a) * (wanted - along[k]) / (along[k + 1] - along[k]);
      worst = std::max(worst, std::abs(next[i] - angles[i]));
    }
    if (worst < 1e-13) break;
    angles = next;
  }
  return points;
}

Highlight highlightFrom(std::vector<Pixel> contour, const Pixel& peak, const std::string& light) {
  Highlight h;
  h.light = light;
  h.level = 0.5;
  h.fromScene = true;
  h.contour = {std::move(contour), true};
  h.peak = peak;
  h.areaPx2 = std::abs(signedArea(h.contour));
  const Outcome<Ellipse> e = fitEllipse(h.contour.points);
  if (e) h.ellipse = *e;
  return h;
}

struct Lamp {
  std::string id;
  Eigen::Vector3d at;
};

/// One light's highlight in one view, nothing if it is not whole.
std::optional<Highlight> highlightOf(const Surface& surface, const Camera& camera, const Lamp& lamp, const Draw& what,
                                     double width, Random& random) {
  const Light light = Light::at(lamp.at);
  const Outcome<std::vector<BrightestPoint>> mirror = predictedBrightestPoints(surface, camera, light);
  if (!mirror || mirror->size() != 1) return std::nullopt;
  const auto seen = [&](const Pixel& p) -> std::optional<SurfacePoint> {
    const Ray ray = camera.ray(p);
    const Outcome<SurfacePoint> hit = surface.firstHit(ray);
    if (!hit) return std::nullopt;
    return facing(*hit, ray.origin);
  };
  const Eigen::Vector3d eye = camera.centreInWorld();
  const Field angle = [&](const Pixel& p) -> std::optional<double> {
    const std::optional<SurfacePoint> s = seen(p);
    if (!s) return std::nullopt;
    return incidentAngle(s->normal, light.directionFrom(s->position), (eye - s->position).normalized());
  };
  const Field darkness = [&](const Pixel& p) -> std::optional<double> {
    const std::optional<SurfacePoint> s = seen(p);
    if (!s) return std::nullopt;
    const std::optional<LogRadiance> r =
        logRadiance(Lobe::TorranceSparrow, width, s->normal, light.directionFrom(s->position), (eye - s->position).normalized());
    if (!r) return std::nullopt;
    return 2 * std::log((lamp.at - s->position).norm()) - r->total();
  };
  Pixel peak = mirror->front().pixel;
  std::optional<std::vector<Pixel>> contour;
  if (what.radiance) {
    // The brightest pixel, by a parabola through values one pixel apart, twice: what detection does, to 1e-3 px. All laws move it
    // along.
    for (int round = 0; round < 3; ++round) {
      const auto f = [&](double x, double y) { return darkness(peak + Pixel(x, y)); };
      const auto c = f(0, 0), l = f(-1, 0), r = f(1, 0), u = f(0, -1), d = f(0, 1);
      if (!c || !l || !r || !u || !d) return std::nullopt;
      peak += Pixel(0.5 * (*l - *r) / (*l - 2 * *c + *r), 0.5 * (*u - *d) / (*u - 2 * *c + *d));
    }
    const std::optional<double> least = darkness(peak);
    if (!least) return std::nullopt;
    contour = contourOf(darkness, peak, *least + std::log(2), camera);
  } else {
    contour = contourOf(angle, peak, width, camera);
  }
  if (!contour) return std::nullopt;
  if (what.noisy) {
    for (Pixel& p : *contour) p += Pixel(random.gauss(kNoisePx), random.gauss(kNoisePx));
    peak += Pixel(random.gauss(kNoisePx), random.gauss(kNoisePx));
  }
  return highlightFrom(std::move(*contour), peak, lamp.id);
}

/// Applies `change` to every pixel of all highlights.
template <class Change>
void changePixels(Frame& frame, const Change& change, bool reverse) {
  for (Highlight& h : frame.highlights) {
    std::vector<Pixel> points = h.contour.points;
    for (Pixel& p : points) p = change(p);
    if (reverse) std::reverse(points.begin() + 1, points.end());
    h = highlightFrom(std::move(points), change(h.peak), h.light);
  }
}

}  // namespace

const char* nameOf(Kind kind) {
  constexpr const char* kNames[] = {"plane", "sphere", "cylinder", "ellipsoid", "mesh"};
  return kNames[static_cast<int>(kind)];
}

std::string Draw::text() const {
  return std::string(nameOf(kind)) + ", " + (lights == 1 ? "one light" : "two lights") + ", " + (noisy ? "noisy" : "exact") +
         " contours of " + (radiance ? "radiance" : "the incident angle") + ", seed " + std::to_string(seed);
}

Draw draw(int n, unsigned seed) {
  const int kind = n % kKinds, round = n / kKinds;
  return {static_cast<Kind>(kind), 1 + round % 2, (kind + round + round / 2) % 2 == 1, (kind + round / 2 + round / 4) % 2 == 1,
          seed + static_cast<unsigned>(n)};
}

RandomScene randomScene(const Draw& what, const std::filesystem::path& folder) {
  Random random(what.seed);
  // A draw whose highlights are not whole is drawn again from the same stream.
  for (int attempt = 0; attempt < 200; ++attempt) {
    auto scene = std::make_shared<Scene>();
    scene->name = what.text();
    scene->file = folder / "scene.json";  // never read: names the folder
    scene->folder = folder;
    std::shared_ptr<const Surface> surface;
    if (what.kind == Kind::Mesh) {
      const TriangleMesh mesh = cap(random);
      surface = makeMesh(mesh, MeshPolicy{});
      scene->surfaces["body"] = MeshFile{{writeMesh(mesh, folder)}};
    } else {
      scene->surfaces["body"] = analytic(what.kind, random);
      surface = makeAnalytic(*scene->surfaces["body"].analytic());
    }
    std::vector<Lamp> lamps;
    for (int i = 0; i < what.lights; ++i)
      lamps.push_back({i == 0 ? "left" : "right",
                       {(i == 0 ? -1 : 1) * random.uniform(0.15, 0.35), random.uniform(-0.2, 0.2), random.uniform(1.2, 1.7)}});
    const double width = what.radiance ? random.uniform(0.05, 0.08) : random.uniform(0.04, 0.06);
    bool whole = true;
    for (int i = 0; i < kTraining + kHeldOut && whole; ++i) {
      Frame f;
      f.id = "v" + std::to_string(i);
      f.surface = "body";
      for (int tries = 0; tries < 20; ++tries) {
        f.highlights.clear();
        const double a = 2 * pi * (i + random.uniform(0, 0.6)) / (kTraining + kHeldOut), r = random.uniform(0.3, 0.6);
        f.camera = cameraAt({r * std::cos(a), r * std::sin(a), random.uniform(1.3, 1.8)}, {0, 0, 0}, random);
        for (const Lamp& lamp : lamps)
          if (std::optional<Highlight> h = highlightOf(*surface, f.camera, lamp, what, width, random)) f.highlights.push_back(*h);
        if (static_cast<int>(f.highlights.size()) == what.lights) break;
      }
      whole = static_cast<int>(f.highlights.size()) == what.lights;
      for (const Lamp& lamp : lamps) f.lightsOn.push_back(lamp.id);
      scene->frames.push_back(std::move(f));
    }
    if (!whole) continue;
    RandomScene result{what, scene, {}, 1};
    for (int i = 0; i < kTraining; ++i) result.training.push_back(scene->frames[static_cast<std::size_t>(i)].id);
    return result;
  }
  throw std::runtime_error("no such scene: " + what.text());
}

namespace {
/// A linear map of the world, which scales lengths by `scale`: of mesh files and poses of analytic surfaces.
void mapSurfaces(Scene& scene, const Eigen::Affine3d& map, double scale, const std::filesystem::path& folder) {
  const bool mirror = map.linear().determinant() < 0;
  for (auto& [id, source] : scene.surfaces) {
    if (source.file()) {
      TriangleMesh mesh = readMesh(source.file()->file);
      for (Eigen::Vector3d& v : mesh.vertices) v = map * v;
      for (Eigen::Vector3d& n : mesh.normals) n = (map.linear() * n).normalized();
      if (mirror)
        for (Eigen::Vector3i& t : mesh.triangles) std::swap(t.y(), t.z());
      source = MeshFile{{writeMesh(mesh, folder)}};
      continue;
    }
    AnalyticSpec& spec = *source.analytic();
    spec.radius *= scale;
    spec.semiAxes *= scale;
    Eigen::Isometry3d pose;
    pose.linear() = map.linear() * spec.worldFromSurface.linear() / scale;
    // These kinds are their own mirror images in the plane x = 0 of their own frame, so that a mirrored pose can be written as a
    // rigid one.
    if (mirror) pose.linear().col(0) *= -1;
    pose.translation() = map * spec.worldFromSurface.translation();
    spec.worldFromSurface = pose;
  }
}
}  // namespace

RandomScene moved(const RandomScene& s, const Eigen::Isometry3d& motion, double scale, const std::filesystem::path& folder) {
  auto scene = std::make_shared<Scene>(*s.scene);
  mapSurfaces(*scene, Eigen::Scaling(scale) * Eigen::Affine3d(motion), scale, folder);
  for (Frame& f : scene->frames) {
    f.camera.camFromWorld = f.camera.camFromWorld * motion.inverse();
    f.camera.camFromWorld.translation() *= scale;
  }
  return {s.what, scene, s.training, s.size * scale};
}

RandomScene mirrored(const RandomScene& s, const std::filesystem::path& folder) {
  auto scene = std::make_shared<Scene>(*s.scene);
  const Eigen::Vector3d flip(-1, 1, 1);
  mapSurfaces(*scene, Eigen::Affine3d(Eigen::Scaling(flip)), 1, folder);
  for (Frame& f : scene->frames) {
    Camera& c = f.camera;
    const Eigen::Matrix3d r = flip.asDiagonal() * c.camFromWorld.linear() * flip.asDiagonal();
    c.camFromWorld.linear() = r;
    c.camFromWorld.translation().x() *= -1;
    c.pixelFromRay(0, 1) *= -1;
    c.pixelFromRay(0, 2) = c.width - 1 - c.pixelFromRay(0, 2);
    changePixels(
        f, [&](const Pixel& p) { return Pixel(c.width - 1 - p.x(), p.y()); }, true);
  }
  return {s.what, scene, s.training, s.size};
}

RandomScene zoomed(const RandomScene& s, int zoom) {
  auto scene = std::make_shared<Scene>(*s.scene);
  for (Frame& f : scene->frames) {
    f.camera.width *= zoom;
    f.camera.height *= zoom;
    f.camera.pixelFromRay.topRows<2>() *= zoom;
    f.camera.pixelFromRay.topRightCorner<2, 1>().array() += 0.5 * (zoom - 1);
    changePixels(
        f, [&](const Pixel& p) -> Pixel { return zoom * p + Pixel::Constant(0.5 * (zoom - 1)); }, false);
  }
  return {s.what, scene, s.training, s.size};
}

RandomScene reordered(const RandomScene& s, const std::vector<int>& order) {
  auto scene = std::make_shared<Scene>(*s.scene);
  scene->frames.clear();
  for (const int i : order) scene->frames.push_back(s.scene->frames[static_cast<std::size_t>(i)]);
  return {s.what, scene, s.training, s.size};
}

RandomScene repeated(const RandomScene& s, const std::vector<int>& frames, bool turned) {
  auto scene = std::make_shared<Scene>(*s.scene);
  RandomScene result{s.what, scene, s.training, s.size};
  for (const int i : frames) {
    Frame again = s.scene->frames[static_cast<std::size_t>(i)];
    if (std::find(s.training.begin(), s.training.end(), again.id) != s.training.end())
      result.training.push_back(again.id + " again");
    again.id += " again";
    if (turned)
      for (Highlight& h : again.highlights)
        std::rotate(h.contour.points.begin(), h.contour.points.begin() + kContourPoints / 3, h.contour.points.end());
    scene->frames.push_back(std::move(again));
  }
  return result;
}

}  // namespace glint::testing_support
