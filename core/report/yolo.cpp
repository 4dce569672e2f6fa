// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/yolo.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/report/label_shapes.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using json_dom::numberOrNull;
using nlohmann::ordered_json;

/// "0 0.5 0.25 ...": nine digits are 1e-4 px in the widest image that is read.
std::string yoloLine(const LabelShape& shape, const Camera& camera) {
  std::string line = std::to_string(shape.light);
  for (const Pixel& p : shape.polygon.points)
    line += formatted(" %.9f %.9f", (p.x() + 0.5) / camera.width, (p.y() + 0.5) / camera.height);
  return line + "\n";
}

ordered_json noteOf(const LabelShape& shape, const LabelSet& labels, std::size_t line) {
  return {{"line", line},
          {"class", shape.light},
          {"light", labels.lights[static_cast<std::size_t>(shape.light)]},
          {"coverage", numberOrNull(shape.coverage)},
          {"truncated", shape.truncated},
          {"occluded", shape.occluded},
          {"edge_share", numberOrNull(shape.edgeShare)},
          {"level", shape.level}};
}

}  // namespace

std::vector<std::string> yoloNames(const Scene& scene, const std::vector<int>& frames) {
  std::vector<std::string> names;
  std::set<std::string> different;
  for (const int f : frames) {
    const Frame& frame = scene.frames[static_cast<std::size_t>(f)];
    const fs::path& file = frame.image.empty() ? frame.radiance : frame.image;
    names.push_back(fileNameOf(file.empty() ? frame.id : file.stem().string()));
    different.insert(names.back());
  }
  if (different.size() == frames.size()) return names;
  for (std::size_t i = 0; i < frames.size(); ++i) names[i] = fileNameOf(scene.frames[static_cast<std::size_t>(frames[i])].id);
  return names;
}

void writeYolo(const Inspection& inspection, const std::string& model, const std::vector<int>& frames, const fs::path& folder) {
  const LabelSet labels = labelsOf(inspection, model, frames);
  std::map<int, std::vector<const LabelShape*>> byFrame;
  for (const LabelShape& shape : labels.shapes) byFrame[shape.frame].push_back(&shape);
  const std::vector<std::string> names = yoloNames(*inspection.scene, frames);
  ordered_json notes = {{"glint_yolo", 1}, {"model", model}, {"files", ordered_json::array()}};
  fs::create_directories(folder / "labels");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = inspection.scene->frames[static_cast<std::size_t>(frames[i])];
    const std::string file = "labels/" + names[i] + ".txt";
    ordered_json note = {{"file", file},
                         {"frame", frames[i]},
                         {"id", frame.id},
                         {"image", shownIn(inspection, frame)},
                         {"width", frame.camera.width},
                         {"height", frame.camera.height},
                         {"reason", ""},
                         {"highlights", ordered_json::array()}};
    if (const auto why = labels.reasons.find(frames[i]); why != labels.reasons.end()) note["reason"] = why->second;
    std::string text;
    for (const LabelShape* shape : byFrame[frames[i]]) {
      text += yoloLine(*shape, frame.camera);
      note["highlights"].push_back(noteOf(*shape, labels, note["highlights"].size()));
    }
    atomicWrite(folder / file, text);
    notes["files"].push_back(std::move(note));
  }
  std::string classes;
  for (const std::string& light : labels.lights) classes += categoryOf(light) + "\n";
  atomicWrite(folder / "classes.txt", classes);
  atomicWrite(folder / "notes.json", notes.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace glint
