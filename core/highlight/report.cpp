// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/report.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/codecs/codecs.h"
#include "core/highlight/clipped_flank.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kShift = 6;  // fractional bits of OpenCV's drawing functions

Json pair(const Eigen::Vector2d& v) { return Json::array({v.x(), v.y()}); }

Json toJson(const HighlightQuality& q) {
  return {{"sigma", q.contourSigmaPx()},
          {"noise", q.noisePx},
          {"background", q.backgroundPx},
          {"blur", q.blurPx},
          {"level", q.levelPx}};
}

Json toJson(const FrameBlur& blur) {
  const Json direction = blur.motionPx > 0 ? Json(blur.directionRad * 180 / M_PI) : Json(nullptr);
  return {{"sigma_px", blur.sigmaPx}, {"motion_px", blur.motionPx}, {"direction_deg", direction}, {"edges", blur.edges}};
}

Json toJson(const SpecularSeparation& separation) {
  Json regions = Json::array();
  for (const SeparatedRegion& r : separation.regions) {
    const auto triple = [](const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); };
    regions.push_back({{"channels", triple(r.channels)},
                       {"lamp_colour", triple(r.lampColour)},
                       {"angle_deg", r.angleDeg},
                       {"noise", r.noise},
                       {"leftover", r.leftover}});
  }
  return {{"parted", separation.separated}, {"reason", separation.reason}, {"highlights", std::move(regions)}};
}

Json toJson(const RejectedCandidate& r) { return {{"place", pair(r.place)}, {"area_px2", r.areaPx2}, {"reason", r.reason}}; }

Json toJson(const Ellipse& e) {
  return {{"centre", pair(e.centre)}, {"semi_axes", pair(e.semiAxes)}, {"angle_deg", e.angle * 180 / M_PI}};
}

Json toJson(const ClippedFlank& flank) {
  Json levels = Json::array();
  for (const FlankLevel& level : flank.levels)
    levels.push_back({{"value", level.value},
                      {"of_clip", level.value / flank.clipHeight},
                      {"area_px2", level.areaPx2},
                      {"out_of_round", level.outOfRound},
                      {"ellipse", level.ellipse ? toJson(*level.ellipse) : Json(nullptr)}});
  Json j = {{"clip_height", flank.clipHeight},
            {"peak", nullptr},
            {"peak_relative_sigma", nullptr},
            {"shape", nullptr},
            {"tail", nullptr},
            {"misfit", nullptr},
            {"trusted", flank.trusted},
            {"outside_core", flank.outsideCore},
            {"contour_value", flank.contourValue},
            {"true_level", nullptr},
            {"in_words", inWords(flank)}};
  if (flank.peak) {
    j["peak"] = flank.peak->value;
    j["peak_relative_sigma"] = flank.peak->logSigma;
    j["shape"] = flank.peak->shape;
    j["tail"] = flank.peak->tail;
    j["misfit"] = flank.peak->misfit;
    j["true_level"] = flank.contourValue / flank.peak->value;
  }
  j["levels"] = std::move(levels);
  return j;
}

Json toJson(const Highlight& h, double uncertaintyPct, const HighlightQuality* quality) {
  Json j = Json::object();
  if (!h.light.empty()) j["light"] = h.light;
  j["level"] = h.level;
  j["peak"] = pair(h.peak);
  j["peak_value"] = h.peakValue;
  j["area_px2"] = h.areaPx2;
  j["clipped"] = h.clipped;
  j["touches_border"] = h.touchesBorder;
  j["peak_cut"] = h.peakCut;
  j["background_uncertainty_pct"] = uncertaintyPct;
  j["cut_px2"] = h.cutPx2;
  if (quality) {
    j["flags"] = quality->flags;
    j["contour_px"] = toJson(*quality);
    j["silhouette_share"] = quality->silhouetteShare;
  }
  j["clipped_core"] = h.flank ? toJson(*h.flank) : Json(nullptr);
  j["ellipse"] = h.ellipse ? toJson(*h.ellipse) : Json(nullptr);
  Json contour = Json::array();
  for (const Pixel& p : h.contour.points) contour.push_back(pair(p));
  j["contour"] = std::move(contour);
  return j;
}

}  // namespace

