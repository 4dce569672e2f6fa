// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/permitted.h"
#include "core/geometry/camera.h"
#include "core/scene/video.h"

namespace glint {

/// The files leave something open that a person can say: which reading of a folder is meant, which surface, camera or object.
class UndecidedInput : public InputError {
 public:
  enum class Question { Reading, Surface, Camera, Object, Poses, PosesBy };
  struct Answer {
    std::string value;  ///< for the option: "colmap"; path of a mesh; "5"
    std::string words;  ///< for a person; "" = the value
  };
  /// @param answers  the possible ones; none = any (a file; numbers)
  UndecidedInput(const std::string& file, const std::string& reason, Question question, std::vector<Answer> answers)
      : InputError(file, "", reason), question_(question), answers_(std::move(answers)) {}
  Question question() const { return question_; }
  const std::vector<Answer>& answers() const { return answers_; }
  const char* option() const;  ///< that answers: "--as", "--surface", "--camera", "--object", "--poses", "--poses-by"

 private:
  Question question_;
  std::vector<Answer> answers_;
};

/// One photograph with its camera, as another program left them on disk, in our conventions: (0, 0) is the centre of the first
/// pixel, axes x right, y down, z forward, world to camera. Lengths are in the unit of the capture.
struct CaptureView {
  std::string name;                          ///< of the image, as the file writes it ("a/0003.jpg"); views are ordered by it
  std::filesystem::path image, depth, mask;  ///< absolute; "" = not named. They need not exist
  std::optional<VideoPicture> ofVideo;       ///< `image` is a video, and this is the picture of it
  double depthScale = 0;                     ///< metres per stored unit of `depth`; 0 = not given
  Camera camera;                             ///< with the size of its image
  Eigen::Isometry3d worldFromObject = Eigen::Isometry3d::Identity();  ///< where the surface stands
};

/// A mesh that the other program names itself (BOP's models).
struct CaptureMesh {
  std::filesystem::path file;  ///< absolute
  double metresPerUnit = 1;
};

/// What was read, complete and checked: poses rigid, all numbers finite, names unique.
struct Capture {
  std::string kind;                            ///< name of the reader: "colmap", ...
  std::filesystem::path file;                  ///< the one that was recognised; absolute
  std::filesystem::path folder;                ///< absolute, the project's root: paths of images start here
  std::vector<std::filesystem::path> sources;  ///< every file that was read for it but images, `file` first; absolute
  double metresPerUnit = 1;                    ///< of poses and points; 1 where the program does not say
  bool hasScale = false;                       ///< the program knows its unit (BOP, TUM); false: the scale is arbitrary (COLMAP)
  std::vector<CaptureView> views;              ///< ordered, not empty
  std::optional<CaptureMesh> mesh;
  std::vector<std::string> facts;     ///< what was recognised and converted, one line each, for the report
  std::vector<std::string> warnings;  ///< what a person should know, one line each
};

/// A sparse point and the pixels at which photographs show it, for checks of cameras against the program's own measurements.
struct CaptureTrack {
  struct Observation {
    int view = 0;  ///< index in Capture::views
    Pixel measured;
  };
  Eigen::Vector3d point;          ///< in the world of the views, in the unit of the capture
  std::vector<Observation> seen;  ///< empty if the program does not say which cameras saw it (nerfstudio)
};

/// What the files of other programs do not say, from the command line or a session.
struct CaptureOptions {
  PathRights rights;
  std::vector<std::filesystem::path> photographs;  ///< folders in which images are looked for first
  std::optional<Camera> camera;  ///< intrinsics of all views (TUM); its size is that of the images; pose ignored
  std::string object;            ///< BOP: its number; "" = the only one
  std::string world;             ///< nerfstudio: "original" undoes applied_transform; "" = as stored
  std::filesystem::path poses;   ///< of images and videos: TUM or JSON lines; absolute
  bool posesByOrder = false;     ///< the n-th pose is that of the n-th picture
};

/// One kind of input.
class CaptureReader {
 public:
  virtual ~CaptureReader() = default;
  virtual std::string name() const = 0;      ///< as `--as` takes it: "colmap"
  virtual std::string describe() const = 0;  ///< for a person: "COLMAP model (text or binary)"
  /// The file to read when this reader understands `input` (a file, or a folder in which it looks), by content; an empty path
  /// otherwise. Never throws for an unreadable input.
  virtual std::filesystem::path recognise(const std::filesystem::path& input) const = 0;
  /// What `recognise` would return for a folder if a file that it needs were there, so that `read` can say which; "" = nothing.
  /// Asked where no reader recognises the folder.
  virtual std::filesystem::path incomplete(const std::filesystem::path& folder) const;
  /// Reads what `recognise` found. InputError (file, place: "line 12", "frames[3].transform_matrix" or "byte 120", reason).
  virtual Capture read(const std::filesystem::path& file, const CaptureOptions& options) const = 0;
  /// The sparse points of what `read` returned; empty if the program has none. InputError as `read`.
  virtual std::vector<CaptureTrack> tracks(const Capture& capture, const CaptureOptions& options) const;
};

/// All of them, in the order in which they are asked.
const std::vector<std::unique_ptr<const CaptureReader>>& captureReaders();
/// Folders besides its own in which a capture may name files, by the path of the file that is recognised: the project's root of a
/// COLMAP model in `sparse/0`, that of `bundle/bundle.out`, the folders of models of a BOP data set (no link that leaves it).
std::vector<std::filesystem::path> foldersOfCapture(const std::filesystem::path& file);
/// Null for an unknown name.
const CaptureReader* captureReaderNamed(const std::string& name);

std::unique_ptr<const CaptureReader> makeColmapReader();
std::unique_ptr<const CaptureReader> makeNvmReader();
std::unique_ptr<const CaptureReader> makeNerfstudioReader();
std::unique_ptr<const CaptureReader> makeTumReader();
std::unique_ptr<const CaptureReader> makeBundlerReader();
std::unique_ptr<const CaptureReader> makeBopReader();

/// A folder of images, and a video, whose poses CaptureOptions names (its `poses`). Not among captureReaders(): nothing in such a
/// folder says that it is a capture, so they are asked only if the user names the poses.
std::unique_ptr<const CaptureReader> makeImagesReader();
std::unique_ptr<const CaptureReader> makeVideoReader();

/// One photograph to write for another program.
struct PosedImage {
  std::string name;   ///< of the image relative to the file's folder (transforms.json) or to the folder of images (COLMAP)
  Camera camera;      ///< with pose, our conventions
  std::string depth;  ///< transforms.json only: relative path of a 16-bit depth map in millimetres; "" = none
  std::string mask;   ///< transforms.json only; "" = none
};

/// nerfstudio's transforms.json, with 17 digits. InputError (file, place frames[i]) for skew or a lens that nerfstudio lacks.
/// @param points  relative path of a point cloud; "" = none
void writeTransforms(const std::vector<PosedImage>& images, const std::filesystem::path& file, const std::string& points = "");

/// COLMAP's text model (cameras.txt, images.txt, points3D.txt without points) in a folder, with 17 digits, whole or not at all.
/// Cameras that are equal become one. InputError (folder, name of the image) for skew or VISUALSFM's lens, which COLMAP lacks.
void writeColmapText(const std::vector<PosedImage>& images, const std::filesystem::path& folder);

/// std::invalid_argument for a name that is taken, empty, or one that `--as` knows for another input (scene, session).
void checkCaptureReader(const CaptureReader& reader);
/// One more reader of captures, asked after the others. Not thread-safe: before any input is read. std::invalid_argument as
/// checkCaptureReader().
void addCaptureReader(std::unique_ptr<const CaptureReader> reader);

}  // namespace glint
