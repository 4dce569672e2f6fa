// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/number_text.h"
#include "core/scene/capture.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/capture_image_sizes.h"
#include "core/scene/capture_parts.h"
#include "core/scene/text_rows.h"
#include "io/text_scan.h"

// The RGB-D benchmark of TUM (Sturm et al., IROS 2012). Lists of images: `timestamp path`. Trajectory: `timestamp tx ty tz qx
// qy qz qw`, the place and rotation of the colour camera's optical centre, in the world of the motion capture: camera
// to world, with the axes of OpenCV. Times are in seconds.

namespace glint {
namespace {
namespace fs = std::filesystem;

constexpr const char* kTumPoses = "groundtruth.txt";
constexpr const char* kTumDepth = "depth.txt";
constexpr double kTumDepthScale = 1.0 / 5000;  // m per unit: the benchmark's 16-bit depth images

/// One line of a list of images.
struct TumImage {
  double time = 0;
  std::string name, place;
};

struct TumPose {
  double time = 0;
  Eigen::Vector3d position;
  Eigen::Vector4d xyzw;  ///< as in the file
  std::string place;
};

std::vector<TumImage> readTumImages(const fs::path& file, std::vector<std::string>& warnings) {
  std::vector<TumImage> images;
  std::set<std::pair<std::string, double>> said;
  capture::PassedOver repeated, cut;
  const std::string text = readFile(file, Limit::MeshMegabytes);
  capture::RowReader rows(text, file.string());
  while (const auto row = rows.next()) {
    if (row->words.size() < 2) {
      cut.add(row->place());
      continue;
    }
    if (row->words.size() != 2)
      throw InputError(file.string(), row->place(),
                       "must be a time and a path without blanks, has " + std::to_string(row->words.size()) + " entries");
    TumImage image{capture::secondsOf(capture::numberAt(*row, 0, file.string())), std::string(row->words[1]), row->place()};
    if (!said.emplace(image.name, image.time).second)
      repeated.add(image.place);
    else
      images.push_back(std::move(image));
  }
  repeated.tell(file.filename().string(), capture::kSaidBefore, warnings);
  cut.tell(file.filename().string(), "is not a time and a path (a cut line?)", warnings);
  return images;
}

/// @param lost  the lines that hold NaN: where tracking was lost, as TUM's own tools pass over them
/// @param cut   those of fewer numbers, as a full disk leaves the last one; where there is no other, the first is refused
std::vector<TumPose> readTumPoses(const fs::path& file, capture::PassedOver& lost, capture::PassedOver& cut) {
  constexpr std::size_t kNumbers = 8;
  std::vector<TumPose> poses;
  const std::string text = readFile(file, Limit::MeshMegabytes);
  capture::RowReader rows(text, file.string());
  std::optional<InputError> first;
  while (const auto row = rows.next()) {
    if (row->words.size() != kNumbers) {
      const InputError wrong(
          file.string(), row->place(),
          "must be 8 numbers (timestamp tx ty tz qx qy qz qw), has " + std::to_string(row->words.size()) + " entries");
      if (row->words.size() > kNumbers) throw wrong;
      if (!first) first = wrong;
      cut.add(row->place());
      continue;
    }
    TumPose pose{capture::secondsOf(capture::numberAt(*row, 0, file.string())), {}, {}, row->place()};
    if (capture::isLostTum(*row)) {
      lost.add(row->place());
      continue;
    }
    pose.position = capture::placeAt(*row, 1, file.string());
    for (int i = 0; i < 4; ++i) pose.xyzw[i] = capture::numberAt(*row, std::size_t(4 + i), file.string());
    poses.push_back(std::move(pose));
  }
  if (poses.empty() && first) throw *first;
  return poses;
}

template <class Timed>
std::vector<double> tumTimes(const std::vector<Timed>& list) {
  std::vector<double> times;
  for (const Timed& t : list) times.push_back(t.time);
  return times;
}

/// "1305031102.175304": as many digits as TUM writes.
std::string tumTime(double seconds) { return formatted("%.6f", seconds); }

/// What `read` does, step by step.
class TumReading {
 public:
  TumReading(const fs::path& file, const CaptureOptions& options)
      : options_(options), names_(options.rights, options.photographs) {
    capture_.kind = "tum";
    capture_.file = fs::absolute(file).lexically_normal();
    capture_.folder = capture_.file.parent_path();
    capture_.sources = {capture_.file};
    capture_.hasScale = true;  // metres
  }