std::string detectionJson(const std::string& input, double level, const std::string& source,
                          const std::vector<DetectedFrame>& frames, const std::string& levelReason) {
  Json root = {{"glint_detection", 1}, {"input", input}, {"level", level}, {"source", source}};
  if (!levelReason.empty()) root["level_reason"] = levelReason;
  Json list = Json::array();
  for (const DetectedFrame& frame : frames) {
    Json j = {
        {"id", frame.id}, {"status", frame.failure ? "failed" : "ok"}, {"reason", frame.failure ? frame.failure->message() : ""}};
    j["highlights"] = Json::array();
    for (std::size_t i = 0; i < frame.highlights.size(); ++i)
      j["highlights"].push_back(toJson(frame.highlights[i], i < frame.uncertaintyPct.size() ? frame.uncertaintyPct[i] : 0,
                                       i < frame.quality.size() ? &frame.quality[i] : nullptr));
    j["rejected"] = Json::array();
    for (const RejectedCandidate& r : frame.rejected) j["rejected"].push_back(toJson(r));
    j["parting"] = frame.separation ? toJson(*frame.separation) : Json(nullptr);
    j["blur"] = frame.blur ? toJson(*frame.blur) : Json(nullptr);
    list.push_back(std::move(j));
  }
  root["frames"] = std::move(list);
  return json_dom::pretty(root);
}

Image drawDetection(const Image& photograph, const Camera& camera, const std::vector<Highlight>& highlights) {
  require(photograph.channels == 3 && !photograph.empty(), "drawDetection: a colour photograph");
  cv::Mat small(photograph.height, photograph.width, CV_32FC3, const_cast<float*>(photograph.data.data())), canvas;
  small.convertTo(small, CV_8UC3, 255);
  const int scale = std::max(2, (1200 + photograph.width / 2) / photograph.width);
  cv::resize(small, canvas, cv::Size(), scale, scale, cv::INTER_NEAREST);
  // Pixel (0, 0) is a pixel's centre: after enlargement it is the centre of a scale x scale block.
  const auto at = [&](const Pixel& ideal) {
    const Pixel p = camera.distorted(ideal);
    const double u = (p.x() + 0.5) * scale - 0.5, v = (p.y() + 0.5) * scale - 0.5;
    return cv::Point(static_cast<int>(std::lround(u * (1 << kShift))), static_cast<int>(std::lround(v * (1 << kShift))));
  };
  const auto draw = [&](const std::vector<Pixel>& points, const cv::Scalar& colour) {
    std::vector<cv::Point> line;
    for (const Pixel& p : points)
      if (camera.distorted(p).allFinite()) line.push_back(at(p));  // an ellipse may reach where the lens shows nothing
    cv::polylines(canvas, line, true, colour, 1, cv::LINE_AA, kShift);
  };
  for (const Highlight& h : highlights) {
    if (h.ellipse) draw(h.ellipse->sample(180), cv::Scalar(255, 140, 0));
    draw(h.contour.points, cv::Scalar(0, 220, 60));
    const cv::Scalar colour = h.clipped ? cv::Scalar(230, 30, 30) : cv::Scalar(30, 120, 255);
    const cv::Point p = at(h.peak);
    const int arm = 6 << kShift;
    cv::line(canvas, p - cv::Point(arm, 0), p + cv::Point(arm, 0), colour, 1, cv::LINE_AA, kShift);
    cv::line(canvas, p - cv::Point(0, arm), p + cv::Point(0, arm), colour, 1, cv::LINE_AA, kShift);
  }
  Image drawn(canvas.cols, canvas.rows, 3);
  cv::Mat out(canvas.rows, canvas.cols, CV_32FC3, drawn.data.data());
  canvas.convertTo(out, CV_32FC3, 1 / 255.0);
  return drawn;
}

void writePng(const std::filesystem::path& file, const Image& image) {
  require((image.channels == 3 || image.channels == 4) && !image.empty(), "writePng: a colour image");
  cv::Mat mat(image.height, image.width, CV_MAKETYPE(CV_32F, image.channels), const_cast<float*>(image.data.data())), bytes;
  mat.convertTo(bytes, CV_8U, 255);
  cv::cvtColor(bytes, bytes, image.channels == 4 ? cv::COLOR_RGBA2BGRA : cv::COLOR_RGB2BGR);
  // In memory first: libpng's own writing prints, and crashes in a worker thread, when the disk is full.
  std::vector<unsigned char> encoded;
  bool done = false;
  try {
    done = encodeWithOpenCv(".png", bytes, encoded);
  } catch (const cv::Exception&) {
  }
  if (!done) throw InputError(file.string(), "", "cannot be written: the image cannot be encoded");
  atomicWrite(file, std::string_view(reinterpret_cast<const char*>(encoded.data()), encoded.size()));
}

}  // namespace glint
