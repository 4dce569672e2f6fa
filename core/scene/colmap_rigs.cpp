// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include "core/base/atomic_file.h"
#include "core/scene/colmap_parts.h"
#include "io/text_scan.h"

// rigs and frames, which COLMAP writes from version 3.12 on: several sensors that are moved as one. The pose of an image is that
// of its sensor in the rig after that of the rig in the world, and the file of images has it as well.

namespace glint::capture::colmap {
namespace fs = std::filesystem;
using Eigen::Isometry3d;
namespace {

constexpr std::int32_t kCameraSensor = 0;  // number of the type CAMERA

/// Poses of its cameras in the rig; nothing if the file has none.
using Rig = std::map<std::uint32_t, std::optional<Isometry3d>>;
struct RigFrame {
  std::uint32_t rig = 0;
  Isometry3d rigFromWorld = Isometry3d::Identity();
  std::string place;
  struct Shot {
    std::uint32_t sensor = 0;
    std::uint64_t image = 0;
  };
  std::vector<Shot> shots;  ///< of cameras
};
struct Rigs {
  std::map<std::uint32_t, Rig> rigs;
  std::vector<RigFrame> frames;
};

/// Words of the lines of a text, under the names that the binary reader has. A file that is not understood is only warned of.
class RigWords {
 public:
  RigWords(std::string_view bytes, const std::string& file) : file_(file), lines_(bytes) {}

  /// Goes to the next element.
  bool next() {
    while (const auto line = lines_.next()) {
      line_ = *line;
      std::string_view word = line_;
      if (word = io::takeWord(word); !word.empty() && word.front() != '#') return true;
    }
    return false;
  }
  std::string place() const { return lineNo(lines_.number()); }
  std::uint32_t number() {
    const std::optional<std::uint32_t> value = number32(io::takeWord(line_));
    if (!value) throw InputError(file_, place(), "a whole number is missing");
    return *value;
  }
  std::size_t count(std::size_t) { return number(); }  // ends at the end of the line, whatever it says
  bool isCamera() {
    const std::string_view word = io::takeWord(line_);
    if (word.empty()) throw InputError(file_, place(), "the type of a sensor is missing");
    return word == "CAMERA";
  }
  bool flag() { return number() != 0; }
  std::uint64_t data() {
    const std::optional<std::int64_t> value = io::integerOf(io::takeWord(line_));
    if (!value || *value < 0) throw InputError(file_, place(), "the number of an image is missing");
    return static_cast<std::uint64_t>(*value);
  }
  std::array<double, 7> pose() {
    std::array<double, 7> values{};
    for (double& v : values) {
      const std::optional<double> number = io::numberOf(io::takeWord(line_));
      if (!number) throw InputError(file_, place(), "a number of a pose is missing");
      v = *number;
    }
    return values;
  }
  void endOfElement() {
    if (!io::takeWord(line_).empty()) throw InputError(file_, place(), "has more entries than it declares");
  }

 private:
  const std::string& file_;
  io::Lines lines_;
  std::string_view line_;
};

class RigBytes {
 public:
  RigBytes(std::string_view bytes, const std::string& file) : in_(bytes, file) {
    left_ = in_.takeCount<std::uint64_t>(8, "elements");
  }

  bool next() {
    if (left_ == 0) {
      in_.end();
      return false;
    }
    --left_;
    return true;
  }
  std::string place() const { return in_.place(); }
  std::uint32_t number() { return in_.take<std::uint32_t>(); }
  std::size_t count(std::size_t least) { return in_.takeCount<std::uint32_t>(least, "entries"); }
  bool isCamera() { return in_.take<std::int32_t>() == kCameraSensor; }
  bool flag() { return in_.take<std::uint8_t>() != 0; }
  std::uint64_t data() { return in_.take<std::uint64_t>(); }
  std::array<double, 7> pose() { return in_.takeDoubles<7>(); }
  void endOfElement() {}

