// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/command_text.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "core/base/permitted.h"
#include "core/capture/capture.h"
#include "core/scene/frame_spec.h"
#include "core/scene/scene_files.h"

namespace glint {

namespace {
/// As short as it can be without losing a bit.
std::string shortest(double v) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
  return std::string(buffer, end);
}

std::string text(const SettingValue& value) {
  if (const auto* s = std::get_if<std::string>(&value)) return *s;
  if (const auto* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
  if (const auto* i = std::get_if<int>(&value)) return std::to_string(*i);
  return shortest(std::get<double>(value));
}

/// Whether a file lies where the command needs permission to look. The inspector remembers permissions, a command does not.
bool namesFilesOutside(const Scene& scene) {
  if (scene.allowOutsidePaths) return true;
  std::vector<std::filesystem::path> named{std::filesystem::absolute(scene.file).parent_path()};
  for (const FilesFolder& f : scene.folders) named.push_back(f.folder);
  for (const auto& [mesh, file] : scene.meshes) named.push_back(file);
  for (const std::filesystem::path& folder : foldersOfCapture(scene.file)) named.push_back(folder);
  if (!scene.choices.surfaceFile.empty()) named.push_back(scene.choices.surfaceFile);
  const std::vector<std::filesystem::path> files = filesOf(scene);
  return std::any_of(files.begin(), files.end(), [&](const std::filesystem::path& file) { return !liesIn(named, file); });
}

}  // namespace

std::string shellWord(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string("_-./=:,+@%").find(c) != std::string::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

Outcome<std::string> commandOf(const Scene& scene, const InspectionRequest& q) {
  if (!q.whatIf.none()) return Failure{Reason::NotSupported, "a what-if has no flag; save a session and use it as INPUT"};
  const InspectionRequest usual;
  // The command is pasted into a shell in another folder.
  const auto absolute = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  };
  const auto place = [&](const std::filesystem::path& path) { return shellWord(absolute(path)); };
  std::string command = "glint evaluate " + place(scene.file);
  if (q.models != usual.models) {
    std::string models;
    for (const std::string& m : q.models) models += (models.empty() ? "" : ",") + m;
    command += " --models " + shellWord(models);
  }
  if (q.train != usual.train) command += " --train " + shellWord(q.train);
  if (!q.excluded.empty()) {
    const std::string spec = frameSpec(q.excluded, scene);
    bool readsBack = false;
    try {
      readsBack = parseFrames(spec, scene, "--exclude") == q.excluded;
    } catch (const InputError&) {
      // Ids with commas that read like numbers.
    }
    if (!readsBack)
      return Failure{Reason::NotSupported, "the excluded frames cannot be written as a SPEC; save a session and use it as INPUT"};
    command += " --exclude " + shellWord(spec);
  }
  if (q.source != usual.source) command += q.source == FrameSource::Image ? " --source image" : " --source radiance";
  for (const auto& [key, value] : q.settings.values()) command += " --set " + shellWord(key + "=" + text(value));
  if (q.noisePx > 0) command += " --noise-px " + shortest(q.noisePx) + " --seed " + std::to_string(q.seed);
  if (!q.truthFolder.empty()) command += " --truth " + place(q.truthFolder);
  if (namesFilesOutside(scene)) command += " --allow-outside";
  for (const FilesFolder& f : scene.folders)
    command += f.kind == FrameFile::Photograph ? " --photographs " + place(f.folder)
                                               : " --files " + shellWord(nameOf(f.kind) + ("=" + absolute(f.folder)));
  for (const ChoiceOption& option : choiceOptions())
    if (const std::string choice = option.textOf(scene.choices); !choice.empty())
      command += std::string(" ") + option.flag + " " + shellWord(choice);
  for (const auto& [named, file] : scene.meshes) command += " --mesh " + shellWord(named + "=" + absolute(file));
  return command;
}

}  // namespace glint
