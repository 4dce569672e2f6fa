// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/labels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/pipeline/summary.h"
#include "core/report/label_shapes.h"
#include "core/report/texts.h"

namespace glint {

namespace {

using json_dom::numberOrNull;
using nlohmann::ordered_json;

ordered_json pixel(const Pixel& p) { return {numberOrNull(p.x()), numberOrNull(p.y())}; }
ordered_json vector(const Eigen::Vector3d& v) { return {numberOrNull(v.x()), numberOrNull(v.y()), numberOrNull(v.z())}; }

ordered_json highlightJson(const PredictedHighlight& h) {
  ordered_json j;
  j["peak"] = pixel(h.brightest.pixel);
  j["brightest_point"] = vector(h.brightest.point.position);
  j["normal"] = vector(h.brightest.point.normal);
  j["coverage"] = numberOrNull(h.coverage);
  j["contour"] = ordered_json::array();
  for (const Pixel& p : h.contour.points) j["contour"].push_back(pixel(p));
  if (!h.sigmaPx.empty()) {
    j["sigma_px"] = ordered_json::array();
    for (const double sigma : h.sigmaPx) j["sigma_px"].push_back(numberOrNull(sigma));
  }
  j["gaps"] = ordered_json::array();
  for (const auto& [from, to] : h.gaps) j["gaps"].push_back({from, to});
  if (h.ellipse)
    j["ellipse"] = {{"centre", pixel(h.ellipse->centre)},
                    {"semi_axes", {numberOrNull(h.ellipse->semiAxes.x()), numberOrNull(h.ellipse->semiAxes.y())}},
                    {"angle_deg", numberOrNull(h.ellipse->angle * 180 / M_PI)}};
  if (h.canonical) {
    j["failed_directions"] = ordered_json::array();
    for (const DirectionResult& d : h.canonical->directions)
      if (d.failure)
        j["failed_directions"].push_back(
            {{"azimuth_deg", numberOrNull(d.azimuth * 180 / M_PI)}, {"reason", d.failure->message()}});
  }
  return j;
}

}  // namespace

std::string predictionsJson(const Inspection& inspection, const std::vector<int>& frames) {
  ordered_json j;
  j["glint_predictions"] = 1;
  j["scene"] = inspection.scene->name;
  j["models"] = ordered_json::object();
  for (const std::string& name : inspection.request.models) {
    ordered_json rows = ordered_json::array();
    for (const FrameComparison& c : inspection.models.at(name).frames) {
      if (std::find(frames.begin(), frames.end(), c.frame) == frames.end()) continue;
      ordered_json row;
      row["index"] = c.frame;
      row["id"] = inspection.scene->frames[c.frame].id;
      row["light"] = c.light;
      const bool answered = !c.prediction.highlights().empty();
      const std::string poor = answered ? poorFit(inspection.models.at(name), c) : "";
      row["status"] = !answered ? "failed" : poor.empty() ? "ok" : "poor";
      row["reason"] = !answered && c.prediction.failure() ? c.prediction.failure()->message() : poor;
      row["time_us"] = numberOrNull(c.prediction.timeUs);
      row["highlights"] = ordered_json::array();
      for (const PredictedHighlight& h : c.prediction.highlights()) row["highlights"].push_back(highlightJson(h));
      rows.push_back(row);
    }
    j["models"][name] = rows;
  }
  j["warnings"] = warningsOf(inspection);
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

namespace {

/// One picture of a COCO file.
ordered_json imageJson(const Inspection& inspection, int f, const LabelSet& labels) {
  const Frame& frame = inspection.scene->frames[static_cast<std::size_t>(f)];
  const std::string file = shownIn(inspection, frame);
  ordered_json j = {
      {"id", f}, {"file_name", file.empty() ? frame.id : file}, {"width", frame.camera.width}, {"height", frame.camera.height}};
  if (file.empty()) j["note"] = "no photograph: file_name is the frame's id";
  if (const auto why = labels.reasons.find(f); why != labels.reasons.end()) j["reason"] = why->second;
  return j;
}

ordered_json annotationJson(const LabelShape& shape, int id) {
  const Pixel corner(0.5, 0.5);  // COCO's origin is the corner of the first pixel
  ordered_json polygon = ordered_json::array();
  Eigen::AlignedBox2d box;
  for (const Pixel& p : shape.polygon.points) {
    const Pixel q = p + corner;
    polygon.push_back(numberOrNull(q.x()));
    polygon.push_back(numberOrNull(q.y()));
    box.extend(q);
  }
  return {{"id", id},
          {"image_id", shape.frame},
          {"category_id", shape.light + 1},
          {"segmentation", ordered_json::array({polygon})},
          {"bbox", {box.min().x(), box.min().y(), box.sizes().x(), box.sizes().y()}},
          {"area", shape.areaPx2},
          {"iscrowd", 0},
          {"attributes",
           {{"coverage", numberOrNull(shape.coverage)},
            {"truncated", shape.truncated},
            {"occluded", shape.occluded},
            {"edge_share", numberOrNull(shape.edgeShare)},
            {"level", shape.level}}}};
}

}  // namespace

std::string cocoJson(const Inspection& inspection, const std::string& model, const std::vector<int>& frames) {
  const LabelSet labels = labelsOf(inspection, model, frames);
  ordered_json j;
  j["info"] = {{"description", "Specular highlights predicted by Glint, model " + model}};
  if (const std::string poor = reasonsOf(inspection.models.at(model)).poor; !poor.empty())
    j["info"].update({{"status", "poor"}, {"reason", poor}});
  j["images"] = ordered_json::array();
  int without = 0;
  for (const int f : frames) {
    j["images"].push_back(imageJson(inspection, f, labels));
    without += j["images"].back().contains("note");
  }
  if (without > 0)
    j["info"]["note"] = std::to_string(without) + " of " + std::to_string(frames.size()) +
                        " images have no photograph that shows these highlights" +
                        (inspection.request.whatIf.synthesise ? " (their contours are synthesised)" : "") +
                        ": their file_name is the frame's id";
  j["annotations"] = ordered_json::array();
  for (const LabelShape& shape : labels.shapes)
    j["annotations"].push_back(annotationJson(shape, static_cast<int>(j["annotations"].size()) + 1));
  j["categories"] = ordered_json::array();
  for (std::size_t i = 0; i < labels.lights.size(); ++i)
    j["categories"].push_back(
        {{"id", static_cast<int>(i) + 1}, {"name", categoryOf(labels.lights[i])}, {"supercategory", "specular highlight"}});
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

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

namespace {

using json_dom::numberOrNull;
using nlohmann::ordered_json;

/// ASCII: an id comes from others, and the line may end on a terminal.
std::string asLine(const ordered_json& j) { return j.dump(-1, ' ', true, ordered_json::error_handler_t::replace) + "\n"; }

ordered_json liveHighlight(const LiveHighlights& of, const PredictedHighlight& h, const Camera& camera) {
  ordered_json j;
  j["light"] = of.light;
  j["model"] = of.model;
  j["status"] = of.poor.empty() ? "ok" : "poor";
  const auto pixel = [](const Pixel& p) { return ordered_json::array({numberOrNull(p.x()), numberOrNull(p.y())}); };
  j["peak"] = pixel(h.brightest.pixel);
  j["coverage"] = numberOrNull(h.coverage);
  j["contour"] = ordered_json::array();
  for (const Pixel& p : h.contour.points) j["contour"].push_back(pixel(p));
  if (camera.hasDistortion()) {
    j["contour_measured"] = ordered_json::array();
    for (const Pixel& p : h.contour.points) j["contour_measured"].push_back(pixel(camera.distorted(p)));
  }
  if (!h.sigmaPx.empty()) {
    j["sigma_px"] = ordered_json::array();
    for (const double sigma : h.sigmaPx) j["sigma_px"].push_back(numberOrNull(sigma));
  }
  if (!h.gaps.empty()) {
    j["gaps"] = ordered_json::array();
    for (const auto& [from, to] : h.gaps) j["gaps"].push_back({from, to});
  }
  return j;
}

}  // namespace

std::string liveLine(const LivePose& pose, const LiveAnswer& answer, double timeUs) {
  ordered_json highlights = ordered_json::array(), failures = ordered_json::array();
  std::string reason, poor;
  bool anyOk = false;
  for (const LiveHighlights& of : answer.highlights) {
    if (!of.prediction.highlights().empty()) {
      anyOk = anyOk || of.poor.empty();
      if (poor.empty() && !of.poor.empty()) poor = of.model + ": " + of.poor;
    }
    for (const PredictedHighlight& h : of.prediction.highlights()) highlights.push_back(liveHighlight(of, h, answer.camera));
    const Failure* const why = of.prediction.failure();
    if (!why) continue;
    failures.push_back({{"light", of.light}, {"model", of.model}, {"reason", why->message()}});
    if (reason.empty()) reason = why->message();
  }
  const bool found = !highlights.empty();
  if (reason.empty() && !found) reason = "no light with a fitted model is on in this frame";
  ordered_json j;
  j["id"] = pose.id;
  j["time"] = pose.time ? numberOrNull(*pose.time) : ordered_json();
  j["frame"] = answer.frame ? ordered_json(*answer.frame) : ordered_json();
  j["status"] = !found ? "failed" : anyOk ? "ok" : "poor";
  j["reason"] = !found ? reason : anyOk ? "" : poor;
  j["highlights"] = std::move(highlights);
  j["failures"] = std::move(failures);
  j["time_us"] = numberOrNull(timeUs);
  return asLine(j);
}

std::string liveRefusal(const std::string& id, std::size_t line, const std::string& status, const std::string& reason) {
  ordered_json j;
  j["id"] = id.empty() ? ordered_json() : ordered_json(id);
  j["time"] = nullptr;
  j["frame"] = nullptr;
  j["status"] = status;
  j["reason"] = messageLine(reason);
  j["line"] = line;
  j["highlights"] = ordered_json::array();
  j["failures"] = ordered_json::array();
  j["time_us"] = nullptr;
  return asLine(j);
}

}  // namespace glint
