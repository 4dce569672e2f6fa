// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/number_text.h"
#include "core/geometry/camera_json.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/capture_image_sizes.h"
#include "core/scene/capture_parts.h"
#include "io/cloud_reader.h"

// transforms.json of nerfstudio, with what instant-ngp and the original NeRF data have besides.
// https://docs.nerf.studio/quickstart/data_conventions.html

namespace glint {
namespace fs = std::filesystem;
namespace {

// ---- Keys -------------------------------------------------------------------------------------------------------------------

const std::vector<std::string> kNerfTerms = {"k1", "k2", "k3", "k4", "p1", "p2"};

std::set<std::string> nerfWords(const char* text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Keys of the camera, at the top of the file or in a frame.
const std::set<std::string> kNerfCameraKeys =
    nerfWords("camera_model is_fisheye w h fl_x fl_y cx cy camera_angle_x camera_angle_y x_fov y_fov k1 k2 k3 k4 p1 p2");
/// The rest that is read, or that says nothing about the cameras as they are stored: the split of the frames, and how a program
/// shows, samples or places the scene for itself.
const std::set<std::string> kNerfTopKeys = nerfWords(
    "frames applied_transform applied_scale ply_file_path depth_unit_scale_factor integer_depth_scale "
    "train_filenames val_filenames test_filenames orientation_override fisheye_crop_radius "
    "aabb_scale aabb render_aabb scale offset up envmap n_frames sharpen sharpness_discard_threshold white_transparent "
    "black_transparent fix_premult importance_sampling n_extra_learnable_dims enable_depth_loading enable_ray_loading");
const std::set<std::string> kNerfFrameKeys =
    nerfWords("file_path transform_matrix depth_file_path depth_path mask_path colmap_im_id sharpness rotation time timestamp");

/// They change what a camera sees: to go on without them would answer for another scene.
const std::set<std::string> kNerfRefused = nerfWords(
    "distortion_params k5 k6 s1 s2 s3 s4 skew omega rolling_shutter ftheta_p0 ftheta_p1 ftheta_p2 ftheta_p3 ftheta_p4 latlong "
    "equirectangular from_na normal_mts_args intrinsic_matrix intrinsics transform_matrix_start transform_matrix_end");

/// 0, false, null, a list of such: a program's default, written out.
bool nerfSaysNothing(const JsonNode& node) {
  if (node.isNull()) return true;
  if (node.isBoolean()) return !node.boolean();
  if (node.isNumber()) return node.number() == 0;
  if (!node.isArray()) return false;
  for (std::size_t i = 0; i < node.size(); ++i)
    if (!nerfSaysNothing(node.at(i))) return false;
  return true;
}

/// How often something was met, and where first.
struct NerfCount {
  int number = 0;
  std::string first;
  void add(const std::string& place) {
    if (number++ == 0) first = place;
  }
  /// "frames[3].x", "frames[3].x and 4 more"
  std::string text() const { return first + (number > 1 ? " and " + std::to_string(number - 1) + " more" : ""); }
};

/// What the frames had, for the report.
struct NerfTally {
  NerfCount rounded, otherAngle, arrays, ownKeys;
  capture::PassedOver lost, cut;
  std::map<std::string, NerfCount> unknown;
  std::set<std::string> models;
  int middles = 0, angles = 0, ownSizes = 0, depths = 0, floatDepths = 0, masks = 0;
  double depthScale = 0;  ///< of depths
};

void checkNerfKeys(const JsonNode& node, const std::set<std::string>& known, NerfTally& tally) {
  for (const std::string& key : node.keys()) {
    if (known.count(key) || kNerfCameraKeys.count(key)) continue;
    const JsonNode value = node.at(key);
    if (!kNerfRefused.count(key))
      tally.unknown[key].add(value.place());
    else if (!nerfSaysNothing(value))
      value.fail("is not supported and would change the geometry");
  }
}

// ---- World ------------------------------------------------------------------------------------------------------------------

/// stored = scale * rotation * original + translation
struct NerfWorld {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

/// 3x4 or 4x4.
Eigen::Matrix<double, 3, 4> readAppliedTransform(const JsonNode& node) {
  if (node.size() != 3 && node.size() != 4) node.fail("must have 3 or 4 rows of 4 numbers, has " + std::to_string(node.size()));
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  for (std::size_t i = 0; i < node.size(); ++i) {
    const std::vector<double> row = boundedAll(node.at(i), kLargestFactor).numbers();
    if (row.size() != 4) node.at(i).fail("must have 4 numbers, has " + std::to_string(row.size()));
    m.row(Eigen::Index(i)) = Eigen::RowVector4d::Map(row.data());
  }
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) node.fail("the last row must be 0 0 0 1");
  return m.topRows<3>();
}

/// The world that the file was made from: `A` of applied_transform, then the factor of applied_scale.
NerfWorld readOriginalWorld(const JsonNode& root, double appliedScale, std::vector<std::string>& warnings) {
  constexpr double kShear = 1e-3, kRounded = 1e-6;  // as for a pose: beyond, something else was meant; below, single precision
  const std::optional<JsonNode> node = root.find("applied_transform");
  if (!node && !root.has("applied_scale"))
    throw InputError(root.file(), "applied_transform",
                     "is missing, and so is applied_scale: --world original has nothing to undo");
  NerfWorld world;
  world.scale = appliedScale;
  if (!node) return world;
  const Eigen::Matrix<double, 3, 4> applied = readAppliedTransform(*node);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(applied.leftCols<3>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d s = svd.singularValues();
  if (!(s[0] - s[2] <= kShear * s[2]) || !(s[2] > 0))
    node->fail("shears or flattens: --world original undoes a rotation with a scale and a shift only");
  world.rotation = svd.matrixU() * svd.matrixV().transpose();
  if (world.rotation.determinant() < 0)
    node->fail("mirrors (determinant -1): --world original undoes a rotation with a scale and a shift only");
  if (s[0] - s[2] > kRounded * s[2])
    warnings.push_back(node->place() + ": not exactly a rotation with a scale, replaced by the nearest one");
  world.scale = appliedScale * s.mean();
  world.translation = appliedScale * applied.col(3);
  return world;
}

// ---- Camera -----------------------------------------------------------------------------------------------------------------

/// The keys of one camera: in its frame, or for all frames.
struct NerfKeys {
  const JsonNode& root;
  const JsonNode& frame;

  std::optional<JsonNode> find(const std::string& key) const {
    const std::optional<JsonNode> own = frame.find(key);
    return own ? own : root.find(key);
  }
  /// The keys that the frame says otherwise than the top of the file.
  void tellDifferences(NerfCount& count) const {
    for (const std::string& key : kNerfCameraKeys) {
      const std::optional<JsonNode> own = frame.find(key), shared = root.find(key);
      if (own && shared && own->dump() != shared->dump()) count.add(own->place());
    }
  }
  std::string place(const char* key) const { return frame.place() + "." + key; }
};

/// A camera_model and the terms that it has, in the order of our lens.
struct NerfModel {
  std::string name;
  LensModel lens;
  std::vector<std::string> terms;
};
const std::vector<NerfModel> kNerfModels = {{"SIMPLE_PINHOLE", LensModel::OpenCv, {}},
                                            {"PINHOLE", LensModel::OpenCv, {}},
                                            {"SIMPLE_RADIAL", LensModel::SimpleRadial, {"k1"}},
                                            {"RADIAL", LensModel::Radial, {"k1", "k2"}},
                                            {"OPENCV", LensModel::OpenCv, {"k1", "k2", "p1", "p2", "k3"}},
                                            {"OPENCV_FISHEYE", LensModel::OpenCvFisheye, {"k1", "k2", "k3", "k4"}}};

const NerfModel* nerfModelNamed(const std::string& name) {
  const auto found = std::find_if(kNerfModels.begin(), kNerfModels.end(), [&](const NerfModel& m) { return m.name == name; });
  return found == kNerfModels.end() ? nullptr : &*found;
}

/// What camera_model says, else instant-ngp's is_fisheye, else OPENCV.
const NerfModel& nerfModelOf(const NerfKeys& keys) {
  const std::optional<JsonNode> named = keys.find("camera_model"), flag = keys.find("is_fisheye");
  const bool fisheye = flag && (flag->isNumber() ? flag->number() != 0 : flag->boolean());
  if (named) {
    const NerfModel* model = nerfModelNamed(named->text());
    if (!model)
      named->fail("'" + named->text() +
                  "' is not supported; SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV and OPENCV_FISHEYE are");
    if (flag && fisheye != (model->lens == LensModel::OpenCvFisheye)) flag->fail("contradicts the camera_model " + model->name);
    return *model;
  }
  if (!fisheye) return *nerfModelNamed("OPENCV");
  // Without terms instant-ngp takes such a camera for a pinhole, although it is called a fisheye.
  const bool anyTerm = std::any_of(kNerfTerms.begin(), kNerfTerms.end(), [&](const std::string& key) {
    const std::optional<JsonNode> n = keys.find(key);
    return n && n->number() != 0;
  });
  if (!anyTerm) flag->fail("is true, but k1 .. k4 are 0: name the camera_model, OPENCV_FISHEYE or PINHOLE");
  return *nerfModelNamed("OPENCV_FISHEYE");
}

Lens nerfLens(const NerfKeys& keys, const NerfModel& model) {
  Lens lens;
  lens.model = model.lens;
  for (const std::string& key : kNerfTerms) {
    const std::optional<JsonNode> node = keys.find(key);
    if (!node) continue;
    const double value = bounded(*node, kLargestFactor);
    const auto term = std::find(model.terms.begin(), model.terms.end(), key);
    if (term != model.terms.end())
      lens.parameters[std::size_t(term - model.terms.begin())] = value;
    else if (value != 0)
      node->fail("is not 0, but " + model.name + " has no " + key + " here");
  }
  return lens;
}

/// The size by w and h, or by the image if one is missing.
std::array<int, 2> nerfSize(const NerfKeys& keys, const fs::path& image, capture::ImageSizes& sizes, NerfTally& tally) {
  const std::optional<JsonNode> w = keys.find("w"), h = keys.find("h");
  if (w && h) return {w->integer(), h->integer()};
  const std::array<int, 2> size = sizes.of(image, keys.frame.file(), keys.frame.place());
  const auto check = [](const std::optional<JsonNode>& node, int expected) {
    if (node && node->integer() != expected) node->fail("differs from the size of the image, " + std::to_string(expected));
  };
  check(w, size[0]);
  check(h, size[1]);
  ++tally.ownSizes;
  return size;
}

/// Focal length along x or y from the angle across the image: size / 2 = f tan(angle / 2). Nothing without such an angle.
std::optional<double> nerfFocalOfAngle(const NerfKeys& keys, char axis, int sizePx) {
  std::optional<JsonNode> node = keys.find(std::string("camera_angle_") + axis);
  double unit = 1;
  if (!node) {
    node = keys.find(std::string(1, axis) + "_fov");
    unit = std::numbers::pi / 180;  // instant-ngp's: degrees
  }
  if (!node) return std::nullopt;
  const double angle = node->number() * unit;
  if (!(angle > 0) || !(angle < std::numbers::pi)) node->fail("must be an angle between 0 and 180 degrees");
  return 0.5 * sizePx / std::tan(0.5 * angle);
}

/// fl_x (fl_y), else from the angle; nothing if there is neither.
std::optional<double> nerfFocal(const NerfKeys& keys, char axis, int sizePx, const NerfModel& model, NerfTally& tally) {
  constexpr double kOther = 0.01;  // relative: more than rounding; the images were resized or cropped since
  const std::optional<double> ofAngle = nerfFocalOfAngle(keys, axis, sizePx);
  const std::optional<JsonNode> node = keys.find(std::string("fl_") + axis);
  const bool fisheye = model.lens == LensModel::OpenCvFisheye;
  if (node) {
    const double focal = positive(*node, kFarthestPx);
    if (ofAngle && !fisheye && !(std::abs(*ofAngle - focal) <= kOther * focal)) tally.otherAngle.add(keys.frame.place());
    return focal;
  }
  if (!ofAngle || (fisheye && axis == 'y')) return std::nullopt;
  if (fisheye)
    throw InputError(keys.frame.file(), keys.place("fl_x"), "is missing: an angle does not give the focal length of a fisheye");
  tally.angles += axis == 'x';
  return ofAngle;
}

Camera nerfCamera(const NerfKeys& keys, const fs::path& image, capture::ImageSizes& sizes, NerfTally& tally) {
  const std::string& file = keys.frame.file();
  const NerfModel& model = nerfModelOf(keys);
  const auto [width, height] = nerfSize(keys, image, sizes, tally);
  const std::optional<double> fx = nerfFocal(keys, 'x', width, model, tally);
  if (!fx) throw InputError(file, keys.place("fl_x"), "is missing, and so is camera_angle_x");
  const double fy = nerfFocal(keys, 'y', height, model, tally).value_or(*fx);
  const std::optional<JsonNode> cx = keys.find("cx"), cy = keys.find("cy");
  tally.middles += !cx || !cy;
  tally.models.insert(model.name);
  return capture::cameraOf(width, height, *fx, fy, (cx ? cx->number() : 0.5 * width) + capture::kFromCorner,
                           (cy ? cy->number() : 0.5 * height) + capture::kFromCorner, nerfLens(keys, model), file,
                           keys.frame.place());
}

// ---- Frames -----------------------------------------------------------------------------------------------------------------

struct NerfContext {
  const JsonNode& root;
  const CaptureOptions& options;
  fs::path folder;
  double appliedScale = 1;
  std::optional<NerfWorld> undone;  ///< --world original
  capture::FileNames names;
  capture::ImageSizes sizes;
  NerfTally tally;
};

/// World to camera, z forward, from camera to world, z backward.
Eigen::Isometry3d nerfPose(const JsonNode& node, NerfContext& context) {
  std::string warning;
  Eigen::Isometry3d worldFromCam = readPoseJson(node, &warning);
  if (!warning.empty()) context.tally.rounded.add(node.place());
  // The last column is the camera's centre and stays. (readPoseJson turns it with a repaired rotation: that keeps the centre of a
  // pose from world to camera.)
  for (int i = 0; i < 3; ++i) worldFromCam.translation()[i] = node.at(std::size_t(i)).at(std::size_t(3)).number();
  Eigen::Matrix3d r = worldFromCam.linear();
  // A rotation to single precision would still move the centre when it is inverted: two steps to the nearest one, each of which
  // squares what is missing.
  for (int step = 0; step < 2; ++step) r = 1.5 * r - 0.5 * r * (r.transpose() * r).eval();
  if (context.undone) {
    const NerfWorld& world = *context.undone;
    r = world.rotation.transpose() * r;
    worldFromCam.translation() = world.rotation.transpose() * (worldFromCam.translation() - world.translation) / world.scale;
    for (int i = 0; i < 3; ++i) capture::bounded(worldFromCam.translation()[i], kFarthest, node.file(), node.place());
  }
  worldFromCam.linear() = r * Eigen::Vector3d(1, -1, -1).asDiagonal();
  return worldFromCam.inverse();
}

/// A path without "./", with slashes even if Windows wrote it.
std::string nerfPath(const JsonNode& node) {
  if (node.text().empty()) node.fail("the path is empty");
  return fs::path(slashed(node.text())).lexically_normal().generic_string();
}
fs::path nerfFile(const JsonNode& node, NerfContext& context) {
  return context.names.other(context.folder, node.text(), node.file(), node.place());
}

std::optional<JsonNode> givenNerfPath(const JsonNode& frame, const char* key) {
  const std::optional<JsonNode> node = frame.find(key);
  return node && !node->isNull() ? node : std::nullopt;
}

void readNerfDepth(const JsonNode& frame, NerfContext& context, CaptureView& view) {
  constexpr double kMillimetres = 0.001;  // what nerfstudio takes without an option
  std::optional<JsonNode> node = givenNerfPath(frame, "depth_file_path");
  double scale = kMillimetres;
  if (node) {
    if (const auto n = context.root.find("depth_unit_scale_factor")) scale = positive(*n, kLargestFactor);
  } else {  // instant-ngp's: only with its factor
    const std::optional<JsonNode> factor = context.root.find("integer_depth_scale");
    node = givenNerfPath(frame, "depth_path");
    if (!node || !factor || !(factor->number() > 0)) return;
    scale = bounded(*factor, kLargestFactor) / context.appliedScale;
  }
  const fs::path path = nerfFile(*node, context);
  const std::string ending = lowerEnding(path);
  if (ending == ".npy" || ending == ".npz") {
    context.tally.arrays.add(node->place());
    return;
  }
  const bool isFloat = ending == ".exr" || ending == ".tif" || ending == ".tiff" || ending == ".hdr" || ending == ".pfm";
  if (isFloat) scale = 1;
  // nerfstudio's depths are in the unit of the original world, the poses in that of the stored one.
  scale *= context.appliedScale / (context.undone ? context.undone->scale : 1);
  view.depth = path;
  view.depthScale = capture::bounded(scale, kLargestFactor, node->file(), node->place());
  if (!(view.depthScale > 0)) node->fail("its unit of length is 0");
  context.tally.depths += !isFloat;
  if (!isFloat) context.tally.depthScale = view.depthScale;
  context.tally.floatDepths += isFloat;
}

CaptureView readNerfFrame(const JsonNode& frame, NerfContext& context) {
  checkNerfKeys(frame, kNerfFrameKeys, context.tally);
  CaptureView view;
  const JsonNode path = frame.at("file_path");
  view.name = nerfPath(path);
  view.image = context.names.image(path.text(), {context.folder}, path.file(), path.place());
  const NerfKeys keys{context.root, frame};
  keys.tellDifferences(context.tally.ownKeys);
  view.camera = nerfCamera(keys, view.image, context.sizes, context.tally);
  view.camera.camFromWorld = nerfPose(frame.at("transform_matrix"), context);
  readNerfDepth(frame, context, view);
  if (const auto n = givenNerfPath(frame, "mask_path")) {
    view.mask = nerfFile(*n, context);
    ++context.tally.masks;
  }
  return view;
}

// ---- Points -----------------------------------------------------------------------------------------------------------------

struct NerfPoints {
  std::string named;
  fs::path file;  ///< empty if it is missing: programs read the cameras without it
};

/// What ply_file_path names.
std::optional<NerfPoints> nerfPointsOf(const JsonNode& root, const fs::path& folder, capture::FileNames& names) {
  const std::optional<JsonNode> node = givenNerfPath(root, "ply_file_path");
  if (!node) return std::nullopt;
  NerfPoints points{node->text(), names.other(folder, node->text(), node->file(), node->place())};
  std::error_code ignored;  // unreadable counts as missing
  if (!fs::is_regular_file(points.file, ignored)) points.file.clear();
  return points;
}

void addNerfPoints(NerfContext& context, Capture& capture) {
  const std::optional<NerfPoints> points = nerfPointsOf(context.root, context.folder, context.names);
  if (!points) return;
  if (points->file.empty()) {
    capture.warnings.push_back("ply_file_path: there is no '" + points->named +
                               "': the cameras cannot be compared with its points");
    return;
  }
  capture.sources.push_back(points->file);
  capture.facts.push_back("point cloud: '" + points->named + "', in the " + (context.undone ? "original" : "stored") +
                          " world as the cameras; it does not say which images show a point");
}

// ---- Report -----------------------------------------------------------------------------------------------------------------

std::string nerfFrames(int number) { return std::to_string(number) + (number == 1 ? " frame" : " frames"); }

void tellNerfFacts(const NerfContext& context, Capture& capture) {
  const NerfTally& tally = context.tally;
  std::vector<std::string>& facts = capture.facts;
  std::string models;
  for (const std::string& name : tally.models) models += (models.empty() ? "" : ", ") + name;
  facts.push_back("nerfstudio: " + capture.file.filename().string() + " with " + nerfFrames(int(capture.views.size())) +
                  ", camera model " + models + (context.root.has("camera_model") ? "" : " (none is named for all)"));
  facts.push_back("poses: camera to world with y up, looking along -z; turned into world to camera with y down, looking along z");
  facts.push_back("cx, cy: counted from the corner of the first pixel; 0.5 less from its centre");
  if (tally.middles > 0) facts.push_back("cx, cy: not given for " + nerfFrames(tally.middles) + ", the middle of the image");
  if (tally.angles > 0) facts.push_back("focal length: from the angle of view for " + nerfFrames(tally.angles));
  if (tally.ownSizes > 0) facts.push_back("size: from the image itself for " + nerfFrames(tally.ownSizes));
  if (context.undone)
    facts.push_back(
        formatted("world: the original one; applied_transform and applied_scale are undone (scale %.6g)", context.undone->scale));
  else if (context.root.has("applied_transform") || context.root.has("applied_scale"))
    facts.push_back("world: as stored; applied_transform is part of it (--world original undoes it)");
  if (tally.depths > 0)
    facts.push_back(formatted("depth: integers, each %.6g of the unit of the world, for ", tally.depthScale) +
                    nerfFrames(tally.depths));
  if (tally.floatDepths > 0)
    facts.push_back("depth: floating point, in the unit of the world, for " + nerfFrames(tally.floatDepths));
  if (tally.masks > 0) facts.push_back("masks: for " + nerfFrames(tally.masks));
}

void tellNerfWarnings(const NerfContext& context, Capture& capture) {
  constexpr std::size_t kEach = 8;  // as many as a person reads
  const NerfTally& tally = context.tally;
  std::vector<std::string>& warnings = capture.warnings;
  if (tally.rounded.number > 0)
    warnings.push_back(tally.rounded.text() + ": not exactly a rotation, replaced by the nearest one");
  if (tally.otherAngle.number > 0)
    warnings.push_back(tally.otherAngle.text() + ": the angle of view says another focal length than fl_x, fl_y, which are used");
  if (tally.ownKeys.number > 0)
    warnings.push_back(tally.ownKeys.text() + ": differs from the value at the top of the file; the frame's own one counts");
  tally.lost.tell(capture.file.filename().string(), capture::kNoFinitePose, warnings);
  tally.cut.tell(capture.file.filename().string(), capture::kCutPose, warnings);
  context.names.tell(warnings);
  if (tally.arrays.number > 0) warnings.push_back(tally.arrays.text() + ": depth as a NumPy array is not read, left out");
  std::string placed;
  for (const char* key : {"scale", "offset", "aabb"})
    if (context.root.has(key)) placed += (placed.empty() ? "" : ", ") + std::string(key);
  if (!placed.empty())
    warnings.push_back(placed + ": place the world in the unit cube of instant-ngp; not applied, the poses are as stored");
  std::size_t told = 0;
  for (const auto& [key, count] : tally.unknown)
    if (told++ < kEach) warnings.push_back(count.text() + ": unknown key, ignored");
  if (told > kEach) warnings.push_back(std::to_string(told - kEach) + " more unknown keys, ignored");
}

// ---- Recognition ------------------------------------------------------------------------------------------------------------

/// The text has `"key" :`. Without parsing: a damaged file is still recognised, and says where it is damaged when it is read.
bool nerfTextHasKey(const std::string& text, const std::string& key) {
  const std::string word = '"' + key + '"';
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t next = text.find_first_not_of(" \t\r\n", at + word.size());
    if (next != std::string::npos && text[next] == ':') return true;
  }
  return false;
}

/// A file of the format; never throws.
bool isNerfFile(const fs::path& file) {
  try {
    std::error_code ignored;  // unreadable counts as missing
    if (!fs::is_regular_file(file, ignored)) return false;
    char first = ' ';
    std::ifstream in(file, std::ios::binary);
    if (!(in >> first) || (first != '{' && first != '\xEF')) return false;  // an object, or the mark before UTF-8
    const std::string text = readFile(file, Limit::JsonMegabytes);
    return !nerfTextHasKey(text, "glint_scene") && nerfTextHasKey(text, "frames") && nerfTextHasKey(text, "transform_matrix");
  } catch (const std::exception&) {
    return false;
  }
}

/// The files transforms*.json of a folder, the one to read first: transforms.json, else transforms_train.json, else by name.
/// Those of the original NeRF data are parts of one capture.
std::vector<fs::path> nerfFilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;  // what cannot be listed holds none
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (const std::string name = it->path().filename().string(); name.starts_with("transforms") && name.ends_with(".json"))
      if (isNerfFile(it->path())) files.push_back(it->path());
  const auto rank = [](const fs::path& p) { return p.stem() == "transforms" ? 0 : p.stem() == "transforms_train" ? 1 : 2; };
  std::sort(files.begin(), files.end(),
            [&](const auto& a, const auto& b) { return std::make_pair(rank(a), a) < std::make_pair(rank(b), b); });
  return files;
}

/// The other parts of a capture of the original NeRF data.
void tellOtherNerfFiles(Capture& capture) {
  if (capture.file.stem() == "transforms") return;
  std::string others;
  for (const fs::path& other : nerfFilesIn(capture.folder))
    if (other.filename() != capture.file.filename()) others += (others.empty() ? "" : ", ") + other.filename().string();
  if (!others.empty())
    capture.warnings.push_back("only " + capture.file.filename().string() + " is read; to read another file, name it: " + others);
}

class NerfstudioReader final : public CaptureReader {
 public:
  std::string name() const override { return "nerfstudio"; }
  std::string describe() const override { return "transforms.json of nerfstudio, instant-ngp or the original NeRF data"; }

