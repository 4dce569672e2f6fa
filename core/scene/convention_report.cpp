// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/convention_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/scene/correction.h"
#include "core/scene/geometry_check.h"
#include "core/scene/image_scale.h"
#include "core/scene/scene_reader.h"
#include "core/surface/analytic.h"

namespace glint {
namespace {

constexpr int kLeastDepthSamples = 20;  // vertices compared with a depth map: fewer may all lie on an edge

/// Part of an unbounded surface that the cameras may see: around the point nearest to their optical axes.
Eigen::AlignedBox3d regionOfInterest(const Scene& scene, const Eigen::AlignedBox3d& bounds) {
  if (bounds.min().allFinite() && bounds.max().allFinite() && !bounds.isEmpty()) return bounds;
  Eigen::AlignedBox3d cameras;
  for (const Frame& f : scene.frames) {
    const Eigen::Vector3d c = f.camera.centreInWorld();
    cameras.extend(c);
    // Twice the distance to the world's origin along the axis: scenes are built around it.
    cameras.extend(Eigen::Vector3d(c + 2 * c.norm() * f.camera.camFromWorld.linear().row(2).transpose()));
  }
  return cameras;
}

double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  return ranked(values, static_cast<std::size_t>(q * double(values.size() - 1)));
}

/// Depth at a pixel by bilinear interpolation; nothing at holes and at steps of more than 2 %.
std::optional<double> depthAt(const Image& depth, const Pixel& p) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
  if (x < 0 || y < 0 || x + 1 >= depth.width || y + 1 >= depth.height) return std::nullopt;
  const double a = depth.at(x, y), b = depth.at(x + 1, y), c = depth.at(x, y + 1), d = depth.at(x + 1, y + 1);
  const double lowest = std::min({a, b, c, d}), highest = std::max({a, b, c, d});
  if (!(lowest > 0) || highest > 1.02 * lowest) return std::nullopt;
  const double u = p.x() - x, v = p.y() - y;
  return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
}

/// Whether one of 17 x 17 pixels looks at a triangle: a large triangle fills the image while all its corners lie outside.
bool looksAtATriangle(const TriangleMesh& mesh, const Camera& camera) {
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i)
    for (int k = 0; k <= kSteps; ++k) {
      const Pixel measured((camera.width - 1) * double(i) / kSteps, (camera.height - 1) * double(k) / kSteps);
      const Ray ray = camera.ray(camera.undistorted(measured));
      for (const Eigen::Vector3i& t : mesh.triangles) {
        const Eigen::Vector3d a = mesh.vertices[std::size_t(t[0])] - ray.origin,
                              b = mesh.vertices[std::size_t(t[1])] - ray.origin,
                              c = mesh.vertices[std::size_t(t[2])] - ray.origin;
        // Signed volumes with two corners: of one sign when the ray's line passes inside; the sum weighs the distance.
        const double u = ray.direction.dot(b.cross(c)), v = ray.direction.dot(c.cross(a)), w = ray.direction.dot(a.cross(b));
        const bool inside = (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
        if (inside && (u * a + v * b + w * c).dot(ray.direction) / (u + v + w) > 0) return true;
      }
    }
  return false;
}

void compareVertices(const TriangleMesh& mesh, const Frame& frame, const std::optional<Image>& depth,
                     ConventionReport::FrameFacts& facts) {
  constexpr int kCellPx = 8;
  const Camera& camera = frame.camera;
  const int columns = camera.width / kCellPx + 1, rows = camera.height / kCellPx + 1;
  struct Nearest {
    double depth = std::numeric_limits<double>::infinity();
    Pixel pixel{0, 0};
  };
  // The nearest vertex of a cell is the visible one; the others may lie on the far side of the object.
  std::vector<Nearest> cells(static_cast<std::size_t>(columns) * rows);
  facts.vertices = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3d& v : mesh.vertices) {
    const std::optional<Pixel> ideal = camera.project(v);
    if (!ideal) continue;
    ++facts.verticesInFront;
    const Pixel p = camera.distorted(*ideal);
    if (!(p.x() >= -0.5 && p.y() >= -0.5 && p.x() < camera.width - 0.5 && p.y() < camera.height - 0.5)) continue;
    ++facts.verticesInImage;
    Nearest& cell =
        cells[static_cast<std::size_t>((p.y() + 0.5) / kCellPx) * columns + static_cast<std::size_t>((p.x() + 0.5) / kCellPx)];
    if (const double d = camera.depth(v); d < cell.depth) cell = {d, p};
  }
  facts.seesSurface = facts.verticesInImage > 0 || looksAtATriangle(mesh, camera);
  if (!depth) return;
  std::vector<double> differences, ratios;
  for (const Nearest& cell : cells)
    if (std::isfinite(cell.depth))
      if (const std::optional<double> d = depthAt(*depth, cell.pixel)) {
        differences.push_back(std::abs(*d - cell.depth));
        ratios.push_back(*d / cell.depth);
      }
  facts.depthSamples = static_cast<int>(differences.size());
  facts.depthMedian = quantile(differences, 0.5);
  facts.depthP95 = quantile(differences, 0.95);
  facts.depthRatio = quantile(ratios, 0.5);
  constexpr double kNear = 0.01;  // of the ratio: vertices and pixels of one place differ by less
  const auto agreeing = std::count_if(ratios.begin(), ratios.end(),
                                      [&](double r) { return std::abs(r - facts.depthRatio) < kNear * facts.depthRatio; });
  if (!ratios.empty()) facts.depthRatioShare = double(agreeing) / double(ratios.size());
}

