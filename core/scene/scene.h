// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/base/permitted.h"
#include "core/geometry/camera.h"
#include "core/highlight/highlight.h"
#include "core/reflectance/lamp.h"
#include "core/scene/camera_response.h"
#include "core/scene/input_choices.h"
#include "core/scene/light_frame.h"
#include "core/scene/surface_source.h"
#include "core/scene/video.h"

namespace glint {

/// One captured view. Paths are absolute; empty = not given.
struct Frame {
  std::string id;
  std::filesystem::path image, radiance, depth, normals, mask;
  std::optional<VideoPicture> ofVideo;  ///< `image` is a video, and this is the picture of it
  double depthScale = 0;                ///< metres per stored unit; 0 = not given (then depth must be float)
  Camera camera;
  CameraResponse response;  ///< of `image`
  /// The camera that took `depth`, if not `camera`; its camFromWorld starts at the frame's camera, not at the world.
  std::optional<Camera> depthCamera;
  std::string surface;  ///< id in Scene::surfaces; "" = this frame's own depth map
  /// Where that surface stands, rigid; an own depth map stands where its camera does.
  Eigen::Isometry3d worldFromObject = Eigen::Isometry3d::Identity();
  std::vector<std::string> lightsOn;  ///< empty = not stated
  std::vector<Highlight> highlights;  ///< given ones; used instead of detection when not empty
};

/// What a file of a frame shows. Photograph: Frame::image and Frame::radiance.
enum class FrameFile { Photograph, Depth, Normals, Mask };

/// A folder in which the files of one kind are looked for before the place that the scene says.
struct FilesFolder {
  FrameFile kind = FrameFile::Photograph;
  std::filesystem::path folder;  ///< absolute
  friend bool operator==(const FilesFolder&, const FilesFolder&) = default;
};

/// A light that the scene states: truth for evaluation and display only, never read by reconstruction or prediction, unless it
/// says that it is known.
struct TrueLight {
  std::string id;
  Lamp lamp;  ///< in the coordinates of `frame`
  LightFrame frame = LightFrame::World;
  bool known = false;  ///< input for fits, which keep it as it is
  double sigma = 0;    ///< of a known one: standard deviation of each coordinate of its place, m, or of its direction, degrees
};

/// Everything a scene file says, checked. Images and surfaces are loaded on demand.
struct Scene {
  std::string name;
  std::string kind = "scene";        ///< how it was read, as InputChoices::as: "scene", "colmap", ...
  std::filesystem::path file;        ///< as opened
  std::filesystem::path folder;      ///< absolute folder of the file; all relative paths start here
  bool allowOutsidePaths = false;    ///< as it was read with (ReadOptions)
  std::vector<FilesFolder> folders;  ///< in which frames' files were looked for, in this order: the last that holds a file counts
  std::map<std::string, std::filesystem::path> meshes;  ///< those that lie elsewhere: by the path that the file writes, absolute
  std::vector<Frame> frames;
  std::map<std::string, SurfaceSource> surfaces;
  std::vector<TrueLight> lights;
  InputChoices choices;  ///< as it was read with; empty for a scene file
  std::vector<std::filesystem::path>
      sources;                        ///< files besides `file` that say what a capture is (COLMAP's images.bin); absolute
  std::vector<std::string> facts;     ///< what was recognised in a capture and converted, one line each
  std::vector<std::string> warnings;  ///< unknown keys and other oddities, one line each
  std::string
      unknownJson;  ///< unknown keys, kept for writing back, grouped by scene, camera, frames, surfaces, lights; "" = none

  /// The formula of a surface; null where there is no such surface (a frame's own depth map) or it has no formula.
  const AnalyticSpec* formulaOf(const std::string& surface) const;
  /// Whether there is such a surface and its normals may be off because it is made of triangles.
  bool hasTriangles(const std::string& surface) const { return surfaces.count(surface) && !formulaOf(surface); }
};

struct ReadOptions {
  bool allowOutsidePaths = false;                   ///< accept paths that leave the scene's folder
  std::vector<std::filesystem::path> folders = {};  ///< in which the scene may name files too: those that a person named
  /// Where meshes are instead, by the path that the scene file writes; a mesh may lie anywhere.
  std::map<std::string, std::filesystem::path> meshes = {};
  /// In which meshes are looked for, by the longest end of their path, that are not in their place.
  std::vector<std::filesystem::path> meshFolders = {};
  /// In which photographs are looked for first, for captures whose files do not say the size of their images.
  std::vector<std::filesystem::path> photographs = {};
  InputChoices choices = {};  ///< for captures of other programs

