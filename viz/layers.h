// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkImageData.h>
#include <vtkProp3D.h>
#include <vtkSmartPointer.h>
#include <vtkTexture.h>

#include <array>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/app/lamp_answer.h"
#include "core/draw/scene_drawing.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/summary.h"
#include "viz/convert.h"
#include "viz/hidden_objects.h"
#include "viz/scene_view.h"
#include "viz/style.h"

class vtkCamera;
class vtkRenderer;

namespace glint::viz {

struct WalkStory;
struct DrawnRuns;

constexpr double kAboutCanonical = 1.3;      ///< radius of a tangent plane that holds a canonical contour, of that contour's
constexpr long long kLargeSurface = 200000;  ///< triangles: beyond, drawing takes more than 50 ms without a graphics card

/// Results of slow look-ups, kept while the inspection (or its scene) stays the same.
class LayerCache {
 public:
  struct Photograph {
    vtkSmartPointer<vtkImageData> texture;  ///< null: see `arriving`
    bool arriving = false;                  ///< requested, but not loaded yet; else unreadable
  };
  /// Gives photographs that are read elsewhere, so that drawing does not wait for files. @param frame  index.
  using PhotographSource = std::function<Photograph(int frame, int maxWidth)>;
  void setPhotographSource(PhotographSource source) { source_ = std::move(source); }
  /// The photograph of a frame as a texture, at most `maxWidth` wide. Without a source it is read here, and the last ones are
  /// kept.
  Photograph photograph(const Inspection& inspection, int frame, int maxWidth);
  /// What draws a picture on planes. The same for the same picture, also after a layer was built again, so that it is brought to
  /// the graphics card (without one: made ready at every size) once; the last ones used are kept.
  vtkSmartPointer<vtkTexture> textureOf(const vtkSmartPointer<vtkImageData>& picture);

  /// The display triangles of a surface, with normals, and the coarse ones, which are made on a thread of their own.
  struct Triangles {
    vtkSmartPointer<vtkPolyData> fine;
    std::shared_future<vtkSmartPointer<vtkPolyData>> coarse;  ///< not valid() for a surface that is small enough
    vtkSmartPointer<vtkPolyData> coarseIfReady() const;
  };
  Triangles tessellation(const std::shared_ptr<const Surface>& surface, const Eigen::AlignedBox3d& region);
  /// Forgets everything when the scene is another one.
  void follow(const std::shared_ptr<const Scene>& scene);

 private:
  PhotographSource source_;
  std::shared_ptr<const Scene> scene_;
  std::vector<std::pair<std::pair<int, int>, vtkSmartPointer<vtkImageData>>> photographs_;       ///< oldest first
  std::string photographsKey_;                                                                   ///< pictureKey() of those
  std::vector<std::pair<vtkSmartPointer<vtkImageData>, vtkSmartPointer<vtkTexture>>> textures_;  ///< longest unused first
  std::vector<std::pair<std::shared_ptr<const Surface>, Triangles>> tessellations_;
};

/// What a layer is built from.
struct LayerInput {
  const Inspection* inspection = nullptr;  ///< never null, and its scene is not
  Selection selection;                     ///< frame is valid
  std::vector<std::string> models;         ///< shown, from simple to rich
  SceneScale scale;
  double glyphScale = 1;
  std::shared_ptr<const Surface> surface;  ///< of the selected frame; null if it has none
  std::string surfaceKey;
  std::string surfaceProblem;  ///< why the surface is missing
  std::vector<int> frames;     ///< frames whose cameras are drawn: one per pose, those on this surface first
  bool dark = true;
  bool solo = false;  ///< only what belongs to the selected frame
  HiddenObjects hidden;
  CameraColours colours;
  Eye eye = Eye::Outside;            ///< other than Outside only where it is in effect
  std::optional<Plane> eyeMirror{};  ///< of the virtual camera that is looked through
  LayerCache* cache = nullptr;
  std::shared_ptr<const WalkStory> walk{};                 ///< that the walk layer shows; null = none
  int walkStep = 0;                                        ///< see WalkStory::at
  std::shared_ptr<const std::vector<LampAnswer>> lamps{};  ///< measured; null = not
  std::shared_ptr<const std::vector<DrawnRuns>> runs{};    ///< of solvers; null = none are known