void countPixels(const Frame& frame, ConventionReport::FrameFacts& facts) {
  if (frame.radiance.empty() && frame.image.empty()) return;
  facts.source = frame.radiance.empty() ? "image" : "radiance";
  const Outcome<Image> image = readLinear(frame, FrameSource::Radiance, &facts.linear);
  if (!image) {
    facts.problems.push_back(image.failure().detail);
  } else {
    facts.pixels = static_cast<long long>(image->width) * image->height;
    for (const float v : image->data) {
      if (!std::isfinite(v))
        ++facts.notFinite;
      else if (v < 0)
        ++facts.negative;
    }
  }
  if (!frame.radiance.empty() && !frame.image.empty())
    if (const Outcome<Image> photograph = readPhotograph(frame); !photograph)
      facts.problems.push_back(photograph.failure().detail);
}

/// Median over the triangles of their longest side.
double medianSide(const TriangleMesh& mesh) {
  constexpr std::size_t kSample = 20000;
  std::vector<double> sides;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += std::max<std::size_t>(1, mesh.triangles.size() / kSample)) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3i& t = mesh.triangles[i];
      longest = std::max(longest, (mesh.vertices[std::size_t(t[k])] - mesh.vertices[std::size_t(t[(k + 1) % 3])]).norm());
    }
    sides.push_back(longest);
  }
  return quantile(sides, 0.5);
}

/// Finds vertices that were rounded when they were stored, because they are far from the origin for their size: facets and
/// highlights are then off.
void concludeGrids(const Scene& scene, ConventionReport& report) {
  // Rounding turns facets by about spacing / side. A mesh of 20,480 triangles without normals of its own loses a tenth of a
  // percent of the highlight's diameter at 1/2000 of a side. A shift of a vertex by a hundredth of a pixel moves the contour as
  // much.
  constexpr double kOfSide = 5e-4, kOfPixel = 0.01;
  constexpr double kFar = 4;  // times its size from the origin; nearer, a shape's own round numbers look the same
  for (const auto& s : report.surfaces) {
    if (!s.grid || !(s.side > 0)) continue;
    const double distance = ((s.lower + s.upper) / 2).norm(), size = (s.upper - s.lower).norm();
    if (!(distance > kFar * size)) continue;
    double pixels = 0;  // largest over the cameras
    for (const auto& f : report.frames)
      if (f.surface == s.id && f.distance > 0)
        pixels = std::max(pixels, s.grid->spacing * scene.frames[std::size_t(f.frame)].camera.pixelFromRay(0, 0) / f.distance);
    if (s.grid->spacing < kOfSide * s.side && pixels < kOfPixel) continue;
    report.findings.push_back("the vertices of surface '" + s.id + "' are too coarse for their distance from the origin: at " +
                              formatted("%.4g m %s resolve steps of %.2g mm, %.2g %% of a triangle's side and %.2g px", distance,
                                        s.grid->singlePrecision ? "floats" : "the digits in the file", 1e3 * s.grid->spacing,
                                        100 * s.grid->spacing / s.side, pixels) +
                              " (store them as doubles, with more digits, or closer to the origin)");
  }
}

