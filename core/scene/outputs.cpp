// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/outputs.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <sstream>

#include "core/base/found_file.h"
#include "core/base/json_text.h"
#include "core/base/number_text.h"
#include "core/base/output_place.h"
#include "core/base/safe_text.h"
#include "core/scene/scene_files.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kSessionKey = "glint_session";
constexpr const char* kWorkKey = "glint_tradeoff_work";  // beside another output, by that one's name

/// MP4 ("ftyp" after its length), WebM and Matroska (EBML), AVI (RIFF ... AVI).
bool isMovie(const std::string& head) {
  return head.compare(4, 4, "ftyp") == 0 || head.starts_with("\x1a\x45\xdf\xa3") ||
         (head.starts_with("RIFF") && head.compare(8, 4, "AVI ") == 0);
}

/// A first line of digits alone, and below it a name and three numbers: other lists begin with their length, too.
bool isLightPositions(const std::string& head) {
  std::istringstream lines(head);
  std::string count, first;
  if (!std::getline(lines, count) || !std::getline(lines, first)) return false;
  if (!count.empty() && count.back() == '\r') count.pop_back();
  if (count.empty() || count.find_first_not_of("0123456789") != std::string::npos) return false;
  std::istringstream words(first);
  const std::vector<std::string> found{std::istream_iterator<std::string>(words), {}};
  return found.size() >= 4 &&
         std::all_of(found.end() - 3, found.end(), [](const std::string& word) { return numberFrom(word).has_value(); });
}

}  // namespace

OutputKind OutputKind::document(const std::string& key) {
  const std::string ending = key == kSessionKey ? ".glint" : ".json";
  return {Form::Document, key, "a JSON file with \"" + key + "\"",
          key == kWorkKey ? std::vector<std::string>{} : std::vector<std::string>{ending}};
}
OutputKind OutputKind::table(const std::string& start) {
  return {Form::Table, start, "a table written by this command", {".csv"}};
}
OutputKind OutputKind::page() { return {Form::Page, "", "a page written by this command", {".html", ".htm"}}; }
OutputKind OutputKind::png() { return {Form::Png, "", "a PNG file", {".png"}}; }
OutputKind OutputKind::movie() { return {Form::Movie, "", "a movie", {}}; }  // its ending chooses how it is encoded
OutputKind OutputKind::lightPositions() { return {Form::LightPositions, "", "a list of light positions (.lp)", {".lp"}}; }

bool OutputKind::mayBeNamed(const fs::path& file) const {
  // Endings by which programs choose a format; other endings promise nothing.
  static const std::set<std::string> promises{
      ".bin", ".bmp",  ".csv", ".data", ".docx", ".eps",  ".exr", ".gif",  ".glint", ".hdr",  ".htm", ".html", ".jpeg",
      ".jpg", ".json", ".lp",  ".md",   ".mp4",  ".obj",  ".ods", ".pdf",  ".pgm",   ".ply",  ".png", ".pnm",  ".ppm",
      ".ps",  ".stl",  ".svg", ".tif",  ".tiff", ".webp", ".xls", ".xlsx", ".xml",   ".yaml", ".yml", ".zip"};
  const std::string ending = lowerEnding(file);
  if (form_ == Form::Png && !ending.empty()) return ending == endings_.front();
  return endings_.empty() || promises.count(ending) == 0 || std::count(endings_.begin(), endings_.end(), ending) > 0;
}

bool OutputKind::holds(const fs::path& file) const {
  std::error_code ignored;  // a folder that cannot be looked at counts as not empty
  if (fs::file_size(file, ignored) == 0) return true;
  constexpr std::size_t kHead = 400;  // the title of a page stands within it
  const std::string head = firstBytes(file, std::max(kHead, key_.size()));
  switch (form_) {
    case Form::Document: return documentKind(file) == key_;
    case Form::Table: return head.starts_with(key_);
    case Form::Page: return head.starts_with("<!doctype html>") && head.find("<title>Glint") != std::string::npos;
    case Form::Png: return head.starts_with("\x89PNG\r\n\x1a\n");
    case Form::LightPositions: return isLightPositions(head);
    case Form::Movie: return head.size() >= 12 && isMovie(head);
  }
  return false;
}

Outputs::Outputs(const std::vector<fs::path>& inputs) : inputs_(inputs) {}

Outputs::Outputs(const std::string& input, const Scene& scene) : inputs_(filesOf(scene)) {
  inputs_.emplace_back(input);
  std::error_code ignored;                                                         // unreadable counts as no folder
  if (fs::is_directory(input, ignored)) inputs_.push_back(recognisedFile(input));  // a session is no file of its scene
}

void Outputs::requireNoInput(const fs::path& file, const std::string& flag) const {
  std::error_code ignored;  // a path that cannot be looked at counts as another file
  for (const fs::path& input : inputs_)
    if (!input.empty() && fs::equivalent(file, input, ignored))
      throw InputError(file.string(), flag, "is an input file and is never overwritten; choose another file");
}

void Outputs::file(const std::string& file, const std::string& flag, const OutputKind& kind) {
  if (file.empty() || file == "-") return;
  const fs::path path = fs::absolute(file).lexically_normal();
  if (std::find(asked_.begin(), asked_.end(), path) != asked_.end())
    throw InputError(file, flag, "is already used for another output; choose another file");
  asked_.push_back(path);
  std::error_code ignored;
  const bool exists = fs::exists(path, ignored), device = exists && !fs::is_regular_file(path, ignored);
  if (exists) requireNoInput(file, flag);
  if (device) return;
  if (exists && !kind.holds(path))
    throw InputError(
        file, flag,
        "already exists and is not " + kind.words() + "; nothing is overwritten: choose another file or remove this one");
  if (!kind.mayBeNamed(path))
    throw InputError(file, flag,
                     "this command writes " + kind.words() + ": the file's name must end in " + kind.endings().front());
  expectOutput(path, [path, kind] {
    std::error_code gone;
    return !fs::exists(path, gone) || (fs::is_regular_file(path, gone) && kind.holds(path));
  });
}

void Outputs::inFolder(const std::string& folder, const std::string& flag, const std::vector<std::string>& names,
                       const std::string& marker, const std::string& documentKey) {
  if (folder.empty()) return;
  const fs::path place = fs::absolute(folder);
  const auto isThere = [place](const std::string& name) {
    std::error_code ignored;  // a file that cannot be looked at counts as missing
    return fs::exists(place / name, ignored);
  };
  const auto isOurs = [place, marker, documentKey] { return documentKind(place / marker) == documentKey; };
  for (const std::string& name : names)
    if (isThere(name)) requireNoInput(fs::path(folder) / name, flag);
  const auto first = isOurs() ? names.end() : std::find_if(names.begin(), names.end(), isThere);
  if (first != names.end())
    throw InputError((fs::path(folder) / *first).string(), flag,
                     "already exists and was not written by this command; nothing is overwritten: choose another folder");
  expectOutput(folder, [names, isThere, isOurs] { return isOurs() || std::none_of(names.begin(), names.end(), isThere); });
}

std::string pictureName(const Frame& frame, const std::string& part) { return fileNameOf(frame.id) + part + ".png"; }

std::vector<std::string> picturesOf(const Scene& scene, const std::vector<int>& frames) {
  std::vector<std::string> names;
  for (const int frame : frames) names.push_back(pictureName(scene.frames[static_cast<std::size_t>(frame)]));
  return names;
}

}  // namespace glint
