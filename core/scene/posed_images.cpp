// SPDX-License-Identifier: BSD-3-Clause
// A folder of images, or a video, whose cameras a file of poses says (CaptureOptions::poses).
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>

#include "core/base/atomic_file.h"
#include "core/base/found_file.h"
#include "core/base/image_header.h"
#include "core/base/number_text.h"
#include "core/geometry/camera.h"
#include "core/scene/capture.h"
#include "core/scene/capture_image_sizes.h"
#include "core/scene/capture_parts.h"
#include "core/scene/pose_lines.h"
#include "core/scene/text_rows.h"
#include "io/text_scan.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// An image of a folder, or a picture of a video, before it has a camera.
struct Picture {
  std::string name;            ///< of the view
  std::string id;              ///< as a JSON line names it; "" of a video
  std::optional<double> time;  ///< s
  fs::path file;
  std::optional<VideoPicture> ofVideo;
};

bool looksLikeImageName(const fs::path& file) {
  const std::string ending = lowerEnding(file);
  static constexpr std::array<const char*, 6> kEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr"};
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

/// Directly in the folder, by name. Hidden files do not count: systems leave previews there ("._0001.jpg").
std::vector<fs::path> filesIn(const fs::path& folder, bool (*isOne)(const fs::path&)) {
  std::vector<fs::path> files;
  std::error_code error;  // what cannot be listed holds none
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (it->path().filename().string()[0] != '.' && it->is_regular_file(ignored) && isOne(it->path()))
      files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Whether its first line with anything in it is JSON: then lines are paired by id, else (TUM) by time.
bool isPoseJson(const std::string& text) {
  for (io::Lines lines(text); const auto line = lines.next();) {
    const std::size_t first = line->find_first_not_of(" \t\r\xEF\xBB\xBF");
    if (first != std::string_view::npos && (*line)[first] != '#') return (*line)[first] == '{';
  }
  return false;
}

/// Reads poses for pictures and gives every picture its camera, or leaves it out.
class PosedPictures {
 public:
  PosedPictures(Capture capture, std::vector<Picture> pictures, const CaptureOptions& options)
      : options_(options), capture_(std::move(capture)), pictures_(std::move(pictures)), isVideo_(capture_.kind == "video") {
    capture_.folder = capture_.file.parent_path();
    capture_.sources = {capture_.file, options_.poses};
  }

  /// @param size  of a picture of a video; images say their own
  Capture read(std::optional<std::array<int, 2>> size) {
    std::vector<std::string> odd;
    poses_ = readPoseLines(options_.poses, odd);
    if (options_.posesByOrder) requireNoneLost();
    byId_ = isPoseJson(readFile(options_.poses, Limit::MeshMegabytes));
    capture::addFew(capture_.warnings, odd);
    const std::vector<std::size_t> pose = options_.posesByOrder ? inOrder() : byId_ && !isVideo_ ? sameId() : sameTime();
    addViews(pose, size);
    report();
    return std::move(capture_);
  }

 private:
  std::string poseFile() const { return options_.poses.string(); }
  std::string what(std::size_t n) const {
    return isVideo_ ? capture::counted(n, "picture", "pictures") : capture::counted(n, "image", "images");
  }

  /// A line without a pose is skipped; by order the images behind it would take poses of others.
  void requireNoneLost() const {
    std::ifstream in(options_.poses, std::ios::binary);
    PoseLineReader reader(in, poseFile());
    try {
      while (reader.next()) continue;
    } catch (const LostPose& e) {
      throw InputError(poseFile(), e.place(), "there is no pose in this line: the poses behind it cannot be paired by order");
    }
  }

  std::vector<std::size_t> inOrder() const {
    if (poses_.size() != pictures_.size())
      throw InputError(poseFile(), "--poses-by order",
                       "has " + capture::counted(poses_.size(), "pose", "poses") + " for " + what(pictures_.size()) +
                           ": by order they must be as many");
    const auto asNumbers = [](const std::string& a, const std::string& b) {
      const auto digits = [](const std::string& s, std::size_t at) {
        return std::min(s.find_first_not_of("0123456789", at), s.size()) - at;
      };
      std::size_t i = 0, j = 0;
      for (; i < a.size() && j < b.size(); ++i, ++j) {
        const std::size_t m = digits(a, i), n = digits(b, j);
        if (m > 0 && n > 0 && m != n) return m < n;
        if (a[i] != b[j]) return a[i] < b[j];
      }
      return a.size() - i < b.size() - j;
    };
    for (std::size_t i = 1; i < pictures_.size() && !isVideo_; ++i)
      if (asNumbers(pictures_[i].name, pictures_[i - 1].name))
        throw InputError(capture_.folder.string(), "--poses-by order",
                         "the order of '" + pictures_[i - 1].name + "' and '" + pictures_[i].name +
                             "' is not certain: as text it is this one, as numbers the other; fill up their numbers with zeros, "
                             "or name the images in JSON lines");
    std::vector<std::size_t> pairs(pictures_.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = i;
    return pairs;
  }

  std::vector<std::size_t> sameId() const {
    std::map<std::string, std::size_t> lines;
    std::map<std::u32string, std::size_t> alike;  // by what is left of names that systems write differently
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      lines[poses_[i].id] = i;
      const auto [other, isNew] = alike.emplace(fileNameKey(fs::path(slashed(poses_[i].id)).filename().string()), i);
      if (!isNew) other->second = capture::kNoPair;
    }
    const auto lineOf = [&](const Picture& p) {
      for (const std::string& id : {p.name, p.id})
        if (const auto line = lines.find(id); line != lines.end()) return line->second;
      for (const std::string& id : {p.name, p.id})
        if (const auto line = alike.find(fileNameKey(id)); line != alike.end()) return line->second;
      return capture::kNoPair;
    };
    std::map<std::size_t, const Picture*> seen;
    std::vector<std::size_t> pairs(pictures_.size(), capture::kNoPair);
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const std::size_t line = lineOf(pictures_[i]);
      if (line == capture::kNoPair) continue;
      const auto [other, isNew] = seen.emplace(line, &pictures_[i]);
      if (!isNew)
        throw InputError(capture_.folder.string(), pictures_[i].name,
                         "has the same id as '" + other->second->name + "': which of them a pose is of is not known");
      pairs[i] = line;
    }
    if (std::all_of(pairs.begin(), pairs.end(), [](std::size_t p) { return p == capture::kNoPair; }))
      refuseToPair("has no pose whose id is the name of an image, with or without its ending (the first image is " +
                   io::quoted(pictures_.front().name) + ", the first id " + io::quoted(poses_.front().id) + ")");
    return pairs;
  }

  std::vector<std::size_t> sameTime() const {
    std::vector<double> times, others;
    for (const PoseLine& p : poses_) {
      if (!p.time) refuseToPair("id " + io::quoted(p.id) + ": has no time: the poses of a video are paired by time");
      others.push_back(*p.time);
    }
    for (const Picture& p : pictures_) {
      if (!p.time)
        refuseToPair("pairs its poses by time, but the name of the image " + io::quoted(p.name) +
                     " is no time in seconds: rename the images, or write JSON lines with their names as ids");
      times.push_back(*p.time);
    }
    const std::vector<std::size_t> pairs = capture::timePairs(times, others);
    if (std::all_of(pairs.begin(), pairs.end(), [](std::size_t p) { return p == capture::kNoPair; }))
      refuseToPair("has no pose within 20 ms of any " + std::string(isVideo_ ? "picture" : "image") +
                   formatted(" (the first %s is of %.6f s, the first pose of %.6f s)", isVideo_ ? "picture" : "image",
                             times.front(), others.front()));
    return pairs;
  }

  /// Offers the order where it could be right, and then only.
  [[noreturn]] void refuseToPair(const std::string& reason) const {
    if (poses_.size() != pictures_.size()) throw InputError(poseFile(), "", reason);
    throw UndecidedInput(poseFile(),
                         reason + "; there are as many poses as " + (isVideo_ ? "pictures" : "images") +
                             ": --poses-by order pairs them in their order",
                         UndecidedInput::Question::PosesBy, {{"order", "Pair them in their order"}});
  }

  void addViews(const std::vector<std::size_t>& pose, const std::optional<std::array<int, 2>>& size) {
    capture::ImageSizes sizes;
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      if (pose[i] == capture::kNoPair) continue;
      const Picture& picture = pictures_[i];
      const PoseLine& line = poses_[pose[i]];
      if (picture.time && line.time && !options_.posesByOrder)
        farthest_ = std::max(farthest_, std::abs(*picture.time - *line.time));
      CaptureView view;
      view.name = picture.name;
      view.image = picture.file;
      view.ofVideo = picture.ofVideo;
      view.camera = cameraOf(line, size ? *size : sizes.of(picture.file, capture_.folder.string(), picture.name), picture);
      view.camera.camFromWorld = line.cameraFromWorld;
      view.worldFromObject = line.worldFromObject.value_or(view.worldFromObject);
      capture_.views.push_back(std::move(view));
    }
  }

  Camera cameraOf(const PoseLine& line, const std::array<int, 2>& size, const Picture& picture) {
    if (line.camera) {
      ++ownCameras_;
      if (line.camera->width != size[0] || line.camera->height != size[1])
        throw InputError(poseFile(), "id " + io::quoted(line.id),
                         formatted("its camera has %d x %d pixels, '%s' %d x %d", line.camera->width, line.camera->height,
                                   picture.name.c_str(), size[0], size[1]));
      return *line.camera;
    }
    if (!options_.camera)
      throw UndecidedInput(poseFile(),
                           "says no intrinsics of '" + picture.name + "'; name them by --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3]" +
                               hintOf(picture, size),
                           UndecidedInput::Question::Camera, {});
    if (!size_) {
      size_ = size;
      sizeOf_ = picture.name;
    }
    if (size != *size_)
      throw InputError(picture.file.string(), "",
                       formatted("is %d x %d pixels, '%s' is %d x %d: --camera is one for all", size[0], size[1], sizeOf_.c_str(),
                                 (*size_)[0], (*size_)[1]));
    const Eigen::Matrix3d& k = options_.camera->pixelFromRay;
    return capture::cameraOf(size[0], size[1], k(0, 0), k(1, 1), k(0, 2), k(1, 2), options_.camera->lens, poseFile(), "--camera");
  }

  /// What EXIF says, for a person to take or not: it is never used unasked.
  static std::string hintOf(const Picture& picture, const std::array<int, 2>& size) {
    if (picture.ofVideo) return "";
    try {
      const std::optional<double> mm = focalLength35mm(readFile(picture.file, Limit::ImageMegabytes));
      if (!mm) return "";
      const Eigen::Matrix3d k = filmCamera(*mm, size[0], size[1]).pixelFromRay;
      return formatted(" (EXIF: %g mm on 35 mm film, about --camera %.0f,%.0f,%g,%g without distortion)", *mm, k(0, 0), k(1, 1),
                       k(0, 2), k(1, 2));
    } catch (const InputError&) {
      return "";  // reading the picture reports it
    }
  }

  void report() {
    const std::size_t n = capture_.views.size();
    const std::string poses = options_.poses.filename().string();
    capture_.facts.push_back((isVideo_ ? "video: " : "folder of images: ") + what(pictures_.size()) + ", " +
                             capture::counted(poses_.size(), "pose", "poses") + " in " + poses);
    const std::string lines = byId_ ? "world to camera, as JSON lines" : "camera to world, quaternion w last, as TUM lines";
    std::string paired = " took the pose of its name";
    if (options_.posesByOrder) paired = " took the pose at its place in the order (--poses-by order)";
    if (!options_.posesByOrder && (isVideo_ || !byId_))
      paired = formatted(" took the pose nearest in time (%.1f ms at most), each pose once", 1e3 * farthest_);
    capture_.facts.push_back("poses are " + lines + "; each " + (isVideo_ ? "picture" : "image") + paired);
    capture_.facts.push_back(ownCameras_ == 0   ? "intrinsics are those of --camera"
                             : ownCameras_ == n ? "intrinsics are those of the poses' lines"
                                                : "intrinsics are those of " + std::to_string(ownCameras_) +
                                                      " of the poses' lines, else those of --camera");
    // People usually mean a few pictures of a video, but all of a folder.
    if (const std::size_t out = pictures_.size() - n; out > 0)
      (isVideo_ ? capture_.facts : capture_.warnings)
          .push_back(what(out) + " of " + std::to_string(pictures_.size()) + (out == 1 ? " has" : " have") + " no pose and " +
                     (out == 1 ? "is" : "are") + " left out");
    if (const std::size_t out = poses_.size() - n; out > 0)
      capture_.warnings.push_back(poses + ": " + capture::counted(out, "pose is", "poses are") + " of no " +
                                  (isVideo_ ? "picture" : "image"));
  }

  const CaptureOptions& options_;
  Capture capture_;
  std::vector<Picture> pictures_;
  std::vector<PoseLine> poses_;
  bool isVideo_, byId_ = false;
  std::size_t ownCameras_ = 0;
  double farthest_ = 0;  // s
  std::optional<std::array<int, 2>> size_;
  std::string sizeOf_;
};