  const Frame& frame(int index) const { return inspection->scene->frames[static_cast<std::size_t>(index)]; }
  /// Whether what belongs to a frame is drawn: neither hidden nor left out by solo.
  bool shows(int frame) const { return (!solo || frame == selection.frame) && hidden.frames.count(frame) == 0; }
  /// Whether a frame sees the surface that is shown.
  bool onSurface(int frame) const;
  /// Usable training views on the shown surface, of frames that are shown.
  std::vector<const TrainingView*> views() const;
  /// Where the selected frame does not train: brightest point, tangent plane and virtual camera of each highlight observed in it.
  /// Empty if it trains, has no surface or is hidden.
  /// @param walked  with their canonical contours by the light that the training frames gave, and only those that have one:
  ///                some milliseconds
  std::vector<TrainingView> ownViews(bool walked = false) const;
  /// Usable views that a fit was made from, whatever surface they see, of frames that are shown.
  std::vector<const TrainingView*> viewsOf(const ModelFit& fit) const;
  /// Usable fits of a model that apply to the shown surface and are not hidden.
  std::vector<const ModelFit*> fits(const std::string& model) const;
  /// Predictions for the selected frame that are not hidden, nor is the frame.
  std::vector<const FrameComparison*> comparisons(const std::string& model) const;
  /// The mirrors of a frame's highlights: tangent planes of its training views, else at its observed peaks.
  struct Mirror {
    Plane plane;
    int highlight = -1;  ///< index in the frame's evidence
    std::string light;
  };
  std::vector<Mirror> mirrors(int frame) const;
  /// Index of a training view's highlight in its frame's evidence; -1 if it is missing.
  int highlightOf(const TrainingView& view) const { return draw::highlightOf(*inspection, view); }
  /// Whether the fit behind a prediction explains its training views badly: it is drawn pale.
  bool isPoor(const std::string& model, const FrameComparison& comparison) const {
    return !poorFit(inspection->models.at(model), comparison).empty();
  }
  /// Ink that reads on the background.
  Colour ink() const { return dark ? kTextOnDark : kTextOnLight; }
};

/// One actor of a layer, with what picking it tells. `info.position` is filled by the pick.
struct Drawn {
  vtkSmartPointer<vtkProp3D> prop;
  Picked info;
  double lineWidthPx = 0;  ///< > 0: a line, scaled with the window
  bool pickable = true;
  std::function<Picked(vtkIdType cell)> describe = {};  ///< instead of `info`, where one actor draws many things
  /// > 0: lies on the surface and is drawn before it, by as much as this many px measure there (in a picture 900 px high). It
  /// moves along the rays of sight, so no gap shows from anywhere; see LayerContent::bringNearer.
  double nearerPx = 0;
};

/// Text at a world point, drawn above everything.
struct DrawnLabel {
  Eigen::Vector3d anchor;
  std::string text;
  Colour colour;
  std::optional<Eigen::Vector3d> tail{};  ///< of the arrow whose tip the anchor is: the text is in front of it
  double clear = 0;                       ///< m: radius about the anchor, of the thing beside the text
};

constexpr std::size_t kMostGlyphs = 64;  ///< more cameras leave no place free of them

/// What one layer puts into the picture.
struct LayerContent {
  std::vector<Drawn> drawn;
  std::vector<DrawnLabel> labels;
  std::vector<std::string> notes;       ///< what could not be drawn, and why: shown in the corner
  std::vector<std::string> remarks;     ///< what was left out on purpose: the same, without alarm
  std::vector<Eigen::Vector3d> extent;  ///< points beyond the scene box that "frame all" should hold
  std::vector<Points> glyphs;           ///< corners of drawn cameras, at most kMostGlyphs, and of lights: labels keep off them
  bool behindSurface = false;           ///< something of it is hidden by the surface from where the photographs were taken

