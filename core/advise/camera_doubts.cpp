// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/camera_doubts.h"

#include <algorithm>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/pipeline/evidence.h"

namespace glint {

int insideOfSurfaces(const std::vector<EyeAndSurface>& views) {
  int inside = 0;
  for (const auto& [eye, surface] : views) {
    bool closed = true;
    for (int k = 0; k < 27 && closed; ++k) {
      const Eigen::Vector3d way(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      closed = way.isZero() || surface->firstHit({eye, way.normalized()});
    }
    inside += closed;
  }
  return inside;
}

std::string noHighlightText(const Scene& scene, const std::vector<int>& searched, int dark, const Settings& settings) {
  if (dark < static_cast<int>(searched.size()))
    return formatted("%d of %zu frames that were looked at show no highlight", dark, searched.size());
  Settings fine = settings;
  constexpr double kLeastAreaPx2 = 3;  // smaller ones have no shape
  fine.set("detect.min_area", kLeastAreaPx2);
  std::vector<double> areas;
  for (const int frame : searched) {
    const FrameEvidence evidence = gatherEvidence(scene, frame, FrameSource::Radiance, fine);
    if (!evidence.highlights.empty()) areas.push_back(evidence.highlights.front().areaPx2);
  }
  if (2 * areas.size() > searched.size())
    return formatted(
        "the highlights are too small: %zu of %zu frames show one, of about %.2g px^2 (median), and detection "
        "takes them from %g px^2 on (--set detect.min_area=%.2g; photographs of more pixels are better)",
        areas.size(), searched.size(), upperMedian(areas), settings.number("detect.min_area"), kLeastAreaPx2);
  return formatted(
      "no highlight was found in any of %zu frames (are they the right photographs? Is the background brighter "
      "than the highlight, or the mask of another part?)",
      searched.size());
}

std::string nothingFitsText(const Unexplained& f, double meets) {
  std::string words = formatted("no light explains the highlights of %d frames", f.views);
  if (f.leftPx > 0)
    words += formatted("; the best light leaves %.2g px, %.0f %% of their radius", f.leftPx, 100 * f.leftPx / f.radiusPx);
  const std::string inside =
      f.inside > 0 ? formatted("; %d cameras are inside the surface (is it in another unit?)", f.inside) : std::string();
  if (f.missRad < meets)
    return words + formatted("; their positions fit: the mirrored rays miss one lamp by only %.2g degrees", degrees(f.missRad)) +
           inside +
           (f.inside > 0
                ? std::string()
                : ". Their shapes do not: no model covers this scene (print or wood under the highlight, bumps of a scanned "
                  "mesh, brushed metal, several lamps in one highlight)");
  const std::string miss =
      f.missRad < EIGEN_PI / 2 ? formatted("%.2g degrees", degrees(f.missRad)) : std::string("more than can be measured");
  return words +
         formatted(
             "; undoing one of %d likely mistakes does not help: mesh, poses and photographs do not belong together (the "
             "mirrored rays miss the best lamp by %s%s%s). Is it the mesh of another object, or is it shifted, deformed or "
             "bumpy? Are the poses those of other photographs? Does the lamp move?",
             f.mistakesTried, miss.c_str(),
             f.beside > 0 ? formatted("; in %d frames every highlight lies beside the surface", f.beside).c_str() : "",
             inside.c_str());
}

std::string fitsPoorlyText(std::size_t frames, double leftPx, double share) {
  return formatted(
      "one light explains the highlights of %zu frames poorly: %.2g px remain, %.0f %% of their radius, and undoing "
      "a likely mistake does not help. Is the mesh a little shifted, of another size or deformed? Do the lamp and the "
      "lobe have a shape that no model has?",
      frames, leftPx, 100 * share);
}

std::string outvotedText(const std::vector<Outvoted>& frames, int agreeing) {
  std::string names;
  for (const Outvoted& o : frames) {
    names += (names.empty() ? "" : ", ") + o.frame;
    names += o.missRad < EIGEN_PI / 2 ? formatted(" by %.2g degrees", degrees(o.missRad)) : " beside the surface";
  }
  return formatted("the highlights of %d frames share one lamp; those of %zu do not, and their mirrored rays miss it: frame ",
                   agreeing, frames.size()) +
         names + " (a pose or a photograph of another frame, or another lamp?)";
}

}  // namespace glint
