// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/highlight/highlight.h"
#include "core/scene/scene.h"
#include "core/synth/light_source.h"

namespace glint {

/// A camera moved by hand, in its own axes (x right, y down, z forward).
struct PoseChange {
  Eigen::Vector3d rotation{0, 0, 0};     ///< rad, about an axis through the camera's centre (rotation vector)
  Eigen::Vector3d translation{0, 0, 0};  ///< m, of the centre
  friend bool operator==(const PoseChange&, const PoseChange&) = default;
};

/// A highlight moved by hand, ideal pixels. The contour is scaled about its centroid, then moved; the peak moves alone.
struct HighlightChange {
  Pixel contourBy{0, 0};
  double contourScale = 1;
  Pixel peakBy{0, 0};
  friend bool operator==(const HighlightChange&, const HighlightChange&) = default;
};

/// One change by hand to which highlights a frame shows. A place inside of its contour names a highlight, so that a change
/// outlives other settings of detection; without a highlight there it changes nothing. core/pipeline/hand_edits.h makes them.
struct HighlightEdit {
  enum class Kind {
    Ignore,  ///< places[0]: neither trains nor is scored
    Merge,   ///< places[0], places[1]: one highlight, its contour their convex hull
    Split,   ///< places[0]: cut along the line through places[1] and places[2]
    Seed     ///< places[0]: grown from that pixel; takes the place of highlights whose peaks it holds
  };
  Kind kind = Kind::Ignore;
  int frame = 0;
  std::vector<Pixel> places;  ///< ideal pixels
  std::string light{};        ///< of a seed
  friend bool operator==(const HighlightEdit&, const HighlightEdit&) = default;
};
const char* nameOf(HighlightEdit::Kind kind);    ///< "ignore", "merge", "split", "seed"
const char* pastOf(HighlightEdit::Kind kind);    ///< "ignored", "merged", "split", "grown"
std::size_t placesOf(HighlightEdit::Kind kind);  ///< how many it has

/// What the user tries out on a scene: changes that no file knows of. Plain data, kept by sessions; equal values give equal
/// results. Everything on its default = the scene as it was captured.
struct WhatIf {
  std::map<int, PoseChange> poses;  ///< by frame
  /// By frame and index in its evidence, as found; no effect without that evidence.
  std::map<std::pair<int, int>, HighlightChange> highlights;
  std::vector<HighlightEdit> edits;  ///< in the order in which they were made; before `highlights`, which may move what they made
  /// By frame and light id: on or off, whatever was captured. What is off makes no highlight there: none trains, none is
  /// predicted, none is scored. On counts where contours are synthesised; no photograph shows a light that was off.
  std::map<std::pair<int, std::string>, bool> lightsSwitched;

  /// Observed contours are synthesised from the scene's true lights and analytic surfaces instead of being detected; then light,
  /// surface and material below count, and a moved camera takes its contours with it.
  bool synthesise = false;
  /// By id of a true light: shift of its position, m (of its unit direction, for one at infinity).
  std::map<std::string, Eigen::Vector3d> lightsBy;
  std::map<std::string, double> surfaces;  ///< by surface id: the value of its shape parameter, see `shapeOf`
  Lobe lobe = Lobe::TorranceSparrow;
  double roughness = 0.1;  ///< m of the lobe, > 0