  Capture read() {
    const std::string file = capture_.file.string();
    if (!options_.camera)
      throw UndecidedInput(file, "TUM files have no intrinsics; name them by --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3]",
                           UndecidedInput::Question::Camera, {});
    photographs_ = readTumImages(capture_.file, capture_.warnings);
    if (photographs_.empty()) throw InputError(file, "", "names no photograph");
    const fs::path poseFile = source(kTumPoses);
    capture::PassedOver lost, cut;
    poses_ = readTumPoses(poseFile, lost, cut);
    std::error_code ignored;  // unreadable counts as missing
    const bool hasDepth = fs::exists(capture_.folder / kTumDepth, ignored);
    if (hasDepth) depths_ = readTumImages(source(kTumDepth), capture_.warnings);
    addViews(poseFile.string());
    capture::orderByName(capture_);
    setCameras();
    report(hasDepth);
    lost.tell(kTumPoses, capture::kNoFinitePose, capture_.warnings);
    cut.tell(kTumPoses, capture::kCutPose, capture_.warnings);
    names_.tell(capture_.warnings);
    return std::move(capture_);
  }

 private:
  /// Another file of the folder: not followed through a link that leaves it.
  fs::path source(const char* name) {
    capture_.sources.push_back(resolveInside(capture_.folder, name, options_.rights, capture_.file.string(), name));
    return capture_.sources.back();
  }

  void addViews(const std::string& poseFile) {
    const std::string file = capture_.file.string(), depthFile = (capture_.folder / kTumDepth).string();
    const std::vector<double> times = tumTimes(photographs_);
    const std::vector<std::size_t> pose = capture::timePairs(times, tumTimes(poses_)),
                                   depth = capture::timePairs(times, tumTimes(depths_));
    std::vector<std::string> odd;
    for (std::size_t i = 0; i < photographs_.size(); ++i) {
      if (pose[i] == capture::kNoPair) continue;
      const TumImage& photograph = photographs_[i];
      const TumPose& p = poses_[pose[i]];
      farthestApart_ = std::max(farthestApart_, std::abs(p.time - photograph.time));
      CaptureView view;
      view.name = photograph.name;
      view.image = names_.image(photograph.name, {capture_.folder}, file, photograph.place);
      Eigen::Isometry3d worldFromCam = Eigen::Isometry3d::Identity();
      worldFromCam.linear() =
          capture::unitQuaternion(p.xyzw[3], p.xyzw[0], p.xyzw[1], p.xyzw[2], poseFile, p.place, odd).toRotationMatrix();
      worldFromCam.translation() = p.position;
      view.camera.camFromWorld = worldFromCam.inverse();
      if (depth[i] != capture::kNoPair) {
        // Not where photographs are looked for: sets name both kinds alike ("rgb/0.png", "depth/0.png").
        const TumImage& d = depths_[depth[i]];
        view.depth = names_.other(capture_.folder, d.name, depthFile, d.place);
        view.depthScale = kTumDepthScale;
        ++withDepth_;
      }
      capture_.views.push_back(std::move(view));
    }
    if (capture_.views.empty()) throw InputError(poseFile, "", nonePaired());
    for (std::string& line : odd) line = std::string(kTumPoses) + ": " + line;
    capture::addFew(capture_.warnings, odd);
  }

  std::string nonePaired() const {
    if (poses_.empty()) return "has no pose";
    return "has no pose within 20 ms of any of the photographs of " + capture_.file.filename().string() +
           " (the first photograph is of " + tumTime(photographs_.front().time) + ", the first pose of " +
           tumTime(poses_.front().time) + ")";
  }

