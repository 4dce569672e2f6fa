// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/masks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>
#include <sstream>

#include "core/base/atomic_file.h"
#include "core/base/progress.h"
#include "core/codecs/codecs.h"
#include "core/geometry/polyline.h"
#include "core/report/labels.h"
#include "core/scene/outputs.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Pixels whose centres are inside.
void fill(const Polyline& contour, Image& mask) {
  Eigen::AlignedBox2d box;
  for (const Pixel& p : contour.points) box.extend(p);
  box = box.intersection(Eigen::AlignedBox2d(Pixel(0, 0), Pixel(mask.width - 1.0, mask.height - 1.0)));
  for (int y = static_cast<int>(std::ceil(box.min().y())); y <= box.max().y(); ++y)
    for (int x = static_cast<int>(std::ceil(box.min().x())); x <= box.max().x(); ++x)
      if (contains(contour, {x, y})) mask.at(x, y) = 255;
}

std::string folderName(const std::string& id) {
  std::string name;
  for (const char c : id) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    name += plain ? c : '_';
  }
  return name.empty() || name.find_first_not_of('.') == std::string::npos ? "light" : name;
}

/// Different lights get different folders, even if only a replaced letter tells them apart.
std::map<std::string, std::string> lightFolders(const std::set<std::string>& lights) {
  std::map<std::string, std::string> folders;
  std::set<std::string> taken;
  for (const std::string& light : lights) {
    std::string name = folderName(light);
    for (int n = 2; !taken.insert(name).second; ++n) name = folderName(light) + "-" + std::to_string(n);
    folders[light] = name;
  }
  return folders;
}

struct Task {
  int frame;
  std::string light, of;
  std::vector<Polyline> contours;
  std::string reason;
};

std::vector<Task> tasksOf(const Inspection& inspection, const std::set<std::string>& lights) {
  std::vector<Task> tasks;
  for (const FrameEvidence& e : inspection.evidence)
    for (const std::string& light : lights) {
      Task task{e.frame, light, "observed", {}, ""};
      for (const Highlight& h : e.scored())
        if (h.light == light) task.contours.push_back(h.contour);
      if (task.contours.empty()) task.reason = e.scoringFailure() ? e.scoringFailure()->message() : "no highlight of this light";
      tasks.push_back(std::move(task));
    }
  for (const std::string& model : inspection.request.models) {
    std::map<std::pair<int, std::string>, const FrameComparison*> answers;
    for (const FrameComparison& c : inspection.models.at(model).frames) answers[{c.frame, c.light}] = &c;
    for (int f = 0; f < static_cast<int>(inspection.scene->frames.size()); ++f)
      for (const std::string& light : lights) {
        Task task{f, light, model, {}, ""};
        const auto found = answers.find({f, light});
        if (found == answers.end()) {
          task.reason = "not predicted: the light is off in this frame";
        } else {
          const Prediction& p = found->second->prediction;
          for (const PredictedHighlight& h : p.highlights()) task.contours.push_back(h.contour);
          if (p.failure()) task.reason = p.failure()->message();
        }
        tasks.push_back(std::move(task));
      }
  }
  return tasks;
}

void writeMask(const Image& mask, const fs::path& file) {
  cv::Mat pixels(mask.height, mask.width, CV_8UC1);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) pixels.at<unsigned char>(y, x) = static_cast<unsigned char>(mask.at(x, y));
  std::vector<unsigned char> bytes;
  if (!encodeWithOpenCv(".png", pixels, bytes)) throw InputError(file.string(), "", "cannot encode the mask as PNG");
  atomicWrite(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace

Image maskOf(const std::vector<Polyline>& contours, const Camera& camera) {
  Image mask(camera.width, camera.height, 1);
  for (const Polyline& contour : contours) {
    Polyline drawn{{}, true};
    for (const Pixel& p : contour.points) {
      const Pixel d = camera.distorted(p);
      if (d.allFinite()) drawn.points.push_back(d);
    }
    if (drawn.points.size() >= 3) fill(drawn, mask);
  }
  return mask;
}

LabelFormats labelFormatsFrom(const std::string& list) {
  LabelFormats formats{false, false, false};
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    if (word == "coco")
      formats.coco = true;
    else if (word == "masks")
      formats.masks = true;
    else if (word == "yolo")
      formats.yolo = true;
    else
      throw InputError("", "--labels", "'" + word + "' is not one of: coco, masks, yolo");
  }
  if (!formats.coco && !formats.masks && !formats.yolo) throw InputError("", "--labels", "names no format: coco, masks, yolo");
  return formats;
}