  friend bool operator==(const WhatIf&, const WhatIf&) = default;
  bool none() const { return *this == WhatIf{}; }
  /// The scene itself changes, not its evidence alone.
  bool changesScene() const { return synthesise || !poses.empty(); }
};

/// The one number that a what-if changes about an analytic surface.
struct ShapeParameter {
  std::string name;         ///< "curvature"
  std::string unit;         ///< "1/m"; "" for a factor
  double value = 0;         ///< as the scene has it
  double min = 0, max = 0;  ///< sensible bounds around it
};
/// curvature of a sheet, radius of a sphere or cylinder, a factor of an ellipsoid's longest semi-axis, the minor radius of a
/// torus; nothing for planes and quadrics.
std::optional<ShapeParameter> shapeOf(const AnalyticSpec& spec);
AnalyticSpec withShape(AnalyticSpec spec, double value);

/// Whether the contours of a scene can be synthesised: it states its lights, and every frame sees an analytic surface.
/// NotSupported, with the first reason against it.
std::optional<Failure> whyNotSynthesised(const Scene& scene);

/// Whether a light may show in a frame: as the frame says (it may, where it names none), or as it was switched.
bool isOn(const Scene& scene, const WhatIf& whatIf, int frame, const std::string& light);
/// It was on, or nothing says that it was not, and the what-if switched it off.
bool isSwitchedOff(const WhatIf& whatIf, int frame, const std::string& light);
/// The same what-if with nothing switched off: what contours and the exposure are made from, so that switching off changes
/// neither.
WhatIf withoutSwitchingOff(WhatIf whatIf);
/// The what-if with that light on or off in that frame; what agrees with the capture is no change.
WhatIf switched(WhatIf whatIf, const Scene& scene, int frame, const std::string& light, bool on);

/// The true lights that shine on a frame.
std::vector<TrueLight> lightsOn(const Scene& scene, const WhatIf& whatIf, int frame);

/// Distance from which sensible shifts of lights and cameras are derived: the mean distance from the cameras to the point that
/// they look at together (least squares over the optical axes), m; 1 without such a point.
double workingDistance(const Scene& scene);

/// The scene with the changes to poses, and, where contours are synthesised, to lights, surfaces and evidence: `highlights` of
/// every frame are the contours at `level` of the exact radiance (core/synth). A frame without any keeps none, and is then named
/// so by the pipeline.
/// @throw InputError (place "what-if") for a frame, light or surface that does not exist, a value out of range, or a scene whose
/// contours cannot be synthesised; Stopped.
/// @param frames  indices of those whose contours are synthesised (the others have none yet); null = all
std::shared_ptr<const Scene> changedScene(const Scene& scene, const WhatIf& whatIf, double level, const ProgressFn& progress = {},
                                          const std::vector<int>* frames = nullptr);
/// A scene that changedScene() made for some frames, with the contours of further ones. Same what-if and level. Stopped.
std::shared_ptr<const Scene> withContours(const Scene& changed, const WhatIf& whatIf, double level,
                                          const std::vector<int>& frames, const ProgressFn& progress = {});

/// A highlight with a change; its ellipse and area follow.
Highlight changed(Highlight highlight, const HighlightChange& change);

/// The part that makes the scene's evidence, with all else at its default: the default where nothing is synthesised.
WhatIf synthesisOf(const WhatIf& whatIf);
/// Those that are switched off.
std::map<std::pair<int, std::string>, bool> lightsOff(const WhatIf& whatIf);
/// Equal for equal pictures, exact to the last bit: of what is synthesised, "" without, and of the lights that are switched off.
std::string synthesisKey(const WhatIf& whatIf);
std::string lightsOffKey(const WhatIf& whatIf);

/// What a hand holds in a frame's picture.
enum class Held {
  Contour,      ///< the whole contour; the peak stays
  ContourSize,  ///< its distance from the centroid
  Peak,
  Camera  ///< what is under the hand stays under it: the camera turns about its centre
};

/// The changes after a hand moved from one place of a picture to another, on top of those it started from.
/// @param camera     of the frame, as the start has it
/// @param highlight  index in the frame's evidence, and `now` that highlight as the start has it; unused for Camera
/// @param from, to   ideal pixels
/// Places that give no finite change (the centroid as a handle of the size) change nothing.
WhatIf dragged(const WhatIf& start, Held held, int frame, const Camera& camera, int highlight, const Highlight& now,
               const Pixel& from, const Pixel& to);

/// A true light moved by a vector, world, m; one at infinity does not move.
WhatIf draggedLight(const WhatIf& start, const TrueLight& light, const Eigen::Vector3d& by);

}  // namespace glint
