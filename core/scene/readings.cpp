// SPDX-License-Identifier: BSD-3-Clause
// Which reader understands an input.
#include <algorithm>

#include "core/base/limits.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

class CaptureSceneReader final : public SceneReader {
 public:
  explicit CaptureSceneReader(const CaptureReader& reader) : reader_(reader) {}
  std::string name() const override { return reader_.name(); }
  std::string describe() const override { return reader_.describe(); }
  fs::path recognise(const fs::path& input) const override { return reader_.recognise(input); }
  Scene read(const fs::path& file, const ReadOptions& options) const override {
    return sceneOfCapture(reader_.read(file, captureOptionsOf(options)), options);
  }

 private:
  const CaptureReader& reader_;
};

struct Reading {
  std::string as, description;
  fs::path file;
};

/// Every way to read the input. A scene.json in a folder leaves no other, and a session counts only where there is nothing else.
std::vector<Reading> readingsOf(const fs::path& input) {
  std::vector<Reading> all;
  Reading session;
  for (const auto& reader : sceneReaders()) {
    fs::path file = reader->recognise(input);
    if (file.empty()) continue;
    Reading reading{reader->name(), reader->describe(), std::move(file)};
    if (reading.as == "session") {
      session = std::move(reading);
      continue;
    }
    if (reading.as == "scene" && reading.file.filename() == "scene.json") return {std::move(reading)};
    all.push_back(std::move(reading));
  }
  if (all.empty() && !session.file.empty()) all.push_back(std::move(session));
  return all;
}

/// Readers that are asked only where poses are named (`--poses`): a folder of images alone is no capture.
const std::vector<std::unique_ptr<const SceneReader>>& posedReaders() {
  static const std::unique_ptr<const CaptureReader> images = makeImagesReader(), video = makeVideoReader();
  static const std::vector<std::unique_ptr<const SceneReader>> readers = [] {
    std::vector<std::unique_ptr<const SceneReader>> list;
    list.push_back(makeCaptureSceneReader(*images));
    list.push_back(makeCaptureSceneReader(*video));
    return list;
  }();
  return readers;
}

const SceneReader& readerNamed(const std::string& name) {
  for (const auto* readers : {&sceneReaders(), &posedReaders()})
    for (const auto& reader : *readers)
      if (reader->name() == name) return *reader;
  std::string known;
  for (const auto& reader : sceneReaders())
    if (reader->name() != "session") known += (known.empty() ? "" : ", ") + reader->name();
  throw InputError("", "--as " + name, "is not one of: " + known + kPluginHint);
}

/// The readings in few words: a message has one line.
std::string whatIsUnderstood() {
  std::string all;
  for (const auto& reader : sceneReaders()) {
    const std::string words = reader->describe();
    all += (all.empty() ? "" : ", ") + words.substr(0, std::min(words.find(" ("), words.find(", ")));
  }
  return all;
}

[[noreturn]] void refuseSeveral(const fs::path& input, const std::vector<Reading>& readings) {
  std::vector<UndecidedInput::Answer> answers;
  std::string ways, flags;
  for (const Reading& r : readings) {
    ways += (ways.empty() ? "" : ", ") + r.description + " in " + r.file.filename().string();
    flags += (flags.empty() ? "--as " : ", --as ") + r.as;
    answers.push_back({r.as, r.description + " in " + r.file.filename().string()});
  }
  throw UndecidedInput(input.string(),
                       "can be read in several ways (" + ways + "); choose one by " + flags + ", or name the file itself",
                       UndecidedInput::Question::Reading, std::move(answers));
}

/// Throws FolderBelow where something is recognised one level below: people often stand one level too high.
void lookBelow(const fs::path& folder, const std::string& what) {
  constexpr int kMostLooked = 200;  // entries: a folder of photographs has thousands, and each costs reads
  std::vector<fs::path> inside;
  std::error_code error;
  int looked = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && looked < kMostLooked; it.increment(error), ++looked)
    if (std::error_code ignored; it->is_directory(ignored)) inside.push_back(it->path());
  std::sort(inside.begin(), inside.end());
  for (const fs::path& sub : inside) {
    const std::vector<Reading> readings = readingsOf(sub);
    if (readings.empty()) continue;
    const std::string& words = readings.front().description;
    const std::string holds = words.substr(0, std::min(words.find(" ("), words.find(", ")));
    throw FolderBelow(folder.string(),
                      what + "; its folder '" + sub.filename().string() + "' is: " + holds + "; supported: " + whatIsUnderstood(),
                      sub, holds);
  }
}