  fs::path recognise(const fs::path& input) const override {
    std::error_code ignored;  // unreadable counts as missing
    if (!fs::is_directory(input, ignored)) return isNerfFile(input) ? input : fs::path();
    if (const fs::path file = input / "transforms.json"; isNerfFile(file)) return file;
    const std::vector<fs::path> files = nerfFilesIn(input);
    return files.empty() ? fs::path() : files.front();
  }

  Capture read(const fs::path& file, const CaptureOptions& options) const override {
    if (!options.world.empty() && options.world != "original")
      throw InputError("", "--world " + options.world, "is not one of: original");
    Capture capture;
    capture.kind = name();
    capture.file = fs::absolute(file).lexically_normal();
    capture.folder = capture.file.parent_path();
    capture.sources = {capture.file};
    const JsonNode root = JsonNode::parse(readFile(file, Limit::JsonMegabytes), file.string());
    if (root.has("glint_scene")) root.fail("is a scene of ours, not a file of nerfstudio");
    NerfContext context{root, options, capture.folder, 1, std::nullopt, capture::FileNames(options.rights, options.photographs),
                        {},   {}};
    checkNerfKeys(root, kNerfTopKeys, context.tally);
    if (const auto n = root.find("applied_scale")) context.appliedScale = positive(*n, kLargestFactor);
    if (const auto n = root.find("applied_transform")) readAppliedTransform(*n);
    if (options.world == "original") context.undone = readOriginalWorld(root, context.appliedScale, capture.warnings);
    const JsonNode frames = root.at("frames");
    if (frames.size() == 0) frames.fail("is empty");
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const JsonNode frame = frames.at(i);
      if (const auto pose = frame.find("transform_matrix"); pose && capture::isLostPose(*pose))
        context.tally.lost.add(frame.place());
      else if (pose && capture::isCutPose(*pose))
        context.tally.cut.add(frame.place());
      else
        capture.views.push_back(readNerfFrame(frame, context));
    }
    if (capture.views.empty()) frames.fail("have no finite pose");
    capture::orderByName(capture);
    tellNerfFacts(context, capture);
    addNerfPoints(context, capture);
    tellNerfWarnings(context, capture);
    tellOtherNerfFiles(capture);
    return capture;
  }

