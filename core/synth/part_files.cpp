// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/part_files.h"

#include <unistd.h>

#include "core/base/atomic_file.h"
#include "core/base/atomic_folder.h"
#include "core/base/json_dom.h"
#include "core/base/outcome.h"
#include "core/base/output_place.h"
#include "core/base/part_file.h"
#include "core/base/permitted.h"
#include "core/base/sha256.h"
#include "core/synth/output_folder.h"
#include "core/synth/part.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using json_dom::Json;

constexpr const char* kParts = "parts";
constexpr const char* kKind = "glint_synth";

bool hasPart(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder / kParts, error), end; !error && it != end; it.increment(error)) {
    try {
      if (it->path().extension() == ".json" && readPart(it->path().string()).kind == kKind) return true;
    } catch (const InputError&) {
      // another file
    }
  }
  return false;
}

/// Folders that are made before the files are moved there: shards that end at the same moment must not take each other's new folders for
/// their own. Those that stay empty are removed again.
class Folders {
 public:
  void make(const fs::path& folder) {
    std::vector<fs::path> missing;
    std::error_code error;
    for (fs::path p = folder; !p.empty() && !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path())
      missing.push_back(p);
    fs::create_directories(folder, error);
    if (error && !fs::is_directory(folder)) throw InputError(folder.string(), "", "cannot be created: " + error.message());
    made_.insert(made_.end(), missing.rbegin(), missing.rend());
  }
  Folders() = default;
  ~Folders() {
    for (auto p = made_.rbegin(); p != made_.rend(); ++p) ::rmdir(p->c_str());  // refused where something lies in it
  }
  Folders(const Folders&) = delete;
  Folders& operator=(const Folders&) = delete;

 private:
  std::vector<fs::path> made_;
};

Json withoutFrames(Json scene) {
  scene.erase("frames");
  return scene;
}

}  // namespace

SynthPartFiles::SynthPartFiles(fs::path folder, const Shard& shard, std::vector<fs::path> names)
    : folder_(std::move(folder)),
      file_(folder_ / kParts / (std::to_string(shard.index) + "-of-" + std::to_string(shard.of) + ".json")),
      names_(std::move(names)) {
  std::vector<fs::path> checked = names_;
  checked.push_back(fs::path(kParts) / file_.filename());
  if (!hasPart(folder_)) requireSynthFolder(folder_, checked);
  expectOutput(folder_, [] { return true; });  // other shards write there too meanwhile; a link is none of theirs
}

void SynthPartFiles::write(const std::function<std::string(const fs::path&)>& make) const {
  Folders folders;
  folders.make(file_.parent_path());
  for (const fs::path& name : names_) folders.make((folder_ / name).parent_path());
  atomicFiles(folder_, (fs::path(kParts) / file_.filename()).string(), [&](const fs::path& out) {
    const std::string text = make(out);
    std::error_code error;
    fs::create_directories(out / kParts, error);
    if (error) throw InputError((out / kParts).string(), "", "cannot be created: " + error.message());
    atomicWrite(out / kParts / file_.filename(), text);
  });
}

std::string synthPartText(const SynthPartContent& c, const Shard& shard, const std::string& program, int first, int end) {
  Json document = {{kKind, 1}, {"scene", json_dom::parse(c.sceneText, (c.written / "scene.json").string())}};
  Json& frames = document["scene"]["frames"];
  const int all = static_cast<int>(frames.size());
  Json own = Json::array();
  for (int i = first; i < end; ++i) own.push_back(std::move(frames.at(static_cast<std::size_t>(i))));
  frames = std::move(own);
  Json files = Json::object();
  for (const fs::path& file : c.files) json_dom::append(files, file.generic_string(), sha256OfFile(c.written / file));
  document["shard"] = {{"first_frame", first},
                       {"scene_frames", all},
                       {"spec", sha256OfFile(c.specFile)},
                       {"brightest", c.top},
                       {"files", std::move(files)}};
  return partText(document.dump(), shard, program);
}

MergedSynth mergedSynth(const std::vector<std::string>& files, const fs::path& sceneFile) {
  const std::vector<PartFile> parts = readParts(files);
  const PartFile& first = parts.front();
  if (first.kind != kKind) throw InputError(first.file, "", "is no part of a synthetic scene");
  const fs::path folder = fs::absolute(sceneFile).lexically_normal().parent_path();
  MergedSynth merged;
  Json frames = Json::array(), scene;
  for (const PartFile& part : parts) {
    if (part.checked.at(kKind).integer() != 1) part.checked.at(kKind).fail("only version 1 is supported");
    if (realPath(fs::absolute(part.file)).parent_path().parent_path() != realPath(folder))
      throw InputError(part.file, "",
                       "does not lie in the folder parts beside " + sceneFile.string() + ", whose frames it lists");
    for (const char* key : {"shard.spec", "shard.scene_frames", "shard.brightest"}) requireSame(first, part, key);
    const JsonNode own = part.checked.at("scene").at("frames"), about = part.checked.at("shard");
    if (!own.isArray()) own.fail("must be an array");
    Json read = json_dom::parse(part.checked.at("scene").dump(), part.file);
    if (&part == &first) scene = withoutFrames(read);
    if (withoutFrames(read) != scene) throw InputError(part.file, "scene", "is another one than that of " + first.file);
    if (about.at("first_frame").integer() != static_cast<int>(frames.size()))
      throw InputError(part.file, "shard.first_frame",
                       "must be " + std::to_string(frames.size()) + ", behind the part before it");
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (const std::optional<JsonNode> h = own.at(i).find("highlights")) merged.highlights += static_cast<int>(h->size());
      frames.push_back(std::move(read.at("frames").at(i)));
    }
    const JsonNode written = about.at("files");
    for (const std::string& name : written.keys()) {
      const fs::path file = resolveInside(folder, name, {}, part.file, "shard.files");
      std::error_code ignored;  // what cannot be asked about is missing
      if (!fs::is_regular_file(file, ignored))
        throw InputError(part.file, "shard.files", name + " is missing; repeat shard " + part.shard.text());
      if (sha256OfFile(file) != written.at(name).text())
        throw InputError(part.file, "shard.files", name + " is not what this shard wrote; repeat shard " + part.shard.text());
    }
  }
  merged.frames = static_cast<int>(frames.size());
  if (first.checked.at("shard").at("scene_frames").integer() != merged.frames)
    throw InputError(parts.back().file, "scene.frames", "the parts have " + std::to_string(merged.frames) + " frames, not all");
  // In the place where scene files have them.
  Json whole = json_dom::parse(first.checked.at("scene").dump(), first.file);
  whole["frames"] = std::move(frames);
  merged.sceneJson = prettyJson(json_dom::textWithPaths(whole, sceneFile.string()));
  return merged;
}

}  // namespace glint
