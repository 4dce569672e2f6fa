// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder: the parts of a page to hand out, as JSON text.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/draw/scene_scale.h"
#include "core/pipeline/inspection.h"
#include "core/surface/surface.h"

namespace glint::share {

/// Any text as a JSON string; bytes that are not UTF-8 become U+FFFD.
std::string quoted(const std::string& text);
/// "true" or "false".
inline const char* truth(bool value) { return value ? "true" : "false"; }

/// Rounds what is only drawn: to a millionth of the scene in the world, to a hundredth of a pixel in photographs.
class Rounding {
 public:
  /// @param size  of the scene, world units
  explicit Rounding(double size);
  std::string world(const Eigen::Vector3d& p) const;                   ///< "[x,y,z]"; "null" where it is not finite
  std::string world(const std::vector<Eigen::Vector3d>& chain) const;  ///< "[x,y,z,x,y,z]", points that are not finite left out
  std::string world(double length) const;                              ///< "null" where it is not finite
  static std::string pixels(const std::vector<Pixel>& line);           ///< "[x,y,x,y]", points that are not finite left out
 private:
  int decimals_;
};
/// All digits; "null" where it is not finite.
std::string exactly(double value);

/// At most `most` triangles that look alike: vertices within one cell of a grid become one, with the mean of their places and
/// normals. A mesh that is small enough stays as it is. Triangles of vertices that do not exist or are not finite are left out.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t most);
/// Positions in 16 bits an axis over the mesh's box, normals in 8 bits, indices in 32: base64, little-endian.
/// @param of  triangles before it was simplified
std::string packed(const TriangleMesh& mesh, std::size_t of);

/// The surfaces that these frames see, each once, with the index of each frame's; -1 = none.
struct SharedSurfaces {
  std::string json;          ///< an array
  std::vector<int> ofFrame;  ///< by place in `frames`
  Eigen::AlignedBox3d box;   ///< of all of them; empty without any
};
SharedSurfaces surfacesOf(const Inspection& inspection, const std::vector<int>& frames, const ProgressFn& progress);

/// The photographs as JPEG in a data URL, made smaller until all of them together stay within a page's share. "" without one.
std::vector<std::string> photographsOf(const Inspection& inspection, const std::vector<int>& frames, const ProgressFn& progress);

/// Cameras of the frames, what is drawn over their photographs, and what belongs to them in 3D: an array.
std::string framesJson(const Inspection& inspection, const std::vector<int>& frames, const SharedSurfaces& surfaces,
                       const draw::SceneScale& scale, const Rounding& rounding, const ProgressFn& progress);
/// What else is drawn in 3D: lights, lamps, ellipsoids.
std::string sceneThingsJson(const Inspection& inspection, const draw::SceneScale& scale, const Rounding& rounding);
std::string sizesJson(const draw::SceneScale& scale, const Rounding& rounding);
/// Title, what there is to see, steps with their texts and layers, questions with answers, the typeset equations of all these
/// (SVG), and the names of their symbols: "null" where there is no such lesson.
std::string lessonJson(const std::string& id);
/// `evaluationJson` without times.
std::string untimed(const std::string& evaluation);

/// Files of resources/share and resources/explain, and three.js, as they were when the program was built.
extern const std::string_view kSceneScript, kPageScript, kPageStyle, kPageBody, kThreeScript, kThreeLicence, kLessons, kSteps,
    kEquations;
/// SVG documents, one after the other.
extern const std::string_view kEquationPictures;

}  // namespace glint::share