  void add(vtkSmartPointer<vtkProp3D> prop, const Picked& info, double lineWidthPx = 0, bool pickable = true) {
    drawn.push_back({std::move(prop), info, lineWidthPx, pickable});
  }
  /// Adds an actor of many things, told apart by their cells.
  void addMany(vtkSmartPointer<vtkProp3D> prop, std::function<Picked(vtkIdType cell)> describe, double lineWidthPx) {
    drawn.push_back({std::move(prop), {}, lineWidthPx, true, std::move(describe)});
  }
  /// Adds what lies on the surface, see Drawn::nearerPx.
  void addOnSurface(vtkSmartPointer<vtkProp3D> prop, const Picked& info, double lineWidthPx, double nearerPx) {
    drawn.push_back({std::move(prop), info, lineWidthPx, true, {}, nearerPx});
  }
  /// Prepares the camera of the picture that is drawn next.
  void bringNearer(vtkCamera* camera, int heightPx) const;
  /// Moves them to the end of VTK's drawing order: at equal depth, the last thing drawn shows.
  void drawLast(vtkRenderer& renderer) const;
};

/// Which changes make a layer stale.
enum Dependency : unsigned {
  kOnInspection = 1,
  kOnSurface = 2,
  kOnFrame = 4,
  kOnModels = 8,
  kOnGlyphs = 16,
  kOnTheme = 32,
  kOnHighlight = 64,
  kOnPicked = 128,  ///< selected model, light, direction
  kOnEye = 256,
  kOnColours = 512,
  kOnPhotographs = 1024,
  kOnSolo = 2048,
  kOnWalk = 4096,
  kOnScene = 8192,  ///< cameras and files: another scene, or a what-if that moves cameras
  kOnHidden = 16384,
  kOnLamps = 32768,  ///< measured anew
  kOnRuns = 65536    ///< of solvers, see SceneView::setRuns()
};

struct LayerRecipe {
  Layer layer;
  unsigned dependencies;
  LayerContent (*build)(const LayerInput&);
};
/// All layers in the order of sceneLayers().
const std::vector<LayerRecipe>& layerRecipes();

LayerContent surfaceLayer(const LayerInput& in);            ///< shaded triangles, no edges
LayerContent camerasLayer(const LayerInput& in);            ///< frustums
LayerContent photographsLayer(const LayerInput& in);        ///< textured image planes of the frustums, at most 24
LayerContent virtualCamerasLayer(const LayerInput& in);     ///< mirrored frustums, joined with their cameras through T
LayerContent peaksLayer(const LayerInput& in);              ///< P_B and N
LayerContent tangentPlanesLayer(const LayerInput& in);      ///< discs
LayerContent canonicalEllipsesLayer(const LayerInput& in);  ///< the image ellipse carried back to T
LayerContent directionsLayer(const LayerInput& in);         ///< walks of section 6, failed ones red
LayerContent walkLayer(const LayerInput& in);               ///< one walk, as far as its step
LayerContent conesLayer(const LayerInput& in);              ///< from the cameras through their ellipses to Q*
LayerContent ellipsoidsLayer(const LayerInput& in);         ///< Q* of each model
LayerContent lightLayer(const LayerInput& in);              ///< estimates
LayerContent trueLightLayer(const LayerInput& in);          ///< truth, ringed and labelled
LayerContent solverRunsLayer(const LayerInput& in);         ///< from where each run of a solver started to where it ended
LayerContent measuredLampsLayer(const LayerInput& in);      ///< places with their regions of 95 %, directions with their cones
LayerContent raysLayer(const LayerInput& in);               ///< view rays and their reflections
LayerContent observedContoursLayer(const LayerInput& in);   ///< cast onto the surface
LayerContent predictedContoursLayer(const LayerInput& in);  ///< of the selected frame

/// What the picture shows behind the surface: virtual cameras stand out beyond it, an ellipsoid may lie wholly inside.
enum class Behind { Nothing, VirtualCameras, Ellipsoids };

/// How the drawn surface looks at the moment. What lies behind it shines through, an ellipsoid more than virtual cameras, unless
/// it is so large that drawing it in several passes would be slow. Through a virtual camera, what lies behind its mirror is cut
/// away. While something moves, the coarse triangles stand for it.
void styleSurface(const LayerContent& surface, const LayerInput& in, Behind behind, bool moving);

/// Frames to draw: one for each distinct pose; where several share a pose, one that sees `surfaceKey` is taken.
/// @param hidden  are not drawn.
std::vector<int> framesToDraw(const Inspection& inspection, const std::string& surfaceKey, int selected,
                              const std::set<int>& hidden = {});

/// A contour on the surface: broken where it leaves the surface or jumps to another part of it.
std::vector<Points> castContour(const Camera& camera, const Surface& surface, const Polyline& contour, const SceneScale& scale,
                                double lift);
/// Radius of a disc on a tangent plane, so many times as wide as a contour there.
/// @param times  3: the highlight is in the middle of a plane that is seen as one.
double planeRadius(const Camera& camera, const Plane& plane, const Eigen::Vector3d& at, const std::vector<Pixel>& contour,
                   const SceneScale& scale, double times = 3);
/// Direction of an ideal pixel from an observed contour, as Selection::direction has it. @param ideal  finite.
double directionOf(const Camera& camera, const Highlight& observed, const Pixel& ideal);
/// The vertex of a contour that lies in that direction from the observed one; nothing on an empty contour.
std::optional<Pixel> vertexInDirection(const Camera& camera, const Highlight& observed, const Polyline& contour,
                                       double direction);

/// "name = 1.234567 unit" lines for Picked::text.
std::string line(const std::string& name, double value, const std::string& unit = "");
std::string line(const std::string& name, const Eigen::Vector3d& value, const std::string& unit = "");
std::string line(const std::string& name, const std::string& value);

}  // namespace glint::viz
