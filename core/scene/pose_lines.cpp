// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/pose_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/geometry/camera_json.h"
#include "core/scene/capture_parts.h"
#include "core/scene/text_rows.h"
#include "io/text_scan.h"

namespace glint {
namespace {

/// The error of one line's JSON text as one of the whole: its own place counts from the line's start.
[[noreturn]] void throwFrom(const InputError& e, const std::string& file, const std::string& line) {
  std::string place = e.place(), reason = e.what();
  const std::string before = InputError(e.file(), e.place(), "").what();
  if (reason.compare(0, before.size(), before) == 0) reason.erase(0, before.size());
  const std::string own = "line 1, ";  // a line has no other
  if (place.compare(0, own.size(), own) == 0) place.erase(0, own.size());
  throw InputError(file, line + (place.empty() ? "" : ": " + place), reason);
}

bool isSamePose(const PoseLine& a, const PoseLine& b) {
  const auto place = [](const PoseLine& p) { return p.worldFromObject.value_or(Eigen::Isometry3d::Identity()).matrix(); };
  if (a.time != b.time || a.cameraFromWorld.matrix() != b.cameraFromWorld.matrix() || place(a) != place(b)) return false;
  if (!a.camera || !b.camera) return !a.camera && !b.camera;
  const Camera &c = *a.camera, &d = *b.camera;
  return c.width == d.width && c.height == d.height && c.pixelFromRay == d.pixelFromRay && c.lens.model == d.lens.model &&
         c.lens.parameters == d.lens.parameters;
}

}  // namespace

PoseLineReader::PoseLineReader(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {}

/// False at the end. What is longer than a line may be is read to its end and dropped.
bool PoseLineReader::takeLine(std::string& line) {
  line.clear();
  std::size_t bytes = 0;
  try {
    std::streambuf* const from = in_.rdbuf();
    for (;;) {
      const int c = from ? from->sbumpc() : std::char_traits<char>::eof();
      if (c == std::char_traits<char>::eof()) {
        ended_ = true;
        break;
      }
      if (bytes == 0) ++number_;
      ++bytes;
      if (c == '\n') break;
      if (line.size() <= kLongestPoseLine) line += static_cast<char>(c);
    }
  } catch (const std::ios_base::failure& e) {
    ended_ = true;
    throw InputError(name_, "", std::string("cannot be read: ") + e.code().message());
  }
  arrived_ = std::chrono::steady_clock::now();
  if (line.size() > kLongestPoseLine)
    throw InputError(name_, place(), "is longer than " + std::to_string(kLongestPoseLine) + " bytes: no pose needs so many");
  return bytes > 0;
}

PoseLine PoseLineReader::fromJson(const std::string& line) {
  const auto parsed = [&] {
    try {
      return JsonNode::parse(line, name_);
    } catch (const InputError&) {
      const std::size_t last = line.find_last_not_of(" \t\r");
      if (ended_ && last != std::string::npos && line[last] != '}')
        throw CutPose(name_, place(), "the file ends within its JSON");
      throw;
    }
  };
  try {
    const JsonNode root = parsed();
    PoseLine pose;
    const auto id = root.find("id");
    const auto time = root.find("time");
    if (id) id_ = readIdJson(*id);
    if (time && !time->isNull())
      pose.time = capture::bounded(capture::secondsOf(time->number()), kFarthest, name_, time->place());
    if (!id && !pose.time) root.fail("needs an id or a time");
    if (!id) id_ = time->dump();
    pose.id = id_;
    refuseFrameGeometry(root);
    const JsonNode matrix = root.at("camera_from_world");
    if (capture::isLostPose(matrix))
      throw LostPose(name_, place() + ": camera_from_world", "there is no finite pose (null): tracking was lost");
    if (capture::isCutPose(matrix)) throw CutPose(name_, place() + ": camera_from_world", "has fewer numbers than a pose");
    pose.cameraFromWorld = readPoseJson(matrix, &warning_);
    if (!warning_.empty()) warning_ = place() + ": " + warning_;
    if (const auto object = root.find("world_from_object"); object && !object->isNull())
      pose.worldFromObject = readPoseJson(*object);
    if (const auto camera = root.find("camera"); camera && !camera->isNull()) {
      if (camera->has("response")) camera->at("response").fail("is not read here: name it by --response");
      pose.camera = readCameraJson(*camera);
      pose.camera->camFromWorld = pose.cameraFromWorld;
    }
    return pose;
  } catch (const LostPose&) {
    throw;
  } catch (const CutPose&) {
    throw;
  } catch (const InputError& e) {
    throwFrom(e, name_, place());
  }
}

PoseLine PoseLineReader::fromTum(const std::string& line) {
  constexpr std::size_t kNumbers = 8;
  capture::Row row{number_, {}};
  std::string_view rest = line;
  // One word more than there may be tells that the line is wrong; thousands need no memory.
  for (std::string_view word = io::takeWord(rest); !word.empty() && row.words.size() <= kNumbers; word = io::takeWord(rest))
    row.words.push_back(word);
  const std::string expected =
      "must be JSON {\"id\", \"camera_from_world\"} or the 8 numbers of TUM (time tx ty tz qx qy qz qw), has ";
  if (row.words.size() > kNumbers) throw InputError(name_, place(), expected + "more than 8 words");
  if (row.words.size() < kNumbers) throw CutPose(name_, place(), expected + std::to_string(row.words.size()) + " words");
  PoseLine pose;
  pose.time = capture::bounded(capture::secondsOf(capture::numberAt(row, 0, name_)), kFarthest, name_, place());
  pose.id = id_ = std::string(row.words.front());
  if (capture::isLostTum(row)) throw LostPose(name_, place(), "there is no finite pose: tracking was lost");
  Eigen::Vector4d xyzw;
  for (int i = 0; i < 4; ++i) xyzw[i] = capture::numberAt(row, std::size_t(4 + i), name_);
  std::vector<std::string> odd;
  Eigen::Isometry3d worldFromCamera = Eigen::Isometry3d::Identity();
  worldFromCamera.linear() = capture::unitQuaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2], name_, place(), odd).toRotationMatrix();
  worldFromCamera.translation() = capture::placeAt(row, 1, name_);
  pose.cameraFromWorld = worldFromCamera.inverse();
  if (!odd.empty()) warning_ = odd.front();
  return pose;
}

