// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/lamps_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/csv_text.h"
#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"

namespace glint {

const char* const kLampsCsvHeader =
    "id,status,reason,frames,x,y,z,cov_xx,cov_yy,cov_zz,cov_xy,cov_xz,cov_yz,direction_x,direction_y,direction_z,"
    "direction_sigma_deg,from_x,from_y,from_z,residual_px,highlights,dropped,frame\n";

std::string reasonOf(const LampAnswer& lamp) { return lamp.failure ? lamp.failure->message() : lamp.withoutPosition; }

namespace {

using json_dom::numberOrNull;
using Ordered = nlohmann::ordered_json;

template <class Vector>
Ordered lengths(const Vector& v) {
  Ordered out = Ordered::array();
  for (const double x : v) out.push_back(numberOrNull(x));
  return out;
}

template <class Vector>
Ordered lengthsOrNull(const std::optional<Vector>& v) {
  return v ? lengths(*v) : Ordered();
}

Ordered ballNumber(const std::optional<std::size_t>& ball) { return ball ? Ordered(*ball + 1) : Ordered(); }

Ordered droppedJson(const LampAnswer& lamp) {
  Ordered list = Ordered::array();
  for (const DroppedSighting& d : lamp.dropped)
    list.push_back({{"frame", d.frame},
                    {"ball", ballNumber(d.ball)},
                    {"peak", lengths(d.place)},
                    {"reason", d.reason},
                    {"direction", lengthsOrNull(d.direction)}});
  return list;
}

Ordered sightingsJson(const LampAnswer& lamp) {
  Ordered list = Ordered::array();
  for (const LampSighting& s : lamp.sightings)
    list.push_back({{"ball", s.ball + 1},
                    {"peak", lengths(s.peak)},
                    {"clipped", s.clipped},
                    {"direction", lengths(s.direction)},
                    {"residual_px", lengths(s.residualPx)},
                    {"left_out_px", lengthsOrNull(s.leftOutPx)}});
  return list;
}

Ordered covarianceJson(const std::optional<Eigen::Matrix3d>& m) {
  if (!m) return {};
  Ordered rows = Ordered::array();
  for (Eigen::Index r = 0; r < 3; ++r) rows.push_back(lengths(Eigen::Vector3d(m->row(r))));
  return rows;
}

Ordered lampJson(const LampAnswer& lamp) {
  const bool known = !lamp.failure;
  Ordered j = {{"id", lamp.id},
               {"frames", lamp.frames},
               {"status", known ? "ok" : "failed"},
               {"reason", reasonOf(lamp)},
               {"position", known ? lengthsOrNull(lamp.position) : Ordered()},
               {"covariance", known ? covarianceJson(lamp.covariance) : Ordered()},
               {"direction", known ? lengths(lamp.direction) : Ordered()},
               {"direction_sigma_deg", known ? numberOrNull(degrees(lamp.directionSigma)) : Ordered()},
               {"from", known ? lengthsOrNull(lamp.from) : Ordered()},
               {"residual_px", known ? numberOrNull(lamp.residualPx) : Ordered()},
               {"degrees_of_freedom", known ? numberOrNull(lamp.degreesOfFreedom) : Ordered()},
               {"highlights", lamp.highlights},
               {"dropped", droppedJson(lamp)}};
  if (lamp.frame) {
    j["frame"] = nameOf(*lamp.frame);
    j["frame_reason"] = lamp.frameReason;
  }
  if (!lamp.solver.empty()) j["solver"] = lamp.solver;
  if (lamp.outlineShare && known) j["outline_share"] = numberOrNull(*lamp.outlineShare);
  if (!lamp.sightings.empty()) j["sightings"] = sightingsJson(lamp);
  if (lamp.parallax)
    j["parallax"] = {{"balls", {lamp.parallax->from + 1, lamp.parallax->to + 1}},
                     {"along_deg", numberOrNull(lamp.parallax->alongDeg)},
                     {"across_deg", numberOrNull(lamp.parallax->acrossDeg)}};
  if (!lamp.remarks.empty()) j["warnings"] = lamp.remarks;
  return j;
}

std::string field(double v) { return std::isfinite(v) ? formatted("%.17g", v) : ""; }

std::string fields(const std::optional<Eigen::Vector3d>& v) {
  return v ? field(v->x()) + "," + field(v->y()) + "," + field(v->z()) : ",,";
}

std::string covarianceFields(const std::optional<Eigen::Matrix3d>& m) {
  if (!m) return ",,,,,";
  return fields(Eigen::Vector3d(m->diagonal())) + "," + fields(Eigen::Vector3d((*m)(0, 1), (*m)(0, 2), (*m)(1, 2)));
}

}  // namespace

std::vector<LampLine> lampLinesOf(const Scene& scene, const std::vector<LampAnswer>& lamps, std::vector<std::string>& warnings) {
  std::vector<LampLine> lines;
  int several = 0;
  bool turned = false;
  for (const Frame& frame : scene.frames) {
    std::vector<const LampAnswer*> on;
    for (const LampAnswer& lamp : lamps)
      if (std::count(lamp.frames.begin(), lamp.frames.end(), frame.id) > 0) on.push_back(&lamp);
    if (on.size() > 1) ++several;
    if (on.size() != 1 || on.front()->failure) continue;
    const std::filesystem::path& file = frame.image.empty() ? frame.radiance : frame.image;
    // The direction of a lamp that moves with the camera is in the camera's coordinates already.
    const auto turnOf = [carried = on.front()->frame == LightFrame::Camera](const Frame& f) {
      return carried ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : Eigen::Matrix3d(f.camera.camFromWorld.linear());
    };
    lines.push_back({file.empty() ? frame.id : file.filename().string(), turnOf(frame) * on.front()->direction});
    constexpr double kSameWay = 1e-6;  // rounding of a pose in a file stays below
    turned = turned || (turnOf(frame) - turnOf(scene.frames.front())).norm() > kSameWay;
  }
  if (several > 0)
    warnings.push_back("the .lp file leaves out " + std::to_string(several) + " photographs that show several lamps");
  if (turned && !lines.empty())
    warnings.emplace_back("the cameras look different ways: each line of the .lp file is in the frame of its own photograph");
  return lines;
}

std::string lampsJson(const LampsReport& report) {
  Ordered root = {{"glint_lights", 1},
                  {"input", report.input},
                  {"length_unit", report.lengthUnit.empty() ? Ordered() : Ordered(report.lengthUnit)}};
  root["lights"] = Ordered::array();
  for (const LampAnswer& lamp : report.lamps) root["lights"].push_back(lampJson(lamp));
  if (report.balls) {
    root["balls"] = Ordered::array();
    for (const FittedBall& b : report.balls->balls)
      root["balls"].push_back({{"image", lengths(b.parameters)},
                               {"sigma_px", lengths(b.sigmaPx)},
                               {"moved_px", lengths(b.shiftPx)},
                               {"centre", lengthsOrNull(b.centre)},
                               {"edge_residual_px", numberOrNull(b.edgeResidualPx)},
                               {"edge_degrees_of_freedom", b.edgeDegreesOfFreedom},
                               {"highlights", b.highlights},
                               {"residual_px", numberOrNull(b.highlightResidualPx)},
                               {"degrees_of_freedom", numberOrNull(b.highlightDegreesOfFreedom)}});
    root["noise_factor"] = report.balls->noiseFactor;
    root["degrees_of_freedom"] = report.balls->degreesOfFreedom;
  }
  if (!report.warnings.empty()) root["warnings"] = report.warnings;
  return json_dom::pretty(root);
}

std::string lampsCsv(const LampsReport& report) {
  std::string out = kLampsCsvHeader;
  for (const LampAnswer& lamp : report.lamps) {
    const bool known = !lamp.failure;
    std::string frames;
    for (const std::string& f : lamp.frames) frames += (frames.empty() ? "" : ";") + f;
    out += csvText(lamp.id) + "," + (known ? "ok" : "failed") + "," + csvText(reasonOf(lamp)) + "," + csvText(frames) + ",";
    out += fields(known ? lamp.position : std::nullopt) + "," + covarianceFields(known ? lamp.covariance : std::nullopt) + ",";
    out += fields(known ? std::optional(lamp.direction) : std::nullopt) + ",";
    out += (known ? field(degrees(lamp.directionSigma)) : "") + "," + fields(known ? lamp.from : std::nullopt) + ",";
    out += (known ? field(lamp.residualPx) : "") + "," + std::to_string(lamp.highlights) + "," +
           std::to_string(lamp.dropped.size()) + "," + (lamp.frame ? nameOf(*lamp.frame) : "") + "\n";
  }
  return out;
}

std::string lampsLp(const LampsReport& report) {
  constexpr double kLastDigit = 5e-10;  // smaller numbers would be written as -0
  std::string out = std::to_string(report.lines.size()) + "\n";
  for (const LampLine& line : report.lines) {
    std::string name = line.file;
    for (char& c : name)
      if (c == ' ' || (c >= '\t' && c <= '\r')) c = '_';
    const Eigen::Vector3d d = line.direction.cwiseProduct(Eigen::Vector3d(1, -1, -1));
    for (int k = 0; k < 3; ++k) name += formatted(" %.9f", std::abs(d(k)) < kLastDigit ? 0.0 : d(k));
    out += name + "\n";
  }
  return out;
}

std::string lampsTable(const LampsReport& report) {
  std::string out = formatted("%-16s %-34s %-28s %10s %9s %5s  %s\n", "lamp",
                              report.lengthUnit.empty() ? "position" : ("position, " + report.lengthUnit).c_str(), "direction",
                              "sigma, deg", "left, px", "used", "dropped");
  for (const LampAnswer& lamp : report.lamps) {
    if (lamp.failure) {
      out += formatted("%-16.40s %.180s\n", lamp.id.c_str(), lamp.failure->message().c_str());
      continue;
    }
    const std::string at = lamp.position ? formatted("%.5g %.5g %.5g", lamp.position->x(), lamp.position->y(), lamp.position->z())
                                         : std::string("-");
    const bool carried = lamp.frame == LightFrame::Camera;
    const std::string towards = formatted("%.5f %.5f %.5f", lamp.direction.x(), lamp.direction.y(), lamp.direction.z());
    out += formatted("%-16.40s %-34s %-28s %10.3g %9.3g %5d  %zu%s\n", lamp.id.c_str(), at.c_str(), towards.c_str(),
                     degrees(lamp.directionSigma), lamp.residualPx, lamp.highlights, lamp.dropped.size(),
                     carried ? "  (moves with the camera: x right, y down, z forward)" : "");
  }
  return out;
}

const char* const kLampsOnCsvHeader = "frame,light,state,confidence,contrast,expected,noise,x,y,stated,reason";

std::string lampsOnCsv(const LampsOn& lamps, const Scene& scene) {
  std::string text = std::string(kLampsOnCsvHeader) + "\n";
  const auto idOf = [&](int frame) { return csvText(scene.frames[static_cast<std::size_t>(frame)].id); };
  for (const LampInFrame& l : lamps.lamps) {
    text += idOf(l.frame) + "," + csvText(l.light) + "," + wordOf(l.state) + ",";
    text += l.confidence > 0 ? formatted("%.4f,%.6g,%.6g,%.6g,", l.confidence, l.contrast, l.expected, l.noise) : ",,,,";
    text += l.place ? formatted("%.3f,%.3f,", l.place->x(), l.place->y()) : ",,";
    text += std::string(l.stated ? *l.stated ? "on" : "off" : "") + "," + csvText(l.reason) + "\n";
  }
  for (const UnexpectedHighlight& h : lamps.unexpected)
    text += idOf(h.frame) + ",,unexpected,," +
            formatted("%.6g,,%.6g,%.3f,%.3f,,", h.contrast, h.noise, h.place.x(), h.place.y()) +
            "a highlight that no lamp explains\n";
  return text;
}

std::string lampsOnSummary(const LampsOn& lamps) {
  std::map<LampIs, int> count;
  for (const LampInFrame& l : lamps.lamps) ++count[l.state];
  return formatted("lamps in frames: %d on, %d off, %d cannot be seen, %d unsure; %zu highlights that no lamp explains\n",
                   count[LampIs::On], count[LampIs::Off], count[LampIs::CannotBeSeen], count[LampIs::Unsure],
                   lamps.unexpected.size());
}

}  // namespace glint