/// The metres per unit that somebody may have meant: measured ones are a few tenths of a percent off.
double nearestDepthScale(double metresPerUnit) {
  constexpr double kUsual[] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 2e-4, 5e-4};  // 2e-4: TUM RGB-D
  constexpr double kNear = 0.02;
  for (const double usual : kUsual)
    if (std::abs(metresPerUnit / usual - 1) < kNear) return usual;
  // A chosen factor has few digits; a measured one that is so near to such a number stands for it.
  constexpr double kAsNear = 5e-4;
  const double round = numberFrom(formatted("%.3g", metresPerUnit)).value_or(metresPerUnit);
  return std::abs(metresPerUnit / round - 1) < kAsNear ? round : metresPerUnit;
}

/// Finds depth maps that contradict the surface: by one factor for all, which is their scale, or otherwise.
void concludeDepth(const Scene& scene, int depthOff, double worstDepth, ConventionReport& report) {
  constexpr double kSame = 0.03;  // of the factor, from frame to frame: vertices and pixels differ by less than a percent
  constexpr double kMost = 0.5;   // of a frame's samples at that factor: where the scale alone is wrong, all that are visible
  std::vector<double> ratios;
  double scale = 0, share = 1;
  for (const auto& f : report.frames) {
    if (f.depthSamples <= kLeastDepthSamples) continue;
    ratios.push_back(f.depthRatio);
    share = std::min(share, f.depthRatioShare);
    scale = scene.frames[static_cast<std::size_t>(f.frame)].depthScale;
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  const double factor = quantile(ratios, 0.5);
  const std::string start = formatted("depth and surface disagree in %d of %zu frames", depthOff, report.frames.size());
  if (ratios.size() > 1 && share > kMost && *most - *least < kSame * factor && std::abs(factor - 1) > kSame)
    report.add(
        start + formatted(": depth maps say %.4g times the depth of the surface in every frame", factor) +
            (scale > 0 ? formatted(" (depth_scale should be %.4g in place of %.4g)", nearestDepthScale(scale / factor), scale)
                       : std::string(" (is the unit of one of them wrong?)")),
        scale > 0 ? std::optional(depthScaleCorrection(nearestDepthScale(scale / factor))) : std::nullopt);
  else
    report.findings.push_back(start +
                              formatted(" by up to %.3g m (distance along the ray instead of along the axis? a mesh that is "
                                        "not in the frame of the cameras?)",
                                        worstDepth));
}

/// Finds objects far from the origin: numbers have 16 digits, and few of them are left for the object.
void concludeDistance(ConventionReport& report) {
  constexpr double kCoarse = 1e-8;  // of the object's size: its normals are then uncertain by more than a fit leaves
  for (const auto& s : report.surfaces) {
    const double size = (s.upper - s.lower).norm();
    const double farthest = std::max(s.lower.cwiseAbs().maxCoeff(), s.upper.cwiseAbs().maxCoeff());
    const auto apartAt = [&](auto number) {
      return double(std::nextafter(number, std::numeric_limits<decltype(number)>::infinity()) - number);
    };
    const double apart = apartAt(farthest);
    if (!(size > 0) || apart <= kCoarse * size) continue;
    report.findings.push_back(
        formatted("surface '%s' of %.3g m lies %.3g m from the origin, where coordinates are %.2g m apart "
                  "(%.2g of its size; in 32-bit files %.2g m): move the origin of surface, cameras and "
                  "lamps to the object",
                  s.id.c_str(), size, farthest, apart, apart / size, apartAt(float(farthest))));
  }
}

/// Statements about the scene as a whole, each with the likely cause.
void conclude(const Scene& scene, const SightCheck& sight, ConventionReport& report) {
  int blind = 0, lookingAway = 0, withSurface = 0, bad = 0, depthOff = 0, notFinite = 0, negative = 0;
  std::string badId, notFiniteId, negativeId;
  double worstDepth = 0;
  for (const auto& f : report.frames) {
    if (f.vertices > 0) {
      ++withSurface;
      blind += !f.seesSurface;
      lookingAway += f.verticesInFront < f.vertices / 2;
    } else if (!f.seesSurface) {
      ++withSurface;
      ++blind;
    }
    const double limit = 0.01 * f.distance;
    if (f.depthSamples > kLeastDepthSamples && f.depthMedian > limit) {
      ++depthOff;
      worstDepth = std::max(worstDepth, f.depthMedian);
    }
    if (!f.problems.empty() && bad++ == 0) badId = f.problems.front();
    if (f.notFinite && notFinite++ == 0) notFiniteId = f.id;
    if (f.negative && negative++ == 0) negativeId = f.id;
  }
  const int n = static_cast<int>(report.frames.size());
  if (blind) {
    std::string line = formatted("%d of %d cameras do not see their surface", blind, n);
    std::optional<Correction> correction;
    if (const SightHypothesis* h = sight.explanation())
      correction = h->undoing, line += formatted("; %d do once one mistake is undone: ", h->seeing) + h->mistake;
    else if (2 * lookingAway > withSurface)
      line += ": they look away from it (camera axes must be x right, y down, z forward; OpenGL's point backwards)";
    else
      line += " (does the file contain the inverse of camera_from_world?)";
    report.add(line, correction);
  }
  if (depthOff) concludeDepth(scene, depthOff, worstDepth, report);
  if (bad)
    report.add(formatted("%d of %d frames have a file that cannot be used; first: ", bad, n) + badId,
               imageScaleCorrection(scene));
  if (const std::optional<Correction> scale = cameraScaleCorrection(scene)) {
    const Camera& camera = scene.frames.front().camera;
    const Pixel c = camera.pixelFromRay.topRightCorner<2, 1>();
    report.add(formatted("the principal point %g, %g is the middle of pictures of %.0f x %.0f pixels; these have %d x %d: were "
                         "they resized after the calibration?",
                         c.x(), c.y(), 2 * c.x() + 1, 2 * c.y() + 1, camera.width, camera.height),
               scale);
  }
  if (notFinite)
    report.findings.push_back(formatted("%d of %d frames contain NaN or infinite values; first: frame ", notFinite, n) +
                              notFiniteId);
  if (negative)
    report.findings.push_back(formatted("%d of %d frames contain negative values; first: frame ", negative, n) + negativeId);
  concludeDistance(report);
  if (scene.frames.size() == 1) report.findings.push_back("only one frame: nothing can be held out");
}

/// Triangles of the surfaces. Meshes of files are kept as long as the report takes. Those that stand for analytic surfaces are
/// quickly made again, so that a scene with thousands of them (a line of JSON each) does not take a GB.
class Triangles {
 public:
  Triangles(const Scene& scene, ConventionReport& report) : scene_(scene), report_(report) {}
  /// Valid until the next question.
  const TriangleMesh& of(const std::string& id) {
    const SurfaceSource& source = scene_.surfaces.at(id);
    std::map<std::string, TriangleMesh>& known = source.hasTriangles() ? read_ : made_;
    const auto found = known.find(id);
    if (found != known.end()) return found->second;
    if (source.hasTriangles()) return known[id] = read(id, source);
    if (known.size() >= kMostMade) known.clear();
    const std::shared_ptr<const Surface> surface = *source.load({});
    return known[id] = surface->tessellate(regionOfInterest(scene_, surface->bounds()), kSteps);
  }

 private:
  /// The points alone where no surface can be made: whether the cameras see them is worth knowing.
  TriangleMesh read(const std::string& id, const SurfaceSource& source) {
    SurfaceTriangles triangles = source.triangles();
    if (!triangles.of.empty()) report_.facts.push_back("surface '" + id + "' is made of points: " + triangles.of);
    if (triangles.leftOut > 0)
      report_.findings.push_back(formatted("%s lacks %zu of its %zu facets: a corner of each has no place",
                                           source.file()->file.string().c_str(), triangles.leftOut,
                                           triangles.mesh.triangles.size() + triangles.leftOut));
    if (triangles.failure)
      report_.findings.push_back("no surface can be made of the points of '" + id + "': " + triangles.failure->message());
    return std::move(triangles.mesh);
  }

  static constexpr int kSteps = 64;             // along each side: 4,225 vertices, 300 kB
  static constexpr std::size_t kMostMade = 64;  // 20 MB; scenes have a few surfaces, and frames of one follow each other
  const Scene& scene_;
  ConventionReport& report_;
  std::map<std::string, TriangleMesh> read_, made_;
};

ConventionReport::SurfaceFacts factsOfSurface(const std::string& id, const SurfaceSource& source, const TriangleMesh& mesh,
                                              ConventionReport& report) {
  ConventionReport::SurfaceFacts facts;
  facts.id = id;
  facts.kind = source.kind();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  if (!box.isEmpty()) {
    facts.lower = box.min();
    facts.upper = box.max();
  }
  facts.vertices = static_cast<int>(mesh.vertices.size());
  facts.triangles = static_cast<int>(mesh.triangles.size());
  if (std::get_if<MeshFile>(&source)) {
    facts.grid = coordinateGrid(mesh.vertices);
    facts.side = medianSide(mesh);
    if (const std::string sides = sidesOf(mesh); !sides.empty())
      report.add("the mesh of surface '" + id + "' has its sides reversed: " + sides +
                     " (Glint turns normals towards the camera; other programs may not)",
                 flipFacesCorrection());
  }
  facts.hasNormals = !source.hasTriangles() || !mesh.normals.empty();
  return facts;
}

ConventionReport::FrameFacts factsOfFrame(int index, const Frame& frame, Triangles& triangles, const ConventionReport& report) {
  ConventionReport::FrameFacts facts;
  facts.frame = index;
  facts.id = frame.id;
  facts.surface = frame.surface;
  const Outcome<std::optional<Image>> depth = readDepth(frame);
  if (!depth) facts.problems.push_back(depth.failure().detail);
  const std::optional<Image> usable = depth ? *depth : std::nullopt;
  if (!frame.surface.empty()) {
    for (const auto& s : report.surfaces)
      if (s.id == frame.surface) facts.distance = (frame.camera.centreInWorld() - (s.lower + s.upper) / 2).norm();
    compareVertices(triangles.of(frame.surface), frame, usable, facts);
  } else if (usable) {
    facts.seesSurface = std::any_of(usable->data.begin(), usable->data.end(), [](float v) { return v > 0; });
  }
  countPixels(frame, facts);
  if (const auto mask = readMask(frame); !mask) facts.problems.push_back(mask.failure().detail);
  if (const auto normals = readNormals(frame); !normals) facts.problems.push_back(normals.failure().detail);
  return facts;
}

/// Adds findings of one check; its correction belongs to the last of them.
void addAll(const std::vector<std::string>& findings, const std::optional<Correction>& correction, ConventionReport& report) {
  for (const std::string& f : findings) report.add(f, &f == &findings.back() ? correction : std::nullopt);
}

}  // namespace

