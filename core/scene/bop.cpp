// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/number_text.h"
#include "core/geometry/transforms.h"
#include "core/scene/capture.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/capture_image_sizes.h"
#include "core/scene/capture_parts.h"
#include "core/scene/text_rows.h"
#include "io/text_scan.h"

// One scene of a data set in the format of BOP (Hodan et al., BOP: Benchmark for 6D Object Pose Estimation, ECCV 2018), as its
// toolkit describes it: SET/SPLIT/SCENE with scene_camera.json (cam_K row by row, depth_scale: millimetres per unit, perhaps
// cam_R_w2c and cam_t_w2c) and scene_gt.json (for each object of an image obj_id, cam_R_m2c and cam_t_m2c). Millimetres, axes
// of OpenCV.
//
// Where (0, 0) lies the format does not say beyond "as OpenCV". The toolkit turns depth into distances with the whole numbers
// of the pixels as coordinates (misc.depth_im_to_dist_im), so it is the centre of the first pixel, as here. Its OpenGL renderer
// takes the corner all the same, and users found the rendered `train_pbr` sets half a pixel off (SurfEmb, issue 15): those are
// warned of.

namespace glint {
namespace {
namespace fs = std::filesystem;

constexpr const char* kBopCameras = "scene_camera.json";
constexpr const char* kBopPoses = "scene_gt.json";
constexpr double kBopMillimetre = 0.001;     // m
constexpr double kBopStillMm = 1.0;          // what a calibrated camera rig measures repeatedly
constexpr double kBopStillDegrees = 0.1;     // 1 mm seen over an object of half a metre
constexpr std::size_t kBopMostNumbers = 64;  // of objects in one line: the largest sets have 33

/// The object in one image.
struct BopImage {
  int id = 0;
  std::size_t entry = 0;  ///< of the object in the image's list: its masks are named by it
  JsonNode pose, camera;
};

/// "000003": as the format numbers images, entries and objects.
std::string bopNumber(std::size_t n) { return formatted("%06zu", n); }

/// "1, 5, 8"
std::string bopList(const std::set<int>& numbers) {
  std::string text;
  std::size_t n = 0;
  for (const int number : numbers) {
    if (n++ == kBopMostNumbers) return text + ", ... (" + std::to_string(numbers.size()) + " in all)";
    text += (text.empty() ? "" : ", ") + std::to_string(number);
  }
  return text;
}

std::optional<int> bopId(const std::string& key) {
  constexpr std::size_t kDigits = 9;  // below 2^31
  if (key.empty() || key.size() > kDigits || key.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return int(*io::integerOf(key));
}

/// The images of a file, by their numbers.
std::map<int, JsonNode> bopImages(const JsonNode& root) {
  std::map<int, JsonNode> images;
  for (const std::string& key : root.keys()) {
    const JsonNode node = root.at(key);
    const std::optional<int> id = bopId(key);
    if (!id) node.fail("is not the number of an image");
    if (!images.emplace(*id, node).second) node.fail("image " + std::to_string(*id) + " is in the file twice");
  }
  return images;
}

/// Row by row.
Eigen::Matrix3d bopMatrix(const JsonNode& node, double most) {
  const std::vector<double> v = boundedAll(node, most).numbers();
  if (v.size() != 9) node.fail("must have 9 numbers, has " + std::to_string(v.size()));
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
}

/// Camera from model or world, mm. As typedPose; where a rotation was repaired, `odd` says so.
Eigen::Isometry3d bopPose(const JsonNode& rotation, const JsonNode& translation, std::vector<std::string>& odd) {
  const TypedPose typed = typedPose(bopMatrix(rotation, kLargestFactor), lengths3(translation));
  if (typed.rotation == TypedRotation::NotARotation) rotation.fail("is not a rotation");
  if (typed.rotation == TypedRotation::Mirrored) rotation.fail("is mirrored (determinant -1)");
  if (typed.rotation == TypedRotation::Repaired)
    odd.push_back(rotation.place() + ": not exactly a rotation, replaced by the nearest one");
  return typed.pose;
}

double bopDepthScale(const JsonNode& camera) {
  const std::optional<JsonNode> scale = camera.find("depth_scale");
  return kBopMillimetre * (scale ? positive(*scale, kLargestFactor) : 1.0);
}

/// cam_K with the size of the image, without pose.
Camera bopCamera(const JsonNode& node, const std::array<int, 2>& size) {
  const JsonNode kNode = node.at("cam_K");
  const Eigen::Matrix3d k = bopMatrix(kNode, kFarthestPx);
  if (k(1, 0) != 0) kNode.fail("its fourth number must be 0 (row by row: fx s cx 0 fy cy 0 0 1)");
  if (k.row(2) != Eigen::RowVector3d(0, 0, 1))
    kNode.fail("its last three numbers must be 0 0 1 (row by row: fx s cx 0 fy cy 0 0 1)");
  Camera camera = capture::cameraOf(size[0], size[1], k(0, 0), k(1, 1), k(0, 2), k(1, 2), Lens{}, kNode.file(), kNode.place());
  camera.pixelFromRay(0, 1) = k(0, 1);
  return camera;
}

/// How far an object moves in the world, against where it is in the first image that says where its camera is.
class BopMotion {
 public:
  /// @param camFromModel  of the image's object  @param camFromWorld  where the file says it
  void add(const Eigen::Isometry3d& camFromModel, const std::optional<Eigen::Isometry3d>& camFromWorld,
           const std::string& image) {
    cameras_.push_back(camFromWorld);
    if (!camFromWorld) return;
    const Eigen::Isometry3d worldFromModel = camFromWorld->inverse() * camFromModel;
    if (images_++ == 0) {
      first_ = worldFromModel;
      firstImage_ = image;
      return;
    }
    constexpr double kDegrees = 180 / 3.14159265358979323846;
    const Eigen::Quaterniond turn(first_.linear().transpose() * worldFromModel.linear());
    const double degrees = kDegrees * 2 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
    degrees_ = std::max(degrees_, degrees);
    mm_ = std::max(mm_, (worldFromModel.translation() - first_.translation()).norm());
  }

  /// Says what it found. Where the object moves and every camera's place is known, the cameras' world becomes that of the views,
  /// and each view says where the object stands; else the object stays the world.
  void apply(Capture& capture) const {
    const std::string far = formatted("%.3g mm and %.3g degrees", mm_, degrees_);
    if (images_ < 2)
      capture.facts.push_back(
          "whether the object stands still is not known: the cameras' places in the world (cam_R_w2c) are not given");
    else if (mm_ > kBopStillMm || degrees_ > kBopStillDegrees)
      move(capture, "the object moves: up to " + far + " from where it is in " + firstImage_);
    else
      capture.facts.push_back("the object stands still in the world: within " + far + " over " + std::to_string(images_) +
                              " images");
  }

 private:
  void move(Capture& capture, const std::string& words) const {
    if (std::any_of(cameras_.begin(), cameras_.end(), [](const auto& camera) { return !camera; })) {
      capture.warnings.push_back(words +
                                 "; images without cam_R_w2c say no place in the world, so that the object is taken as the "
                                 "world: lamps that stand still do not stand still relative to it");
      return;
    }
    for (std::size_t i = 0; i < capture.views.size(); ++i) {
      CaptureView& view = capture.views[i];
      view.worldFromObject = cameras_[i]->inverse() * view.camera.camFromWorld;
      view.camera.camFromWorld = *cameras_[i];
    }
    capture.facts.push_back(words + "; each image says where it stands (cam_R_w2c)");
  }

  std::vector<std::optional<Eigen::Isometry3d>> cameras_;  // of each view, world to camera
  Eigen::Isometry3d first_ = Eigen::Isometry3d::Identity();
  std::string firstImage_;
  std::size_t images_ = 0;
  double mm_ = 0, degrees_ = 0;
};

/// What `read` does, step by step.
class BopReading {
 public:
  BopReading(const fs::path& file, const CaptureOptions& options)
      : options_(options), names_(options.rights, options.photographs) {
    capture_.kind = "bop";
    capture_.file = fs::absolute(file).lexically_normal();
    capture_.folder = capture_.file.parent_path();
    capture_.sources = {capture_.file, capture_.folder / kBopPoses};
    capture_.metresPerUnit = kBopMillimetre;
    capture_.hasScale = true;
  }

  Capture read() {
    const fs::path poseFile = resolveInside(capture_.folder, kBopPoses, options_.rights, capture_.file.string(), kBopPoses);
    const JsonNode cameras = JsonNode::parse(readFile(capture_.file, Limit::JsonMegabytes), capture_.file.string());
    const JsonNode poses = JsonNode::parse(readFile(poseFile, Limit::JsonMegabytes), poseFile.string());
    const std::vector<BopImage> images = imagesOfObject(bopImages(cameras), bopImages(poses));
    for (const BopImage& image : images) addView(image);
    if (capture_.views.empty()) throw InputError(poseFile.string(), "", "has no finite pose of the object");
    capture::addFew(capture_.warnings, odd_);
    lost_.tell(kBopPoses, capture::kNoFinitePose, capture_.warnings);
    names_.tell(capture_.warnings);
    findMesh();
    report();
    return std::move(capture_);
  }

 private:
  /// Numbers of objects that any image shows.
  static std::set<int> objectsIn(const std::map<int, JsonNode>& poses) {
    std::set<int> objects;
    for (const auto& [id, list] : poses)
      for (std::size_t i = 0; i < list.size(); ++i) {
        const JsonNode number = list.at(i).at("obj_id");
        if (number.integer() < 0) number.fail("must not be negative");
        objects.insert(number.integer());
      }
    return objects;
  }

  void chooseObject(const std::set<int>& objects, const std::string& poseFile) {
    if (objects.empty()) throw InputError(poseFile, "", "names no object");
    if (options_.object.empty()) {
      if (objects.size() > 1) {
        std::vector<UndecidedInput::Answer> answers;
        for (const int object : objects) answers.push_back({std::to_string(object), "object " + std::to_string(object)});
        throw UndecidedInput(poseFile, "names several objects (" + bopList(objects) + "); choose one by --object",
                             UndecidedInput::Question::Object, std::move(answers));
      }
      object_ = *objects.begin();
      return;
    }
    const std::size_t colon = std::min(options_.object.find(':'), options_.object.size());
    const std::optional<int> chosen = bopId(options_.object.substr(0, colon));
    if (const auto nth = bopId(options_.object.substr(std::min(colon + 1, options_.object.size()))); nth && *nth >= 0)
      instance_ = std::size_t(*nth);
    else if (colon < options_.object.size())
      throw InputError(poseFile, "--object",
                       io::quoted(options_.object) + " is not OBJECT:N, the N-th one of the object in each image, from 0");
    if (!chosen || !objects.count(*chosen))
      throw InputError(
          poseFile, "--object",
          io::quoted(options_.object) + " is not the number of an object of this scene, which has " + bopList(objects));
    object_ = *chosen;
  }

  /// Which of several that are alike: the files number them in each image anew.
  [[noreturn]] void askInstance(std::size_t most, const std::string& poseFile) const {
    std::vector<UndecidedInput::Answer> answers;
    for (std::size_t i = 0; i < std::min(most, kBopMostNumbers); ++i) {
      const std::string n = std::to_string(i);
      answers.push_back(
          {std::to_string(object_) + ":" + n, "number " + n + " of object " + std::to_string(object_) + " in each image"});
    }
    throw UndecidedInput(poseFile,
                         "an image shows object " + std::to_string(object_) + " " + std::to_string(most) +
                             " times; choose one by --object " + std::to_string(object_) +
                             ":N, the N-th in each image from 0 (whether that is the same one throughout, the files do not say)",
                         UndecidedInput::Question::Object, std::move(answers));
  }

  std::vector<BopImage> imagesOfObject(const std::map<int, JsonNode>& cameras, const std::map<int, JsonNode>& poses) {
    const std::string poseFile = (capture_.folder / kBopPoses).string();
    chooseObject(objectsIn(poses), poseFile);
    std::vector<BopImage> images;
    std::size_t most = 0;  // entries of the object in an image
    for (const auto& [id, list] : poses) {
      std::vector<std::size_t> entries;
      for (std::size_t i = 0; i < list.size(); ++i)
        if (list.at(i).at("obj_id").integer() == object_) entries.push_back(i);
      if (entries.empty()) continue;
      most = std::max(most, entries.size());
      if (instance_.value_or(0) >= entries.size()) continue;
      const std::size_t entry = entries[instance_.value_or(0)];
      const auto camera = cameras.find(id);
      if (camera == cameras.end()) list.fail(std::string("has no camera in ") + kBopCameras);
      images.push_back({id, entry, list.at(entry), camera->second});
    }
    if (most > 1 && !instance_) askInstance(most, poseFile);
    if (images.empty())
      throw InputError(poseFile, "--object",
                       io::quoted(options_.object) + ": no image shows the object more than " + std::to_string(most) + " times");
    std::set<int> all;
    for (const auto& [id, node] : cameras) all.insert(id);
    for (const auto& [id, node] : poses) all.insert(id);
    leftOut_ = all.size() - images.size();
    return images;
  }

  /// The file of this name without ending, with the first ending that exists; "" = none.
  fs::path existing(const std::string& name, const std::vector<std::string>& endings, const std::string& place) {
    std::error_code ignored;  // unreadable counts as missing
    for (const std::string& ending : endings) {
      const fs::path file = names_.other(capture_.folder, name + ending, capture_.file.string(), place);
      if (fs::is_regular_file(file, ignored)) return file;
    }
    return {};
  }

  /// Colour before grey; the ending that the image before had is tried first.
  fs::path photograph(const std::string& number, const std::string& place) {
    static const std::vector<std::string> kNames{"rgb/#.png",  "rgb/#.jpg",  "rgb/#.jpeg", "rgb/#.tif",  "rgb/#.tiff",
                                                 "gray/#.png", "gray/#.jpg", "gray/#.tif", "gray/#.tiff"};
    std::error_code ignored;  // unreadable counts as missing
    const auto at = [&](const std::string& pattern) {
      std::string name = pattern;
      return names_.image(name.replace(name.find('#'), 1, number), {capture_.folder}, capture_.file.string(), place);
    };
    if (!lastName_.empty())
      if (const fs::path file = at(lastName_); fs::is_regular_file(file, ignored)) return file;
    for (const std::string& pattern : kNames)
      if (const fs::path file = at(pattern); fs::is_regular_file(file, ignored)) {
        lastName_ = pattern;
        return file;
      }
    return at(lastName_.empty() ? kNames.front() : lastName_);
  }

  void addView(const BopImage& image) {
    const std::string number = bopNumber(std::size_t(image.id)), place = image.camera.place();
    if (capture::isLostPose(image.pose.at("cam_R_m2c")) || capture::isLostPose(image.pose.at("cam_t_m2c"))) {
      lost_.add(image.pose.place());
      return;
    }
    CaptureView view;
    view.image = photograph(number, place);
    view.name = number + view.image.extension().string();
    view.depth = existing("depth/" + number, {".png", ".tif", ".tiff"}, place);
    view.mask = existing("mask_visib/" + number + "_" + bopNumber(image.entry), {".png"}, place);
    view.depthScale = bopDepthScale(image.camera);
    view.camera = bopCamera(image.camera, sizes_.of(view.image, capture_.file.string(), place));
    view.camera.camFromWorld = bopPose(image.pose.at("cam_R_m2c"), image.pose.at("cam_t_m2c"), odd_);
    const auto isKnown = [&](const char* key) { return image.camera.has(key) && !capture::isLostPose(image.camera.at(key)); };
    std::optional<Eigen::Isometry3d> camFromWorld;
    if (isKnown("cam_R_w2c") || isKnown("cam_t_w2c"))
      camFromWorld = bopPose(image.camera.at("cam_R_w2c"), image.camera.at("cam_t_w2c"), odd_);
    motion_.add(view.camera.camFromWorld, camFromWorld, view.name);
    capture_.views.push_back(std::move(view));
  }

  /// Looks in the folder `models` beside the split, else in the first `models*` by name.
  void findMesh() {
    const std::string name = "obj_" + bopNumber(std::size_t(object_)) + ".ply";
    const std::vector<fs::path> folders = capture::modelFoldersOfBop(capture_.file);
    std::vector<fs::path> found;
    std::error_code ignored;  // unreadable counts as missing
    for (const fs::path& folder : folders)
      if (const fs::path file = resolveInside(folder, name, options_.rights, capture_.file.string(), folder.filename().string());
          fs::is_regular_file(file, ignored))
        found.push_back(file);
    if (found.empty()) {
      capture_.facts.push_back("no models*/" + name + " beside the folder of the scenes: no mesh");
      return;
    }
    capture_.mesh = CaptureMesh{found.front(), kBopMillimetre};
    std::string others;
    for (std::size_t i = 1; i < found.size(); ++i) others += (i > 1 ? ", " : "") + found[i].parent_path().filename().string();
    capture_.facts.push_back("mesh: " + found.front().parent_path().filename().string() + "/" + name + ", millimetres" +
                             (others.empty() ? "" : " (also in " + others + ")"));
  }

  void report() {
    const std::size_t n = capture_.views.size();
    std::size_t depths = 0, masks = 0;
    double least = capture_.views.front().depthScale, most = least;
    for (const CaptureView& view : capture_.views) {
      depths += !view.depth.empty();
      masks += !view.mask.empty();
      least = std::min(least, view.depthScale);
      most = std::max(most, view.depthScale);
    }
    const std::string of = " of " + std::to_string(n) + (n == 1 ? " image" : " images");
    capture_.facts.insert(capture_.facts.begin(),
                          {"BOP scene: object " + std::to_string(object_) + " in " + std::to_string(n) + " of " +
                               std::to_string(n + leftOut_) + " images; its frame is the world, in millimetres",
                           "cam_K is read with (0, 0) at the centre of the first pixel"});
    std::string scale = formatted("%.6g", least / kBopMillimetre);
    if (most > least) scale += " .. " + formatted("%.6g", most / kBopMillimetre);
    capture_.facts.push_back("depth: " + std::to_string(depths) + of + ", " + scale +
                             " mm per unit; masks of what is visible: " + std::to_string(masks) + of);
    motion_.apply(capture_);
    if (leftOut_ > 0)
      capture_.warnings.push_back(std::to_string(leftOut_) + (leftOut_ == 1 ? " image does" : " images do") +
                                  " not show object " + std::to_string(object_) + " and " + (leftOut_ == 1 ? "is" : "are") +
                                  " left out");
    if (capture_.folder.parent_path().filename().string().find("pbr") != std::string::npos)
      capture_.warnings.push_back("rendered sets of BOP (" + capture_.folder.parent_path().filename().string() +
                                  ") may count pixels from the corner of the first one: contours may be half a pixel off");
  }

  const CaptureOptions& options_;
  capture::FileNames names_;
  capture::PassedOver lost_;
  Capture capture_;
  int object_ = 0;
  std::optional<std::size_t> instance_;  ///< from 0; nothing = the only one of the object in each image
  std::size_t leftOut_ = 0;
  std::string lastName_;  ///< pattern of the photograph that was found last
  capture::ImageSizes sizes_;
  BopMotion motion_;
  std::vector<std::string> odd_;  ///< about rotations
};

/// Whether a file begins with an image's camera: cheap, and enough to tell it from other JSON.
bool looksLikeBopCameras(const fs::path& file) {
  constexpr std::size_t kStart = 4096;  // bytes: the first image has 300
  const std::string start = firstBytes(file, kStart);
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  return first != std::string::npos && start[first] == '{' && start.find("\"cam_K\"") != std::string::npos;
}

class BopReader : public CaptureReader {
 public:
  std::string name() const override { return "bop"; }
  std::string describe() const override { return "BOP scene (scene_camera.json, scene_gt.json)"; }

  fs::path recognise(const fs::path& input) const override {
    try {
      std::error_code ignored;  // unreadable counts as missing
      const fs::path folder = fs::is_directory(input, ignored) ? input : input.parent_path();
      if (folder != input && input.filename() != kBopCameras && input.filename() != kBopPoses) return {};
      if (!looksLikeBopCameras(folder / kBopCameras) || !fs::is_regular_file(folder / kBopPoses, ignored)) return {};
      return folder / kBopCameras;
    } catch (const std::exception&) {  // no memory, a path that the system refuses: not recognised
      return {};
    }
  }

  Capture read(const fs::path& file, const CaptureOptions& options) const override { return BopReading(file, options).read(); }
};

}  // namespace

std::unique_ptr<const CaptureReader> makeBopReader() { return std::make_unique<const BopReader>(); }

}  // namespace glint