Capture startOf(const std::string& kind, const fs::path& file, const CaptureOptions& options) {
  Capture capture;
  capture.kind = kind;
  capture.file = fs::absolute(file).lexically_normal();
  if (options.poses.empty())
    throw UndecidedInput(file.string(),
                         kind == "video" ? "is a video; --poses FILE names the poses of its pictures"
                                         : "is an image of a folder; --poses FILE names the poses of the images",
                         UndecidedInput::Question::Poses, {});
  return capture;
}

class ImagesReader : public CaptureReader {
 public:
  std::string name() const override { return "images"; }
  std::string describe() const override { return "folder of images with --poses"; }
  fs::path recognise(const fs::path& input) const override {
    std::error_code ignored;  // unreadable counts as missing
    if (!fs::is_directory(input, ignored))
      return looksLikeImageName(input) && fs::is_regular_file(input, ignored) ? input : fs::path();
    const std::vector<fs::path> images = filesIn(input, looksLikeImageName);
    return images.empty() ? fs::path() : images.front();
  }
  Capture read(const fs::path& file, const CaptureOptions& options) const override {
    Capture capture = startOf(name(), file, options);
    std::vector<Picture> pictures;
    for (const fs::path& image : filesIn(capture.file.parent_path(), looksLikeImageName)) {
      Picture p{image.filename().string(), image.stem().string(), {}, image, {}};
      const std::optional<double> time = io::numberOf(p.id);
      if (time && std::isfinite(*time)) p.time = capture::secondsOf(*time);
      pictures.push_back(std::move(p));
    }
    if (pictures.empty()) throw InputError(file.string(), "", "is no image of a folder");
    return PosedPictures(std::move(capture), std::move(pictures), options).read({});
  }
};