namespace {

void writeMasks(const Inspection& inspection, const std::vector<int>& frames, const fs::path& out, const ProgressFn& progress) {
  std::set<std::string> lights;
  for (const FrameEvidence& e : inspection.evidence)
    for (const Highlight& h : e.scored())
      if (!h.light.empty()) lights.insert(h.light);
  for (const auto& [name, model] : inspection.models)
    for (const FrameComparison& c : model.frames) lights.insert(c.light);
  const std::map<std::string, std::string> folders = lightFolders(lights);
  std::vector<Task> tasks = tasksOf(inspection, lights);
  const std::set<int> wanted(frames.begin(), frames.end());
  tasks.erase(std::remove_if(tasks.begin(), tasks.end(), [&](const Task& t) { return !wanted.count(t.frame); }), tasks.end());

  std::vector<std::string> of = {"observed"};
  of.insert(of.end(), inspection.request.models.begin(), inspection.request.models.end());
  for (const std::string& source : of)
    for (const auto& [light, name] : folders) fs::create_directories(out / "masks" / source / name);
  const auto fileOf = [&](const Task& t) {
    const std::string name = pictureName(inspection.scene->frames[static_cast<std::size_t>(t.frame)]);
    return fs::path("masks") / t.of / folders.at(t.light) / name;
  };
  std::vector<long long> pixels(tasks.size());
  parallelFor(
      static_cast<int>(tasks.size()),
      [&](int i) {
        const Task& t = tasks[static_cast<std::size_t>(i)];
        const Image mask = maskOf(t.contours, inspection.scene->frames[static_cast<std::size_t>(t.frame)].camera);
        pixels[static_cast<std::size_t>(i)] = std::count(mask.data.begin(), mask.data.end(), 255.f);
        writeMask(mask, out / fileOf(t));
      },
      progress, "masks");
  ordered_json j;
  j["glint_masks"] = 1;
  j["scene"] = inspection.scene->name;
  j["masks"] = ordered_json::array();
  for (std::size_t i = 0; i < tasks.size(); ++i)
    j["masks"].push_back({{"frame", tasks[i].frame},
                          {"id", inspection.scene->frames[static_cast<std::size_t>(tasks[i].frame)].id},
                          {"light", tasks[i].light},
                          {"of", tasks[i].of},
                          {"file", fileOf(tasks[i]).generic_string()},
                          {"pixels", pixels[i]},
                          {"reason", tasks[i].reason}});
  atomicWrite(out / "masks.json", j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace

void writeLabels(const Inspection& inspection, const fs::path& folder, const ProgressFn& progress, const LabelFormats& formats,
                 const std::vector<int>& frames) {
  std::vector<int> labelled = frames;
  if (labelled.empty())
    for (int f = 0; f < static_cast<int>(inspection.scene->frames.size()); ++f) labelled.push_back(f);
  atomicFolder(folder, [&](const fs::path& out) {
    if (formats.masks) writeMasks(inspection, labelled, out, progress);
    for (const std::string& model : inspection.request.models) {
      if (!report(progress, {"labels " + model, 0, 0})) throw Stopped{};
      if (formats.coco) atomicWrite(out / ("labels_" + model + ".json"), cocoJson(inspection, model, labelled));
      if (formats.yolo) writeYolo(inspection, model, labelled, out / "yolo" / model);
    }
  });
}

}  // namespace glint