  /// One camera took all of them. Photographs that are missing are named by what needs them.
  void setCameras() {
    const std::string file = capture_.file.string();
    std::error_code ignored;  // unreadable counts as missing
    capture::ImageSizes sizes;
    const CaptureView* first = nullptr;
    std::array<int, 2> size{};
    for (const CaptureView& view : capture_.views) {
      if (!fs::is_regular_file(view.image, ignored)) continue;
      const std::array<int, 2> s = sizes.of(view.image, file, view.name);
      if (first && s != size)
        throw InputError(view.image.string(), "",
                         formatted("is %d x %d pixels, '%s' is %d x %d: --camera is one for all", s[0], s[1], first->name.c_str(),
                                   size[0], size[1]));
      if (!first) first = &view;
      size = s;
    }
    if (!first)
      size = capture::sizeOfImage(capture_.views.front().image, file, capture_.views.front().name);  // says what is missing
    const Eigen::Matrix3d& k = options_.camera->pixelFromRay;
    Camera camera =
        capture::cameraOf(size[0], size[1], k(0, 0), k(1, 1), k(0, 2), k(1, 2), options_.camera->lens, file, "--camera");
    camera.pixelFromRay(0, 1) = capture::bounded(k(0, 1), kFarthestPx, file, "--camera");
    for (CaptureView& view : capture_.views) {
      camera.camFromWorld = view.camera.camFromWorld;
      view.camera = camera;
    }
  }

  void report(bool hasDepth) {
    const std::size_t n = capture_.views.size();
    const Camera& camera = capture_.views.front().camera;
    capture_.facts.push_back("TUM RGB-D: " + capture::counted(n, "photograph", "photographs") + " of " +
                             std::to_string(camera.width) + " x " + std::to_string(camera.height) + " pixels, " +
                             capture::counted(poses_.size(), "pose", "poses"));
    capture_.facts.push_back(
        "poses are camera to world, quaternion w last, in metres; each photograph took the pose nearest in time" +
        formatted(" (%.1f ms at most), each pose once", 1e3 * farthestApart_));
    capture_.facts.push_back(std::string("intrinsics are those of --camera, ") + (camera.hasDistortion() ? "with" : "without") +
                             " distortion");
    if (hasDepth) {
      capture_.facts.push_back("depth is 16 bit, 5000 per metre, registered to the photographs: " + std::to_string(withDepth_) +
                               " of " + capture::counted(n, "photograph has", "photographs have") + " one");
      if (withDepth_ < n)
        capture_.warnings.push_back(capture::counted(n - withDepth_, "photograph has", "photographs have") +
                                    " no depth image within 20 ms");
    } else {
      capture_.facts.push_back(std::string("no ") + kTumDepth + ": no depth");
    }
    if (const std::size_t out = photographs_.size() - n; out > 0)
      capture_.warnings.push_back(capture::counted(out, "photograph of ", "photographs of ") +
                                  std::to_string(photographs_.size()) + (out == 1 ? " has" : " have") +
                                  " no pose within 20 ms and " + (out == 1 ? "is left out" : "are left out"));
  }

  const CaptureOptions& options_;
  capture::FileNames names_;
  Capture capture_;
  std::vector<TumImage> photographs_, depths_;
  std::vector<TumPose> poses_;
  std::size_t withDepth_ = 0;
  double farthestApart_ = 0;  // s
};

/// Whether the first line that is no comment is a time and a path: enough to tell it from other lists, and cheap.
bool looksLikeTumList(const fs::path& file) {
  constexpr std::size_t kStart = 4096;  // bytes: the comments of the benchmark's files have 100
  const std::string start = firstBytes(file, kStart);
  const std::optional<capture::Row> row = capture::RowReader(start, file.string()).next();
  return row && row->words.size() == 2 && io::numberOf(row->words[0]) && !io::numberOf(row->words[1]);
}

class TumReader : public CaptureReader {
 public:
  std::string name() const override { return "tum"; }
  std::string describe() const override { return "TUM RGB-D sequence (rgb.txt, groundtruth.txt, depth.txt)"; }

  fs::path recognise(const fs::path& input) const override {
    try {
      std::error_code ignored;  // unreadable counts as missing
      const bool isFolder = fs::is_directory(input, ignored);
      const fs::path list = isFolder ? input / "rgb.txt" : input;
      if (list.filename() != "rgb.txt" || !looksLikeTumList(list)) return {};
      // For the list itself, report that the poses are missing; a list in a folder might be another program's.
      if (isFolder && !fs::is_regular_file(input / kTumPoses, ignored)) return {};
      return list;
    } catch (const std::exception&) {  // no memory, a path that the system refuses: not recognised
      return {};
    }
  }

  Capture read(const fs::path& file, const CaptureOptions& options) const override { return TumReading(file, options).read(); }
};

}  // namespace

std::unique_ptr<const CaptureReader> makeTumReader() { return std::make_unique<const TumReader>(); }

}  // namespace glint
