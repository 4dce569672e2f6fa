// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/capture.h"

#include <algorithm>

#include "core/scene/capture_parts.h"

namespace glint {

const char* UndecidedInput::option() const {
  switch (question_) {
    case Question::Reading: return "--as";
    case Question::Surface: return "--surface";
    case Question::Camera: return "--camera";
    case Question::Object: return "--object";
    case Question::Poses: return "--poses";
    case Question::PosesBy: return "--poses-by";
  }
  return "";
}

std::filesystem::path CaptureReader::incomplete(const std::filesystem::path&) const { return {}; }

std::vector<CaptureTrack> CaptureReader::tracks(const Capture&, const CaptureOptions&) const { return {}; }

namespace {
std::vector<std::unique_ptr<const CaptureReader>>& registered() {
  static std::vector<std::unique_ptr<const CaptureReader>> readers = [] {
    std::vector<std::unique_ptr<const CaptureReader>> list;
    list.push_back(makeColmapReader());
    list.push_back(makeNvmReader());
    list.push_back(makeNerfstudioReader());
    list.push_back(makeTumReader());
    list.push_back(makeBundlerReader());
    list.push_back(makeBopReader());
    return list;
  }();
  return readers;
}
}  // namespace

const std::vector<std::unique_ptr<const CaptureReader>>& captureReaders() { return registered(); }

void checkCaptureReader(const CaptureReader& reader) {
  const std::string name = reader.name();
  for (const char* other : {"", "scene", "session", "images", "video"})
    require(name != other, "reader: the name '" + name + "' is taken or empty");
  require(!captureReaderNamed(name), "reader: the name '" + name + "' is taken");
}

void addCaptureReader(std::unique_ptr<const CaptureReader> reader) {
  require(reader != nullptr, "addCaptureReader: no reader");
  checkCaptureReader(*reader);
  registered().push_back(std::move(reader));
}

const CaptureReader* captureReaderNamed(const std::string& name) {
  for (const auto& reader : captureReaders())
    if (reader->name() == name) return reader.get();
  return nullptr;
}

std::vector<std::filesystem::path> capture::modelFoldersOfBop(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::vector<fs::path> folders;
  const fs::path own = fs::absolute(file).lexically_normal().parent_path();
  std::error_code error;  // what cannot be listed has no models
  for (fs::directory_iterator it(own.parent_path().parent_path(), error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().rfind("models", 0) == 0 && it->is_directory(error)) folders.push_back(it->path());
  std::sort(folders.begin(), folders.end());  // "models" is the shortest, so it comes first
  return folders;
}

std::vector<std::filesystem::path> foldersOfCapture(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const fs::path own = fs::absolute(file).lexically_normal().parent_path();
  const std::string name = own.filename().string(), name2 = own.parent_path().filename().string();
  const auto isNumber = [](const std::string& s) { return !s.empty() && s.find_first_not_of("0123456789") == std::string::npos; };
  if (name == "sparse" || name == "bundle") return {own.parent_path()};
  if (name2 == "sparse" && isNumber(name)) return {own.parent_path().parent_path()};
  if (file.filename() != "scene_camera.json") return {};
  std::vector<fs::path> folders = capture::modelFoldersOfBop(file);
  std::erase_if(folders, [&](const fs::path& folder) { return !liesIn({own.parent_path().parent_path()}, folder); });
  return folders;
}

}  // namespace glint