class VideoReader : public CaptureReader {
 public:
  std::string name() const override { return "video"; }
  std::string describe() const override { return "video with --poses"; }
  fs::path recognise(const fs::path& input) const override {
    std::error_code ignored;  // unreadable counts as missing
    if (!fs::is_directory(input, ignored)) return looksLikeVideo(input) ? input : fs::path();
    const std::vector<fs::path> videos = filesIn(input, looksLikeVideo);
    return videos.size() == 1 ? videos.front() : fs::path();
  }
  Capture read(const fs::path& file, const CaptureOptions& options) const override {
    Capture capture = startOf(name(), file, options);
    const VideoContent content = readVideoContent(capture.file);
    std::vector<Picture> pictures;
    for (std::size_t i = 0; i < content.seconds.size(); ++i) {
      const VideoPicture which{static_cast<int>(i), content.seconds[i]};
      pictures.push_back({formatted("%06zu", i), "", content.seconds[i], capture.file, which});
    }
    if (content.withoutTime > 0)
      capture.facts.push_back(std::to_string(content.withoutTime) +
                              " of the video's pictures have no time of their own: each is one period after the one before");
    capture.facts.push_back(
        formatted("the video's pictures are %d x %d pixels, as a player shows them", content.width, content.height) +
        (content.rotation ? formatted(": the file's rotation tag turns the stored ones by %d degrees clockwise", content.rotation)
                          : std::string()));
    return PosedPictures(std::move(capture), std::move(pictures), options)
        .read(std::array<int, 2>{content.width, content.height});
  }
};

}  // namespace

std::unique_ptr<const CaptureReader> makeImagesReader() { return std::make_unique<const ImagesReader>(); }
std::unique_ptr<const CaptureReader> makeVideoReader() { return std::make_unique<const VideoReader>(); }

}  // namespace glint