  /// Points of ply_file_path, without observations.
  std::vector<CaptureTrack> tracks(const Capture& capture, const CaptureOptions& options) const override {
    const JsonNode root = JsonNode::parse(readFile(capture.file, Limit::JsonMegabytes), capture.file.string());
    capture::FileNames names(options.rights);
    const std::optional<NerfPoints> points = nerfPointsOf(root, capture.folder, names);
    if (!points || points->file.empty()) return {};
    std::optional<NerfWorld> undone;
    if (options.world == "original") {
      std::vector<std::string> told;  // by `read`
      const auto scale = root.find("applied_scale");
      undone = readOriginalWorld(root, scale ? positive(*scale, kLargestFactor) : 1, told);
    }
    std::vector<CaptureTrack> tracks;
    for (const Eigen::Vector3d& p : readCloudContent(points->file).points) {
      CaptureTrack track{p, {}};
      if (undone) track.point = undone->rotation.transpose() * (p - undone->translation) / undone->scale;
      if (!(track.point.cwiseAbs().maxCoeff() <= kFarthest))
        throw InputError(points->file.string(), formatted("point %zu", tracks.size()), "is farther than 1e15 from the origin");
      tracks.push_back(std::move(track));
    }
    return tracks;
  }
};

}  // namespace

std::unique_ptr<const CaptureReader> makeNerfstudioReader() { return std::make_unique<NerfstudioReader>(); }

}  // namespace glint