  PathRights rights() const { return {allowOutsidePaths, folders}; }
};

/// Reads any input that Glint knows, recognised by content. InputError with file, place and reason; MissingMesh, OutsidePath,
/// UndecidedInput (core/scene/capture.h).
Scene readScene(const std::filesystem::path& input, const ReadOptions& options = {});
/// The same for the input of a session, which must not be a session again.
Scene readSceneOfSession(const std::filesystem::path& input, const ReadOptions& options = {});
/// The file that `readScene` reads first for this input: for a folder the scene file, capture or session in it; "" = nothing is
/// recognised.
std::filesystem::path recognisedFile(const std::filesystem::path& input);
/// Writes scene.json version 1 with relative paths, atomically. InputError when it cannot be written.
void writeScene(const Scene& scene, const std::filesystem::path& file);

enum class FrameSource { Radiance, Image };
/// Linear image of a frame: the float radiance as stored, or the 8/16-bit image through the camera's response (where none is
/// stated, 16-bit is taken as linear only if the file says so; else sRGB). Three channels stay three.
/// @param how  receives, in words, how the values became linear: "8-bit codes through the sRGB curve (default: no response is
///             stated)"
/// FrameUnreadable (missing, empty, truncated, another size than the camera's), with the file in the detail.
Outcome<Image> readLinear(const Frame& frame, FrameSource source, std::string* how = nullptr);
/// What a detection looks at: the linear image and, where there is one, the mask. One photograph is decoded for both.
struct MaskedImage {
  Image linear;
  std::optional<Image> mask;
  const Image* maskIfAny() const { return mask ? &*mask : nullptr; }
};
/// readLinear() and readMask(), with their failures.
Outcome<MaskedImage> readMasked(const Frame& frame, FrameSource source);
/// The display image, 3 channels, sRGB 0..1: the codes as they are where they are sRGB, else their light in sRGB; tone-mapped
/// radiance when there is no photograph.
Outcome<Image> readPhotograph(const Frame& frame);
/// For a program's start: from now on this process keeps decoded image files, up to this many bytes of pixels in all, for the
/// next look at a frame. A file that changes is read again. 0, the value at the start of every process, keeps nothing.
void keepDecodedImages(std::size_t mostBytes);
/// While it lives, the photographs, radiance and masks of these frames are decoded once, as long as 256 MB of pixels hold
/// them; what has no room is decoded again whenever it is looked at. Several may live at the same time.
class PhotographsHeld {
 public:
  PhotographsHeld(const Scene& scene, const std::vector<int>& frames);
  ~PhotographsHeld();
  PhotographsHeld(const PhotographsHeld&) = delete;
  PhotographsHeld& operator=(const PhotographsHeld&) = delete;

 private:
  std::vector<std::filesystem::path> files_;
};
/// 1 on the glossy object, 0 elsewhere; without a mask, 0 where the photograph is transparent. Nothing when the frame has
/// neither. FrameUnreadable.
Outcome<std::optional<Image>> readMask(const Frame& frame);
/// Depth along the optical axis in metres, 0 = none (non-finite and negative values too); nothing when the frame has none. The
/// depth of a separate depth camera is registered to the frame's camera (registeredDepth). FrameUnreadable, also for an integer
/// image without `depth_scale`.
Outcome<std::optional<Image>> readDepth(const Frame& frame);
/// The depth for a trial: with the policy's noise, whose stream depends on the frame's id. Otherwise as readDepth.
Outcome<std::optional<Image>> readDepth(const Frame& frame, const DepthPolicy& policy);
/// World normals, 3 channels (x y z), not normalised: as stored, or v / 65532 * 2 - 1 of a 16-bit image; nothing when the frame
/// has none.
Outcome<std::optional<Image>> readNormals(const Frame& frame);

/// Loads surfaces once per (source, policy) and shares them; of the frames' own depth maps only the last few stay (others are
/// loaded again when asked for), so that memory does not grow with the number of frames. Thread-safe.
class SurfaceCache {
 public:
  explicit SurfaceCache(const Scene& scene);
  /// Takes over what `other` has loaded and this scene does not change: meshes of the same file. Analytic surfaces and depth
  /// maps, which follow their cameras, are made anew.
  SurfaceCache(const Scene& scene, const SurfaceCache& other);
  ~SurfaceCache();
  /// The surface that a frame sees. NoSurface; FrameUnreadable for its depth image; InputError when a mesh cannot be read.
  Outcome<std::shared_ptr<const Surface>> surfaceOf(int frame, MeshPolicy policy) const;
  /// A key that is equal for frames that see the same surface ("body"; "depth:0004" for a frame's own depth).
  std::string keyOf(int frame) const;
  /// The same for frames that see it in the same place: where an object moves, "body@3" with the first frame that shows it there.
  std::string placedKeyOf(int frame) const;
  /// What the fusion of depth maps (DepthPolicy::fusedFrames) left out of these frames, in words; "" = nothing, or they were not
  /// loaded.
  std::string fusionRemark(const std::vector<int>& frames) const;

  /// Number of depth maps that are kept for the next question, beside those in use. One of 1920 x 1080 takes several hundred MB.
  static constexpr int kDepthMapsKept = 2;
  struct Statistics {
    int loads = 0;          ///< surfaces built so far
    int depthMaps = 0;      ///< of them, held now
    int mostDepthMaps = 0;  ///< held at any time
  };
  Statistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