bool ConventionReport::anyFrameSeesSurface() const {
  return std::any_of(frames.begin(), frames.end(), [](const FrameFacts& f) { return f.seesSurface; });
}

bool ConventionReport::everyFrameSeesSurface() const {
  return std::all_of(frames.begin(), frames.end(), [](const FrameFacts& f) { return f.seesSurface; });
}

void ConventionReport::add(std::string finding, std::optional<Correction> correction) {
  if (correction) corrections.push_back({findings.size(), std::move(*correction)});
  findings.push_back(std::move(finding));
}

std::string ConventionReport::cleanBill() const {
  return cameras && cameras->hypotheses.empty()
             ? "All cameras see their surface. The highlights were not held against it; nothing else was found."
             : "All cameras see their surface; no problems found.";
}

void ConventionReport::take(CameraCheck check) {
  addAll(check.findings, check.correction, *this);
  cameras = std::move(check);
}

ConventionReport conventionReport(const Scene& scene, const ProgressFn& progress) {
  ConventionReport report;
  report.name = scene.name;
  report.file = scene.file.string();
  report.recognisedAs = "scene";
  for (const auto& reader : sceneReaders())
    if (reader->name() == scene.kind) report.recognisedAs = reader->describe();
  if (scene.kind == "images") report.recognisedAs = "folder of images with poses";
  if (scene.kind == "video") report.recognisedAs = "video with poses";
  report.facts = scene.facts;
  report.warnings = scene.warnings;
  report.lights = static_cast<int>(scene.lights.size());
  Triangles triangles(scene, report);
  int done = 0;
  for (const auto& [id, source] : scene.surfaces) {
    if (!glint::report(progress, {"surface", done++, static_cast<int>(scene.surfaces.size())})) throw Stopped{};
    report.surfaces.push_back(factsOfSurface(id, source, triangles.of(id), report));
  }
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    if (!glint::report(progress, {"read", static_cast<int>(i), static_cast<int>(scene.frames.size())})) throw Stopped{};
    report.frames.push_back(factsOfFrame(static_cast<int>(i), scene.frames[i], triangles, report));
  }
  conclude(scene, checkSight(scene, [&](const std::string& id) -> const TriangleMesh& { return triangles.of(id); }), report);
  report.tracks = checkTracks(scene, progress);
  if (report.tracks) addAll(report.tracks->findings, report.tracks->correction, report);
  concludeGrids(scene, report);
  return report;
}

}  // namespace glint