 private:
  Bytes in_;
  std::size_t left_ = 0;
};

/// RIG_ID, NUM_SENSORS, the sensor that is the rig's origin, the others with their poses.
template <class In>
std::map<std::uint32_t, Rig> rigsOf(In in, const std::string& file) {
  constexpr std::size_t kLeast = 8;  // bytes of a type and a number
  std::map<std::uint32_t, Rig> rigs;
  std::vector<std::string> ignored;  // a quaternion that is not of length 1: the comparison shows what comes of it
  while (in.next()) {
    const std::string place = in.place();
    const std::uint32_t id = in.number();
    const std::size_t sensors = in.count(kLeast);
    Rig& rig = rigs[id];
    for (std::size_t i = 0; i < sensors; ++i) {
      const bool camera = in.isCamera();
      const std::uint32_t sensor = in.number();
      std::optional<Isometry3d> pose;
      if (i == 0)
        pose = Isometry3d::Identity();
      else if (in.flag())
        pose = poseOf(in.pose(), file, place, ignored);
      if (camera) rig[sensor] = pose;
    }
    in.endOfElement();
  }
  return rigs;
}

/// FRAME_ID, RIG_ID, the pose of the rig, NUM_DATA_IDS, SENSOR_TYPE SENSOR_ID DATA_ID of each: the last is an image's number.
template <class In>
std::vector<RigFrame> rigFramesOf(In in, const std::string& file) {
  constexpr std::size_t kLeast = 16;  // bytes of a type and two numbers
  std::vector<RigFrame> frames;
  std::vector<std::string> ignored;  // as above
  while (in.next()) {
    RigFrame frame;
    frame.place = in.place();
    in.number();
    frame.rig = in.number();
    frame.rigFromWorld = poseOf(in.pose(), file, frame.place, ignored);
    const std::size_t shots = in.count(kLeast);
    for (std::size_t i = 0; i < shots; ++i) {
      const bool camera = in.isCamera();
      const std::uint32_t sensor = in.number();
      const std::uint64_t image = in.data();
      if (camera) frame.shots.push_back({sensor, image});
    }
    in.endOfElement();
    frames.push_back(std::move(frame));
  }
  return frames;
}

Rigs readRigs(const Files& files) {
  const fs::path rigs = files("rigs"), frames = files("frames");
  const std::string rigBytes = readFile(rigs, Limit::MeshMegabytes), frameBytes = readFile(frames, Limit::MeshMegabytes);
  if (files.binary)
    return {rigsOf(RigBytes(rigBytes, rigs.string()), rigs.string()),
            rigFramesOf(RigBytes(frameBytes, frames.string()), frames.string())};
  return {rigsOf(RigWords(rigBytes, rigs.string()), rigs.string()),
          rigFramesOf(RigWords(frameBytes, frames.string()), frames.string())};
}

/// Largest difference of two poses, lengths relative to the farther camera where that is more than 1 away.
double poseDifference(const Isometry3d& a, const Isometry3d& b) {
  const double size = std::max({1.0, a.translation().norm(), b.translation().norm()});
  return std::max((a.linear() - b.linear()).cwiseAbs().maxCoeff(), (a.translation() - b.translation()).norm() / size);
}

struct RigCounts {
  std::size_t compared = 0, unknownImages = 0, withoutPose = 0;
};

void compareRigFrame(const RigFrame& frame, const Rigs& all, const std::string& file, const std::vector<ModelImage>& images,
                     const std::unordered_map<std::uint32_t, std::size_t>& index, RigCounts& counts) {
  constexpr double kPrinted = 1e-6;  // both files have 17 digits; what differs by more was not written from one pose
  const auto rig = all.rigs.find(frame.rig);
  if (rig == all.rigs.end()) throw InputError(file, frame.place, "there is no rig " + std::to_string(frame.rig));
  for (const auto& [sensor, number] : frame.shots) {
    const auto found = number > UINT32_MAX ? index.end() : index.find(static_cast<std::uint32_t>(number));
    if (found == index.end()) {
      ++counts.unknownImages;
      continue;
    }
    const ModelImage& image = images[found->second];
    if (image.lost) continue;
    const auto mounted = rig->second.find(sensor);
    if (mounted == rig->second.end())
      throw InputError(file, frame.place, "rig " + std::to_string(frame.rig) + " has no camera " + std::to_string(sensor));
    if (image.camera != sensor)
      throw InputError(file, frame.place,
                       "image " + io::quoted(image.name) + " is of camera " + std::to_string(sensor) + " here and of camera " +
                           std::to_string(image.camera) + " in the file of images");
    if (!mounted->second) {
      ++counts.withoutPose;
      continue;
    }
    ++counts.compared;
    if (!(poseDifference(*mounted->second * frame.rigFromWorld, image.camFromWorld) <= kPrinted))
      throw InputError(file, frame.place,
                       "the pose of image " + io::quoted(image.name) + " differs from that in the file of images");
  }
}

}  // namespace

void checkRigs(const Files& files, const std::vector<ModelImage>& images, Capture& capture) {
  if (!files.has("rigs") || !files.has("frames")) {
    for (const char* stem : {"rigs", "frames"})
      if (files.has(stem))
        capture.warnings.push_back(files(stem).filename().string() + " has no counterpart: it was not compared with the images");
    return;
  }
  const std::string rigsName = files("rigs").filename().string(), framesName = files("frames").filename().string();
  capture.sources.insert(capture.sources.end(), {files("rigs"), files("frames")});
  Rigs all;
  try {
    all = readRigs(files);
  } catch (const InputError& e) {
    capture.warnings.push_back(rigsName + " and " + framesName +
                               " are not understood and were not compared with the poses of images: " + e.what());
    return;
  }
  RigCounts counts;
  const auto index = indexById(images, "images", files("images").string());
  for (const RigFrame& frame : all.frames) compareRigFrame(frame, all, files("frames").string(), images, index, counts);
  capture.facts.push_back(rigsName + " and " + framesName + " agree with the poses of " + counted(counts.compared, "image"));
  if (counts.unknownImages)
    capture.warnings.push_back(framesName + " names " + counted(counts.unknownImages, "image") + " that the model does not have");
  if (counts.withoutPose)
    capture.warnings.push_back(rigsName + " has no pose for the cameras of " + counted(counts.withoutPose, "image") +
                               ": the poses were not compared");
}

}  // namespace glint::capture::colmap