[[noreturn]] void refuseUnknown(const fs::path& input) {
  std::error_code error;
  const fs::file_status status = fs::status(input, error);
  if (!fs::exists(status)) throw InputError(input.string(), "", "no such file or folder");
  const bool folder = fs::is_directory(status);
  for (const auto& reader : posedReaders())
    if (!reader->recognise(input).empty())
      throw UndecidedInput(input.string(),
                           std::string(reader->name() == "video" ? "a video without cameras" : "images without cameras") +
                               "; name their poses by --poses FILE (TUM or JSON lines) and their intrinsics by "
                               "--camera fx,fy,cx,cy[,k1,k2,p1,p2,k3]",
                           UndecidedInput::Question::Poses, {});
  if (!folder && !fs::is_regular_file(status)) throw InputError(input.string(), "", "is a device or a pipe, not a file");
  const bool empty = folder ? fs::is_empty(input, error) : fs::file_size(input, error) == 0;
  const std::string what = folder ? (empty ? "the folder is empty" : "nothing in this folder is recognised")
                                  : (empty ? "the file is empty" : "the content is not recognised");
  if (folder) lookBelow(input, what);
  throw InputError(input.string(), "", what + "; supported: " + whatIsUnderstood());
}

/// The capture of images or a video, because poses are given.
Reading posedReading(const fs::path& input, const std::string& as) {
  std::vector<Reading> readings;
  for (const auto& reader : posedReaders())
    if (fs::path file = reader->recognise(input); !file.empty() && (as.empty() || as == reader->name()))
      readings.push_back({reader->name(), reader->describe(), std::move(file)});
  if (readings.empty())
    throw InputError(input.string(), "--poses",
                     "is for a folder that holds images (PNG, JPEG, TIFF, EXR) or one video, and for a video; this is neither");
  if (readings.size() > 1) refuseSeveral(input, readings);
  return readings.front();
}

/// The reader and the file for it.
Reading chosenReading(const fs::path& input, const InputChoices& choices) {
  const std::string& as = choices.as;
  std::error_code error;
  if (!fs::exists(input, error)) refuseUnknown(input);
  if (!choices.poses.empty()) return posedReading(input, as);
  if (choices.posesByOrder) throw InputError(input.string(), "--poses-by", "is for --poses FILE, which is missing");
  if (!as.empty()) {
    const SceneReader& reader = readerNamed(as);
    const fs::path file = reader.recognise(input);
    if (file.empty()) throw InputError(input.string(), "--as " + as, "contains no " + reader.describe());
    return {as, reader.describe(), file};
  }
  std::vector<Reading> readings = readingsOf(input);
  if (readings.empty())
    for (const auto& reader : captureReaders())
      if (fs::path file = reader->incomplete(input); !file.empty()) return {reader->name(), reader->describe(), std::move(file)};
  if (readings.empty()) refuseUnknown(input);
  if (readings.size() > 1) refuseSeveral(input, readings);
  return readings.front();
}

}  // namespace

std::unique_ptr<const SceneReader> makeCaptureSceneReader(const CaptureReader& reader) {
  return std::make_unique<CaptureSceneReader>(reader);
}

const std::vector<std::unique_ptr<const SceneReader>>& sceneReaders() {
  static const std::vector<std::unique_ptr<const SceneReader>> readers = [] {
    std::vector<std::unique_ptr<const SceneReader>> list;
    list.push_back(makeSceneFileReader());
    list.push_back(makeSessionSceneReader());
    for (const auto& reader : captureReaders()) list.push_back(makeCaptureSceneReader(*reader));
    return list;
  }();
  return readers;
}

namespace {
/// From here on it is known how much memory a frame takes, before any loop over frames begins.
Scene withExpectedImages(Scene scene) {
  constexpr double kMega = 1e6;
  for (const Frame& f : scene.frames)
    if (!f.image.empty() || !f.radiance.empty() || !f.depth.empty())
      expectImages(std::min(double(f.camera.width) * double(f.camera.height) / kMega, limitOf(Limit::ImageMegapixels)));
  return scene;
}
}  // namespace

Scene readScene(const fs::path& input, const ReadOptions& options) {
  const Reading reading = chosenReading(input, options.choices);
  return withExpectedImages(readerNamed(reading.as).read(reading.file, options));
}

Scene readSceneOfSession(const fs::path& input, const ReadOptions& options) {
  const Reading reading = chosenReading(input, options.choices);
  if (reading.as == "session")
    throw InputError(reading.file.string(), "", "is a session; the input of a session must be a scene");
  return withExpectedImages(readerNamed(reading.as).read(reading.file, options));
}

fs::path recognisedFile(const fs::path& input) {
  const std::vector<Reading> readings = readingsOf(input);
  return readings.empty() ? fs::path() : readings.front().file;
}

}  // namespace glint