std::optional<PoseLine> PoseLineReader::next() {
  std::string line;
  while (!ended_) {
    id_.clear();
    warning_.clear();
    if (!takeLine(line)) break;
    constexpr std::string_view kMark = "\xEF\xBB\xBF";  // editors on Windows begin a UTF-8 file with it
    if (number_ == 1 && line.compare(0, kMark.size(), kMark) == 0) line.erase(0, kMark.size());
    std::string_view rest = line;
    const std::string_view word = io::takeWord(rest);
    if (word.empty() || word.front() == '#') continue;
    return word.front() == '{' ? fromJson(line) : fromTum(line);
  }
  id_.clear();
  warning_.clear();
  return std::nullopt;
}

std::vector<PoseLine> readPoseLines(const std::filesystem::path& file, std::vector<std::string>& warnings) {
  std::istringstream text(readFile(file, Limit::JsonMegabytes));
  PoseLineReader reader(text, file.string());
  std::vector<PoseLine> poses;
  std::vector<std::string> odd;
  std::map<std::string, std::size_t> ids;  // of `poses`
  capture::PassedOver lost, cut, repeated;
  std::optional<CutPose> first;
  const auto line = [&] { return "line " + std::to_string(reader.line()); };
  while (!reader.ended()) {
    try {
      const std::optional<PoseLine> pose = reader.next();
      if (!pose) break;
      const auto [before, isNew] = ids.emplace(pose->id, poses.size());
      if (!isNew) {
        if (!isSamePose(poses[before->second], *pose))
          throw InputError(file.string(), line(), "duplicate id " + io::quoted(pose->id) + " with another pose");
        repeated.add(line());
        continue;
      }
      if (!reader.warning().empty()) odd.push_back(file.filename().string() + ": " + reader.warning());
      poses.push_back(*pose);
    } catch (const LostPose&) {
      lost.add(line());
    } catch (const CutPose& e) {
      if (!first) first = e;
      cut.add(line());
    }
  }
  if (poses.empty() && first) throw *first;
  if (poses.empty()) throw InputError(file.string(), "", lost.number() > 0 ? "has no finite pose" : "has no pose");
  capture::addFew(warnings, odd);
  lost.tell(file.filename().string(), capture::kNoFinitePose, warnings);
  cut.tell(file.filename().string(), capture::kCutPose, warnings);
  repeated.tell(file.filename().string(), capture::kSaidBefore, warnings);
  return poses;
}

}  // namespace glint
