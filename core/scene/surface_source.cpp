// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/surface_source.h"

#include <algorithm>
#include <utility>

#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/number_text.h"
#include "core/base/overload.h"
#include "core/base/words.h"
#include "core/geometry/camera_json.h"
#include "core/scene/input_choices.h"
#include "core/scene/scene_dom.h"
#include "core/scene/scene_reader.h"
#include "core/surface/added_shape.h"
#include "core/surface/mesh.h"
#include "core/surface/point_surface.h"
#include "io/cloud_reader.h"
#include "io/mesh_reader.h"

namespace glint {
namespace fs = std::filesystem;
using json_dom::Json;

namespace {

TriangleMesh meshOf(MeshContent content) {
  return {std::move(content.vertices), std::move(content.normals), std::move(content.triangles)};
}

void toMetres(std::vector<Eigen::Vector3d>& points, double metresPerUnit) {
  if (metresPerUnit != 1)
    for (Eigen::Vector3d& p : points) p *= metresPerUnit;
}

SurfaceTriangles surfaceOf(PointCloud cloud, double metresPerUnit) {
  toMetres(cloud.points, metresPerUnit);
  Outcome<PointSurface> made = surfaceOfPoints(cloud);
  if (!made) return {{std::move(cloud.points), {}, {}}, "", made.failure()};
  return {std::move(made->mesh), made->facts.text(), {}};
}

}  // namespace

TriangleMesh readMesh(const fs::path& file) { return meshOf(readMeshContent(file)); }
TriangleMesh meshOf(std::string_view bytes, const fs::path& file) { return meshOf(parseMesh(bytes, file)); }
bool isCloudFile(const fs::path& file) { return looksLikeCloud(firstBytes(file, kCloudHeader)); }

SurfaceTriangles MeshFile::triangles() const {
  MeshContent content = readMeshContent(file);
  SurfaceTriangles own{.mesh = {}, .leftOut = content.leftOut};
  own.mesh = meshOf(std::move(content));
  toMetres(own.mesh.vertices, metresPerUnit);
  return own;
}

SurfaceTriangles PointsFile::triangles() const {
  CloudContent content = readCloudContent(file);
  return surfaceOf({std::move(content.points), std::move(content.normals)}, metresPerUnit);
}

SurfaceTriangles CapturePoints::triangles() const { return surfaceOf(*points, metresPerUnit); }

const SurfaceFile* SurfaceSource::file() const {
  return std::visit(
      Overload{[](const SurfaceFile& f) { return &f; }, [](const AnalyticSpec&) -> const SurfaceFile* { return nullptr; }},
      *this);
}

SurfaceTriangles SurfaceSource::triangles() const {
  return std::visit(Overload{[](const AnalyticSpec&) {
                               return SurfaceTriangles{{}, "", Failure{Reason::NotSupported, "a formula has no triangles"}};
                             },
                             [](const auto& file) { return file.triangles(); }},
                    *this);
}

Outcome<std::shared_ptr<const Surface>> SurfaceSource::load(MeshPolicy policy, const Triangles& read) const {
  if (analytic()) return makeAnalytic(*analytic());
  SurfaceTriangles made = read(*this);
  if (made.failure) return *made.failure;
  try {
    return makeMesh(std::move(made.mesh), policy);
  } catch (const std::invalid_argument& e) {
    throw InputError(file()->file.string(), "", e.what());
  }
}

bool SurfaceSource::hasTrianglesOf(const SurfaceSource& other) const {
  const SurfaceFile *mine = file(), *theirs = other.file();
  if (index() != other.index() || !mine || mine->file != theirs->file || mine->metresPerUnit != theirs->metresPerUnit)
    return false;
  const auto* const points = std::get_if<CapturePoints>(this);
  return !points || points->points == std::get<CapturePoints>(other).points;
}

std::string SurfaceSource::kind() const {
  return std::visit(Overload{[](const AnalyticSpec& s) { return "analytic " + s.type; },
                             [](const auto& file) { return std::string(file.kKind); }},
                    *this);
}

namespace {
using glint::toJson;  // of vectors and matrices

double metresOf(const JsonNode& unit) {
  if (unit.isNumber()) return positive(unit, kLargestFactor);
  for (const double metres : {1.0, 0.01, 0.001})
    if (unit.text() == unitOfMetres(metres)) return metres;
  unit.fail("'" + unit.text() + "' is not one of: m, cm, mm, or a number of metres");
}

/// {"type": ..., sizes, "world_from_surface"} with every size checked for the type. @param known  receives the keys
AnalyticSpec readAnalyticJson(const JsonNode& node, std::set<std::string>& known) {
  const auto find = [&](const std::string& key) {
    known.insert(key);
    return node.find(key);
  };
  const auto at = [&](const char* key) {
    known.insert(key);
    return node.at(key);
  };
  const auto length = [&](const char* key) { return positive(at(key), kFarthest); };
  AnalyticSpec spec;
  const JsonNode type = at("type");
  spec.type = type.text();
  if (spec.type == "sphere" || spec.type == "cylinder") {
    spec.radius = length("radius");
  } else if (spec.type == "ellipsoid") {
    const JsonNode axes = at("semi_axes");
    spec.semiAxes = lengths3(axes);
    if (!(spec.semiAxes.minCoeff() > 0)) axes.fail("must be positive");
  } else if (spec.type == "sheet") {
    spec.curvature = bounded(at("curvature"), kLargestFactor);
    if (const auto n = find("length")) spec.length = positive(*n, kFarthest);
    if (const auto n = find("width")) spec.width = positive(*n, kFarthest);
  } else if (spec.type == "torus") {
    spec.majorRadius = length("major_radius");
    spec.minorRadius = length("minor_radius");
    if (spec.minorRadius >= spec.majorRadius) node.at("minor_radius").fail("must be smaller than major_radius");
  } else if (spec.type == "quadric") {
    const JsonNode matrix = at("matrix");
    for (std::size_t i = 0; i < matrix.size(); ++i) boundedAll(matrix.at(i), kLargestFactor);
    spec.matrix = matrix.matrix4();
    const double size = spec.matrix.cwiseAbs().maxCoeff();
    if (!(size > 0)) matrix.fail("must not be zero");
    constexpr double kTyped = 1e-9;  // relative: more digits than a printed matrix has wrong
    if ((spec.matrix - spec.matrix.transpose()).cwiseAbs().maxCoeff() > kTyped * size) matrix.fail("must be symmetric");
  } else if (const ShapeKind* const kind = addedShapeKind(spec.type)) {
    for (const ShapeNumber& n : kind->numbers()) {
      const auto given = find(n.name);
      if (!given && n.byDefault) {
        spec.numbers[n.name] = *n.byDefault;
        continue;
      }
      const JsonNode number = node.at(n.name);
      const double value = number.number();
      if (!(value >= n.least && value <= n.most)) number.fail(formatted("%g is outside %g .. %g", value, n.least, n.most));
      spec.numbers[n.name] = value;
    }
  } else if (spec.type != "plane") {
    type.fail("'" + spec.type + "' is not one of: " + knownShapes() + kPluginHint);
  }
  if (const auto pose = find("world_from_surface")) spec.worldFromSurface = readPoseJson(*pose);
  return spec;
}

Json toJson(const AnalyticSpec& spec) {
  Json j = {{"type", spec.type}};
  if (spec.type == "sphere" || spec.type == "cylinder") j["radius"] = spec.radius;
  if (spec.type == "ellipsoid") j["semi_axes"] = toJson(Eigen::VectorXd(spec.semiAxes));
  if (spec.type == "sheet") {
    j["curvature"] = spec.curvature;
    if (spec.length) j["length"] = *spec.length;
    if (spec.width) j["width"] = *spec.width;
  }
  if (spec.type == "torus") {
    j["major_radius"] = spec.majorRadius;
    j["minor_radius"] = spec.minorRadius;
  }
  if (spec.type == "quadric") j["matrix"] = toJson(spec.matrix);
  for (const auto& [name, value] : spec.numbers) j[name] = value;
  j["world_from_surface"] = toJson(spec.worldFromSurface.matrix());
  return j;
}

}  // namespace

ReadSurface readSurfaceJson(const JsonNode& node, const std::function<fs::path(const JsonNode&)>& find,
                            const std::vector<std::string>& keys) {
  std::map<std::string, std::set<std::string>> known{{"", {keys.begin(), keys.end()}}};
  const auto given = [&](const char* key) { return known[""].count(key) ? node.find(key) : std::nullopt; };
  const auto mesh = given("mesh"), points = given("points"), analytic = given("analytic"), unit = given("units");
  if (int(mesh.has_value()) + int(points.has_value()) + int(analytic.has_value()) != 1)
    node.fail("needs exactly one of mesh, " + std::string(known[""].count("points") ? "points, " : "") + "analytic");
  if (analytic) {
    const AnalyticSpec formula = readAnalyticJson(*analytic, known["analytic"]);
    return {formula, std::move(known)};
  }
  const JsonNode& named = mesh ? *mesh : *points;
  SurfaceFile file{find(named), named.text()};
  if (unit) file.metresPerUnit = metresOf(*unit);
  if (mesh) return {MeshFile{std::move(file)}, std::move(known)};
  return {PointsFile{std::move(file)}, std::move(known)};
}

Json toJson(const SurfaceSource& source, const std::string& place, const WrittenPath& written) {
  if (source.analytic()) return {{"analytic", toJson(*source.analytic())}};
  const SurfaceFile& f = *source.file();
  if (std::get_if<CapturePoints>(&source))
    throw InputError(
        f.file.string(), place,
        "is made of the sparse points of a capture, which a scene file cannot name; write them as a PLY cloud and name "
        "it by --surface FILE");
  Json j = {{source.kind(), written(f.file, place + "." + source.kind())}};
  const std::string unit = unitOfMetres(f.metresPerUnit);
  if (f.metresPerUnit != 1) j["units"] = unit == "cm" || unit == "mm" ? Json(unit) : Json(f.metresPerUnit);
  return j;
}

}  // namespace glint
