// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>

#include "core/base/number_text.h"
#include "core/scene/convention_report.h"
#include "core/surface/registration.h"

namespace glint {
namespace {

/// Frames with a vertex of a sample inside of their image.
int framesThatSee(const Scene& scene, const TriangleMesh& mesh) {
  constexpr std::size_t kSample = 1000;  // vertices: a mesh in view shows many of them
  const std::size_t step = std::max<std::size_t>(1, mesh.vertices.size() / kSample);
  int seeing = 0;
  for (const Frame& f : scene.frames) {
    bool sees = false;
    for (std::size_t i = 0; i < mesh.vertices.size() && !sees; i += step) {
      const std::optional<Pixel> ideal = f.camera.project(mesh.vertices[i]);
      const Pixel q = ideal ? f.camera.distorted(*ideal) : Pixel(-1, -1);
      sees = ideal && q.x() >= 0 && q.y() >= 0 && q.x() <= f.camera.width - 1 && q.y() <= f.camera.height - 1;
    }
    seeing += sees;
  }
  return seeing;
}

bool movesBox(const TriangleMesh& mesh, const Similarity& s) {
  constexpr double kFar = 0.03;  // of its size
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  double most = 0;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
    most = std::max(most, (s * corner - corner).norm());
  }
  return most > kFar * box.diagonal().norm();
}

/// Where a mesh that is not in the frame of its cameras belongs, by the sparse points of the capture.
struct MeshPlacement {
  std::string words;                     ///< for the finding: what was found, or why nothing was
  bool moves = false;                    ///< by more than noise of the points would
  std::optional<Correction> correction;  ///< moves the cameras to the mesh; nothing where the points do not determine it
};

/// @param mesh    the scene's only surface, in metres
/// @param points  that the cameras saw, in metres
/// A place where some camera that saw points would not see the mesh does not count. Stopped.
MeshPlacement placementOf(const Scene& scene, const TriangleMesh& mesh, const std::vector<SeenPoint>& points,
                          const ProgressFn& progress) {
  const Outcome<Registration> found = registerMesh(mesh, points, progress);
  if (!found)
    return {
        "the place of the mesh among the sparse points was not found: " + found.failure().message() +
            " (a scan of a small part of the object, or a shape that turns onto itself, has to be laid onto the points by hand, "
            "for example in MeshLab or CloudCompare)",
        false,
        {}};
  const Correction correction = meshSimilarityCorrection(found->pointsFromMesh);
  try {
    const Scene moved = corrected(scene, correction.fix);
    const int seeing = framesThatSee(moved, mesh), all = static_cast<int>(moved.frames.size());
    if (2 * seeing < all)  // cameras that look elsewhere do no harm, but most look at the object
      return {formatted("the sparse points put the mesh where %d of %d cameras see it", seeing, all), false, {}};
    return {formatted("moved to where the sparse points show it, the mesh is %.4g times as large and %d of %d cameras see it: ",
                      found->pointsFromMesh.scale, seeing, all) +
                found->text(),
            movesBox(mesh, found->pointsFromMesh), correction};
  } catch (const InputError& e) {  // depth maps or normals that would have to move, too
    return {std::string("the place of the mesh was found, but the scene cannot be moved to it: ") + e.what(), false, {}};
  }
}

bool startsWith(const ConventionReport::Proposal& p, const char* text) { return p.correction.fix.starts_with(text); }

}  // namespace

void placeMesh(const Scene& scene, const ProgressFn& progress, ConventionReport& report) {
  const auto ofUnit = [](const auto& p) { return startsWith(p, "mesh-") || startsWith(p, "poses-"); };
  if (!report.tracks || report.tracks->sample.empty() || scene.surfaces.size() != 1) return;
  if (std::any_of(report.corrections.begin(), report.corrections.end(), ofUnit)) return;  // the mistake is known then
  const auto& [id, source] = *scene.surfaces.begin();
  const TriangleMesh mesh = std::get_if<MeshFile>(&source) ? source.triangles().mesh : TriangleMesh{};
  if (mesh.triangles.empty()) return;
  TrackCheck& tracks = *report.tracks;
  MeshPlacement placement = placementOf(scene, mesh, tracks.sample, progress);
  if (tracks.findings.empty()) {  // too many points are on the surface to say that it is elsewhere
    if (!placement.correction || !placement.moves) return;
    tracks.findings.push_back(
        formatted("the surface passes through %d of the %d sparse points that it should", tracks.onSurface, tracks.met));
    report.add(tracks.findings.back());
  }
  const auto said = std::find(report.findings.begin(), report.findings.end(), tracks.findings.back());
  if (!placement.words.empty()) *said += "; " + placement.words;
  tracks.findings.back() = *said;
  if (!placement.correction) return;
  std::erase_if(report.corrections, [](const auto& p) { return startsWith(p, "invert-") || startsWith(p, "turn-"); });
  const std::size_t finding = std::size_t(said - report.findings.begin());
  const auto after =
      std::find_if(report.corrections.begin(), report.corrections.end(), [&](const auto& p) { return p.finding > finding; });
  report.corrections.insert(after, {finding, *placement.correction});
  tracks.correction = std::move(placement.correction);
}

}  // namespace glint
