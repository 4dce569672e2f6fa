// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/labels.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/base/json_dom.h"
#include "core/report/warnings.h"

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

/// The file that shows a frame's highlights, relative to the scene; "" where there is none: the scene names no picture, the file is
/// not there, or the highlights are synthesised and the photograph shows others.
std::string photographOf(const Inspection& inspection, const Frame& frame) {
  const std::filesystem::path file = frame.image.empty() ? frame.radiance : frame.image;
  std::error_code ignored;  // what cannot be asked about is not there
  if (file.empty() || frame.ofVideo || inspection.request.whatIf.synthesise || !std::filesystem::exists(file, ignored)) return {};
  return file.lexically_relative(inspection.scene->folder).generic_string();
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
      row["status"] = c.prediction.highlights().empty() ? "failed" : "ok";
      row["reason"] = c.prediction.highlights().empty() && c.prediction.failure() ? c.prediction.failure()->message() : "";
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

std::string cocoJson(const Inspection& inspection, const std::string& model, const std::vector<int>& frames) {
  ordered_json j;
  j["info"] = {{"description", "Specular highlights predicted by Glint, model " + model}};
  j["images"] = ordered_json::array();
  j["annotations"] = ordered_json::array();
  j["categories"] = ordered_json::array();
  std::vector<std::string> lights;
  int without = 0;
  for (const int f : frames) {
    const Frame& frame = inspection.scene->frames[f];
    const std::string file = photographOf(inspection, frame);
    without += file.empty();
    j["images"].push_back({{"id", f},
                           {"file_name", file.empty() ? frame.id : file},
                           {"width", frame.camera.width},
                           {"height", frame.camera.height}});
    if (file.empty()) j["images"].back()["note"] = "no photograph: file_name is the frame's id";
  }
  if (without > 0)
    j["info"]["note"] = std::to_string(without) + " of " + std::to_string(frames.size()) +
                        " images have no photograph that shows these highlights" +
                        (inspection.request.whatIf.synthesise ? " (their contours are synthesised)" : "") +
                        ": their file_name is the frame's id";
  int id = 1;
  for (const FrameComparison& c : inspection.models.at(model).frames) {
    if (std::find(frames.begin(), frames.end(), c.frame) == frames.end()) continue;
    auto light = std::find(lights.begin(), lights.end(), c.light);
    if (light == lights.end()) light = lights.insert(lights.end(), c.light);
    const Camera& camera = inspection.scene->frames[c.frame].camera;
    for (const PredictedHighlight& h : c.prediction.highlights()) {
      Polyline drawn{{}, true};
      for (const Pixel& p : h.contour.points)
        if (const Pixel d = camera.distorted(p); d.allFinite()) drawn.points.push_back(d + Pixel(0.5, 0.5));
      if (drawn.points.size() < 3) continue;
      ordered_json polygon = ordered_json::array();
      Pixel low = drawn.points[0], high = low;
      for (const Pixel& p : drawn.points) {
        polygon.push_back(numberOrNull(p.x()));
        polygon.push_back(numberOrNull(p.y()));
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
      j["annotations"].push_back({{"id", id++},
                                  {"image_id", c.frame},
                                  {"category_id", static_cast<int>(light - lights.begin()) + 1},
                                  {"segmentation", ordered_json::array({polygon})},
                                  {"bbox", {low.x(), low.y(), high.x() - low.x(), high.y() - low.y()}},
                                  {"area", std::abs(signedArea(drawn))},
                                  {"iscrowd", 0}});
    }
  }
  for (std::size_t i = 0; i < lights.size(); ++i)
    j["categories"].push_back(
        {{"id", static_cast<int>(i) + 1}, {"name", "highlight " + lights[i]}, {"supercategory", "specular highlight"}});
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace glint
