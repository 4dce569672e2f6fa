// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/share.h"

#include <algorithm>
#include <set>

#include "core/base/bytes.h"
#include "core/base/html_text.h"
#include "core/base/sha256.h"
#include "core/draw/colours.h"
#include "core/model/models.h"
#include "core/pipeline/frame_score.h"
#include "core/report/share_parts.h"

namespace glint {
namespace share {
namespace {

/// All frames; of a long sequence those that train and evenly chosen ones.
std::vector<int> framesOf(const Inspection& inspection, const ShareChoice& choice) {
  const int n = static_cast<int>(inspection.scene->frames.size());
  for (const int frame : choice.frames) require(frame >= 0 && frame < n, "sharePage: a frame does not exist");
  if (!choice.frames.empty()) return choice.frames;
  std::set<int> chosen;
  if (n > kMostSharedFrames)
    for (const int frame : inspection.train.frames)
      if (static_cast<int>(chosen.size()) < kMostSharedFrames / 2) chosen.insert(frame);
  const int rest = std::min(n, kMostSharedFrames - static_cast<int>(chosen.size()));
  for (int i = 0; i < rest; ++i) chosen.insert(static_cast<int>(static_cast<long long>(i) * n / rest));
  return {chosen.begin(), chosen.end()};
}

std::string modelsJson(const Inspection& inspection) {
  std::string json;
  for (const std::string& name : modelsInOrder(inspection)) {
    const HighlightModel* const model = findModel(name);
    json += (json.empty() ? "" : ",") + std::string("{\"id\":") + quoted(name) + ",\"colour\":" + quoted(modelHex(name)) +
            ",\"title\":" + quoted(model ? model->title() : name) +
            ",\"assumption\":" + quoted(model ? model->assumption() : "") + "}";
  }
  return "[" + json + "]";
}

/// What is selected first, and from where the scene is seen; without a session the page chooses.
std::string viewJson(const Inspection& inspection, const ShareChoice& choice, const std::vector<int>& frames) {
  int frame = -1;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool named = inspection.scene->frames[static_cast<std::size_t>(frames[i])].id == choice.view.frame;
    if (named || (frame < 0 && choice.view.frame.empty() && inspection.isHeldOut(frames[i]))) frame = static_cast<int>(i);
    if (named) break;
  }
  std::string json = "{\"frame\":" + std::to_string(std::max(frame, 0)) + ",\"model\":" + quoted(choice.view.model);
  if (const auto found = choice.view.cameras.find("scene"); found != choice.view.cameras.end()) {
    const SessionCamera& c = found->second;
    const auto vector = [](const Eigen::Vector3d& v) {
      return "[" + exactly(v.x()) + "," + exactly(v.y()) + "," + exactly(v.z()) + "]";
    };
    if (c.position.allFinite() && c.focalPoint.allFinite() && c.up.allFinite())
      json += ",\"position\":" + vector(c.position) + ",\"focal_point\":" + vector(c.focalPoint) + ",\"up\":" + vector(c.up);
  }
  return json + "}";
}

/// In which coordinates everything is drawn, and whether the object moves there.
std::string coordinatesJson(const Inspection& inspection) {
  const LightFrameChoice& chosen = inspection.lightFrame;
  return std::string("{\"frame\":\"") + nameOf(chosen.frame) + "\",\"reason\":" + quoted(chosen.reason) +
         ",\"moves\":" + truth(!standsStill(*inspection.scene)) + "}";
}

std::string dataJson(const Inspection& inspection, const ReportContext& context, const ShareChoice& choice,
                     const ProgressFn& progress) {
  const std::vector<int> frames = framesOf(inspection, choice);
  const SharedSurfaces surfaces = surfacesOf(inspection, frames, progress);
  const draw::SceneScale scale = draw::sceneScale(inspection, surfaces.box, frames, 1);
  const Rounding rounding(scale.sceneSize);
  const auto lesson = choice.view.options.find("explain/lesson");
  std::string photographs;
  for (const std::string& url : photographsOf(inspection, frames, progress))
    photographs += (photographs.empty() ? "\"" : ",\n\"") + url + "\"";
  return "{\"glint_share\":1,\"program\":" + quoted(context.program) + ",\"name\":" + quoted(inspection.scene->name) +
         ",\"input\":" + quoted(context.input) + ",\"frames_in_all\":" + std::to_string(inspection.scene->frames.size()) +
         ",\"lesson\":" + lessonJson(lesson == choice.view.options.end() ? "" : lesson->second) +
         ",\"coordinates\":" + coordinatesJson(inspection) + ",\"view\":" + viewJson(inspection, choice, frames) +
         ",\"models\":" + modelsJson(inspection) + ",\"canonical_colour\":" + quoted(modelHex(canonicalModel().id())) +
         ",\"evaluation\":" + untimed(evaluationJson(inspection, context)) + ",\n\"sizes\":" + sizesJson(scale, rounding) +
         ",\"things\":" + sceneThingsJson(inspection, scale, rounding) + ",\n\"surfaces\":" + surfaces.json +
         ",\n\"frames\":" + framesJson(inspection, frames, surfaces, scale, rounding, progress) + ",\n\"photographs\":[" +
         photographs + "]}";
}

/// JSON that no HTML parser reads as mark-up, and no script as a line end.
std::string withoutMarkup(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '<' || c == '>' || c == '&') {
      out += c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : "\\u0026";
    } else if (json.compare(i, 2, "\xe2\x80") == 0 && i + 2 < json.size() && (json[i + 2] == '\xa8' || json[i + 2] == '\xa9')) {
      out += json[i + 2] == '\xa8' ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      out += c;
    }
  }
  return out;
}

/// The name that a policy gives to a script or style that may run.
std::string hashSource(std::string_view text) {
  Sha256 hash;
  hash.add(text);
  const std::string hex = hash.hex();
  std::vector<unsigned char> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return "'sha256-" + base64(bytes) + "'";
}

}  // namespace
}  // namespace share

std::string sharePage(const Inspection& inspection, const ReportContext& context, const ShareChoice& choice,
                      const ProgressFn& progress) {
  using namespace share;
  const std::string three(kThreeScript), script = std::string(kSceneScript) + std::string(kPageScript), style(kPageStyle),
                                         body(kPageBody);
  const std::string data = withoutMarkup(dataJson(inspection, context, choice, progress));
  const std::string policy = "default-src 'none'; img-src data:; style-src " + hashSource(style) + "; script-src " +
                             hashSource(three) + " " + hashSource(script) + "; base-uri 'none'; form-action 'none'";
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Glint: " + html::escaped(inspection.scene->name) +
      "</title>\n<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy +
      "\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page.reserve(page.size() + data.size() + three.size() + script.size() + (1 << 16));
  page += "<style>" + style + "</style></head>\n<body>\n" + body;
  page += "\n<details class=\"licence\"><summary>Licences</summary><pre>" + html::escaped(std::string(kThreeLicence)) +
          "</pre></details>\n";
  page += "<script type=\"application/json\" id=\"data\">" + data + "</script>\n";
  page += "<script>" + three + "</script>\n<script>" + script + "</script>\n</body></html>\n";
  return page;
}

}  // namespace glint
