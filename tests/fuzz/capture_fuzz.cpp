// SPDX-License-Identifier: BSD-3-Clause
// The readers of captures of other programs: cameras that keep their promises, or an InputError. A capture is several files: one
// input is one of them beside whole others, or several with a line "####" between them.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/scene/capture.h"
#include "core/scene/scene.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/scratch_file.h"

namespace glint::fuzz {
namespace {
namespace fs = std::filesystem;

const char* const kImage = "P5\n4 3\n255\n............";  // PNM: 4 x 3 pixels
const char* const kMesh =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n1 0 1\n0 1 1\n3 0 1 2\n";

void requirePromise(bool kept, const char* promise) {
  if (!kept) throw Finding{promise};
}

void checkView(const CaptureView& view) {
  const Camera& c = view.camera;
  requirePromise(c.width >= 1 && c.height >= 1, "an image without a size");
  requirePromise(c.pixelFromRay.allFinite() && c.pixelFromRay(0, 0) > 0 && c.pixelFromRay(1, 1) > 0, "an illegal K");
  const Eigen::Matrix3d r = c.camFromWorld.linear();
  constexpr double kRotation = 2e-6;  // to single precision it was meant as a rotation, and stays (readPoseJson)
  requirePromise(c.camFromWorld.matrix().allFinite(), "a pose that is not finite");
  requirePromise((r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kRotation && r.determinant() > 0,
                 "a pose that is not rigid");
  for (const double p : c.lens.parameters) requirePromise(std::isfinite(p), "a lens that is not finite");
  requirePromise(!view.name.empty(), "an image without a name");
  requirePromise(view.depth.empty() || (std::isfinite(view.depthScale) && view.depthScale >= 0), "an illegal depth scale");
}

void checkCapture(const Capture& capture, const std::vector<CaptureTrack>& tracks) {
  requirePromise(!capture.views.empty(), "a capture without images");
  std::set<std::string> names;
  for (const CaptureView& view : capture.views) {
    checkView(view);
    requirePromise(names.insert(view.name).second, "two images of one name");
  }
  for (const CaptureTrack& track : tracks) {
    requirePromise(track.point.allFinite(), "a point that is not finite");
    for (const CaptureTrack::Observation& o : track.seen)
      requirePromise(o.view >= 0 && std::size_t(o.view) < capture.views.size() && o.measured.allFinite(),
                     "a point seen where nothing is");
  }
}

struct File {
  std::string name, bytes;
};

/// Writes the files into a folder of this kind and reads it.
bool feedCapture(const std::string& kind, const std::vector<File>& files) {
  const fs::path folder = scratch().path() / kind;
  fs::create_directories(folder);
  for (const char* image : {"a.png", "b.png"}) scratch().write(kind + "/" + image, kImage);
  scratch().write(kind + "/mesh.ply", kMesh);
  for (const File& f : files) {
    fs::create_directories((folder / f.name).parent_path());
    scratch().write(kind + "/" + f.name, f.bytes);
  }
  ReadOptions options;
  options.choices.as = kind;
  options.choices.camera = {80, 80, 1.5, 1};
  CaptureOptions own;
  Camera camera = cameraOfNumbers(options.choices.camera);
  own.camera = camera;
  try {
    const CaptureReader& reader = *captureReaderNamed(kind);
    const fs::path file = reader.recognise(folder);
    if (file.empty()) return false;
    const Capture capture = reader.read(file, own);
    checkCapture(capture, reader.tracks(capture, own));
    readScene(folder, options);
    return true;
  } catch (const InputError& e) {
    checkRefusal(e, "");
    return false;
  }
}

/// The parts of an input between lines "####", one for each name.
std::vector<File> parts(const std::string& bytes, const std::vector<std::string>& names) {
  std::vector<File> files;
  std::size_t from = 0;
  for (const std::string& name : names) {
    const std::size_t to = std::min(bytes.find("####\n", from), bytes.size());
    files.push_back({name, bytes.substr(from, to - from)});
    from = std::min(bytes.size(), to + 5);
  }
  return files;
}

template <class T>
void put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

// A whole COLMAP model of one camera, two images and one point, as its format page lays it out.
std::string wholeCameras() {
  std::string b;
  put<std::uint64_t>(b, 1);
  put<std::uint32_t>(b, 1);
  put<std::int32_t>(b, 1);  // PINHOLE
  put<std::uint64_t>(b, 4);
  put<std::uint64_t>(b, 3);
  for (const double p : {80.0, 80.0, 2.0, 1.5}) put(b, p);
  return b;
}

std::string wholeImages() {
  std::string b;
  put<std::uint64_t>(b, 2);
  for (std::uint32_t id = 1; id <= 2; ++id) {
    put(b, id);
    for (const double v : {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, double(id)}) put(b, v);
    put<std::uint32_t>(b, 1);
    b += id == 1 ? "a.png" : "b.png";
    b += '\0';
    put<std::uint64_t>(b, 1);
    put(b, 2.0);
    put(b, 1.5);
    put<std::uint64_t>(b, 7);
  }
  return b;
}

std::string wholePoints() {
  std::string b;
  put<std::uint64_t>(b, 1);
  put<std::uint64_t>(b, 7);
  for (const double v : {0.0, 0.0, 1.0}) put(b, v);
  b += std::string(3, '\x7f');
  put(b, 0.5);
  put<std::uint64_t>(b, 2);
  for (std::uint32_t image = 1; image <= 2; ++image) {
    put(b, image);
    put<std::uint32_t>(b, 0);
  }
  return b;
}

}  // namespace

bool feedColmapCameras(const std::string& bytes) {
  return feedCapture("colmap", {{"cameras.bin", bytes}, {"images.bin", wholeImages()}, {"points3D.bin", wholePoints()}});
}
bool feedColmapImages(const std::string& bytes) {
  return feedCapture("colmap", {{"cameras.bin", wholeCameras()}, {"images.bin", bytes}, {"points3D.bin", wholePoints()}});
}
bool feedColmapPoints(const std::string& bytes) {
  return feedCapture("colmap", {{"cameras.bin", wholeCameras()}, {"images.bin", wholeImages()}, {"points3D.bin", bytes}});
}
bool feedColmapText(const std::string& bytes) {
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {  // of the other targets of this process
    std::error_code ignored;
    fs::remove(scratch().path() / "colmap" / name, ignored);
  }
  return feedCapture("colmap", parts(bytes, {"cameras.txt", "images.txt", "points3D.txt"}));
}
bool feedNvm(const std::string& bytes) { return feedCapture("nvm", {{"model.nvm", bytes}}); }
bool feedTransforms(const std::string& bytes) {  // in a folder of its own the points are no mesh beside mesh.ply, however damaged
  return feedCapture("nerfstudio", parts(bytes, {"transforms.json", "points/sparse_pc.ply"}));
}
bool feedBundle(const std::string& bytes) { return feedCapture("bundler", parts(bytes, {"bundle.out", "list.txt"})); }
bool feedTum(const std::string& bytes) { return feedCapture("tum", parts(bytes, {"rgb.txt", "groundtruth.txt", "depth.txt"})); }
bool feedBop(const std::string& bytes) {
  std::vector<File> files;
  try {
    const JsonNode root = JsonNode::parse(bytes, "bop");
    for (const auto& [key, name] : {std::pair("camera", "scene_camera.json"), {"gt", "scene_gt.json"}})
      files.push_back({name, root.isObject() && root.has(key) ? root.at(key).dump() : ""});
  } catch (const InputError&) {
    return false;  // the frame around the two files, which is this target's own
  }
  for (const char* image : {"rgb/000000.png", "rgb/000001.png"}) files.push_back({image, kImage});
  return feedCapture("bop", files);
}

/// Poses of two images, as TUM or JSON lines.
bool feedPosedImages(const std::string& bytes) {
  const fs::path folder = scratch().path() / "posed";
  fs::create_directories(folder / "frames");
  for (const char* image : {"1.000.png", "1.033.png"}) scratch().write(std::string("posed/frames/") + image, kImage);
  scratch().write("posed/poses", bytes);
  CaptureOptions options;
  options.camera = cameraOfNumbers({80, 80, 1.5, 1});
  options.poses = folder / "poses";
  const auto reader = makeImagesReader();
  bool read = false;
  for (const bool byOrder : {false, true}) try {
      options.posesByOrder = byOrder;
      checkCapture(reader->read(folder / "frames/1.000.png", options), {});
      read = true;
    } catch (const InputError& e) {
      checkRefusal(e, "");
    }
  return read;
}

}  // namespace glint::fuzz
