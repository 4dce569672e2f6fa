// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/retexture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <utility>

#include "core/base/image.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/pipeline/carried.h"
#include "core/retexture/pixels.h"
#include "core/retexture/shading.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr double kVisibleCodes = 1.0 / 255;  // of 8 bits: what a screen can show at all
constexpr double kMarkedCodes = 0.5 / 255;   // a mark tells every pixel whose code may be another one
constexpr float kFillUnit =
    65536;  // OpenCV's fill adds up to two units to each value, which are for codes, not for light of about 1
constexpr double kFillRadiusPx = 5;   // Telea's neighbourhood
constexpr double kLeastShade = 0.05;  // of the mean shade: below, the ratio to it is noise
constexpr double kPoorShading = 0.1;  // relative RMS from which the matt surface is a doubtful account of the frame
constexpr double kLeastAround = 0.1;  // of the surface beside the mask: 22 % left filled to 46 dB, 7 % to 22 (docs/retexture.md)
constexpr double kBeyondWorthSayingPx = 1;     // of an observed contour outside of the mask
constexpr double kClippedWorthSaying = 0.001;  // of the changed pixels

double codeOf(double linear) { return srgbFromLinear(std::clamp(linear, 0.0, 1.0)); }

/// The frame's parts that a request needs; read once.
struct Canvas {
  const Inspection& in;
  int frame;
  const Camera& camera;
  std::optional<FramePixels> pixels;               ///< where the photograph is needed or there
  std::optional<Outcome<LambertShading>> lambert;  ///< where a light is known
  std::shared_ptr<const Surface> surface;          ///< may be null
};

std::vector<Light> lightsFor(const Inspection& in, int frame, const std::string& model) {
  std::vector<Light> lights;
  const ModelResult& result = in.models.at(model);
  for (const FrameComparison& c : result.frames) {
    if (c.frame != frame) continue;
    const bool fitted = c.fit >= 0 && c.fit < int(result.fits.size()) && result.fits[std::size_t(c.fit)].fit;
    const std::optional<Light> own = fitted ? result.fits[std::size_t(c.fit)].fit->lightEstimate : std::nullopt;
    const LightEstimate* const estimate = in.lightFor(frame, c.light);
    const Eigen::Isometry3d back = in.lightFromScene(frame, c.light).inverse();
    if (own)
      lights.push_back(carried(*own, back));
    else if (estimate)
      lights.push_back(carried(estimate->light, back));
  }
  return lights;
}

void addLambert(Canvas& canvas, const std::string& model, const Image& highlight, const ProgressFn& progress) {
  const std::vector<Light> lights = lightsFor(canvas.in, canvas.frame, model);
  if (lights.empty() || !canvas.surface) return;
  canvas.lambert =
      fitLambert(*canvas.surface, canvas.camera, lights, {canvas.pixels->linear, highlight, canvas.pixels->usable}, progress);
}

cv::Mat maskOf(const Image& linear, const PredictedRadiance& h, const Camera& camera, double marginPx) {
  cv::Mat mask(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
  for (std::size_t i = 0; i < linear.data.size(); ++i) {
    const double with = linear.data[i], without = with - h.radiance.data[i];
    if (std::isfinite(with) && codeOf(with) - codeOf(without) >= kVisibleCodes) mask.data[i / 3] = 255;
  }
  constexpr int kShift = 4;     // cv::fillPoly's sub-pixel bits
  constexpr double kFar = 1e6;  // px; what lies farther out is no contour of this image
  for (const Polyline& contour : h.contours) {
    std::vector<cv::Point> points;
    for (const Pixel& p : contour.points) {
      const Pixel m = camera.distorted(p);
      if (m.allFinite() && m.cwiseAbs().maxCoeff() < kFar)
        points.emplace_back(int(std::lround(m.x() * (1 << kShift))), int(std::lround(m.y() * (1 << kShift))));
    }
    if (points.size() >= 3) cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{points}, cv::Scalar(255), cv::LINE_8, kShift);
  }
  const int margin = int(std::ceil(marginPx));
  if (margin > 0) cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * margin + 1, 2 * margin + 1)));
  return mask;
}

/// How far observed contours reach beyond the mask, px.
double observedBeyond(const Canvas& canvas, const cv::Mat& mask) {
  cv::Mat away;
  cv::distanceTransform(255 - mask, away, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double most = 0;
  for (const Highlight& h : canvas.in.evidence[std::size_t(canvas.frame)].highlights)
    for (const Pixel& p : h.contour.points) {
      const Pixel m = canvas.camera.distorted(p);
      if (!m.allFinite()) continue;
      const int x = int(std::lround(m.x())), y = int(std::lround(m.y()));
      if (x >= 0 && y >= 0 && x < mask.cols && y < mask.rows) most = std::max(most, double(away.at<float>(y, x)));
    }
  return most;
}

/// The shade as a divisor per pixel; 1 everywhere without shade.
std::vector<float> divisorOf(const Canvas& canvas) {
  std::vector<float> divisor(canvas.pixels->glossy.size(), 1.f);
  if (!canvas.lambert || !*canvas.lambert) return divisor;
  const LambertShading& l = **canvas.lambert;
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < divisor.size(); ++i)
    if (l.onSurface[i]) sum += l.shade.data[i], ++n;
  if (!(sum > 0)) return divisor;
  for (std::size_t i = 0; i < divisor.size(); ++i)
    if (l.onSurface[i]) divisor[i] = float(std::max(double(l.shade.data[i]), kLeastShade * sum / n));
  return divisor;
}

/// The frame with its masked pixels filled from around them. The mask keeps to the surface where that is known.
Outcome<Image> filled(const Canvas& canvas, cv::Mat& mask, std::vector<std::string>& remarks) {
  const Image& linear = canvas.pixels->linear;
  const bool ratio = canvas.lambert && *canvas.lambert;
  const std::vector<char>* const surface = ratio ? &(*canvas.lambert)->onSurface : nullptr;
  const std::size_t pixels = canvas.pixels->glossy.size();
  std::size_t masked = 0, around = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const bool on = canvas.pixels->glossy[i] && (!surface || (*surface)[i]);
    if (!on) mask.data[i] = 0;
    masked += mask.data[i] != 0;
    around += mask.data[i] == 0 && on;
  }
  if (masked == 0) return linear;
  if (around == 0)
    return Failure{Reason::NoHighlight,
                   "the highlight covers all that the frame shows of the surface; nothing is left to fill from"};
  if (const double left = double(around) / double(masked + around); surface && left < kLeastAround)
    remarks.push_back(formatted(
        "the highlight can be seen on %.1f %% of the surface: what is filled there is told from the few pixels that are left, "
        "which may show it, too",
        100 * (1 - left)));
  const std::vector<float> divisor = divisorOf(canvas);
  cv::Rect box = cv::boundingRect(mask);
  const int margin = int(2 * kFillRadiusPx) + 2;  // all that the fill looks at
  box = cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
        cv::Rect(0, 0, mask.cols, mask.rows);
  Image result = linear;
  for (int c = 0; c < 3; ++c) {
    cv::Mat one(mask.rows, mask.cols, CV_32FC1);
    std::vector<float> seen;
    for (std::size_t i = 0; i < pixels; ++i) {
      const float v = kFillUnit * linear.data[3 * i + std::size_t(c)] / divisor[i];
      one.ptr<float>()[i] = std::isfinite(v) ? v : 0.f;
      if (surface && (*surface)[i] && !mask.data[i]) seen.push_back(v);
    }
    // Beside the surface's outline the fill must not take in what lies behind it.
    const float middle = seen.empty() ? 0.f : upperMedian(seen);
    if (surface && !seen.empty())
      for (std::size_t i = 0; i < pixels; ++i)
        if (!(*surface)[i]) one.ptr<float>()[i] = middle;
    cv::Mat done;
    cv::inpaint(one(box), mask(box), done, kFillRadiusPx, cv::INPAINT_TELEA);
    for (int y = 0; y < box.height; ++y)
      for (int x = 0; x < box.width; ++x) {
        const std::size_t i = std::size_t(box.y + y) * std::size_t(mask.cols) + std::size_t(box.x + x);
        if (mask.data[i]) result.data[3 * i + std::size_t(c)] = std::max(0.f, done.at<float>(y, x) / kFillUnit * divisor[i]);
      }
  }
  return result;
}

/// The frame without its highlight, and the mask of what was filled.
Outcome<Image> withoutHighlight(const Canvas& canvas, const PredictedRadiance& h, double marginPx, cv::Mat& mask,
                                Retextured& result) {
  mask = maskOf(canvas.pixels->linear, h, canvas.camera, marginPx);
  const double beyond = observedBeyond(canvas, mask);
  if (beyond > kBeyondWorthSayingPx)
    result.remarks.push_back(
        formatted("the observed highlight reaches %.0f px beyond the pixels that were filled; a rest of it remains", beyond));
  return filled(canvas, mask, result.remarks);
}

float grey(const Image& image, std::size_t pixel) {
  return (image.data[3 * pixel] + image.data[3 * pixel + 1] + image.data[3 * pixel + 2]) / 3;
}

/// Shade per pixel for a texture, mean of the channels; 0 off the surface.
Outcome<Image> shadeFor(const Canvas& canvas, const RetextureRequest& r, const PredictedRadiance& h, Retextured& result) {
  if (r.shading == ShadingSource::None) return Image(canvas.camera.width, canvas.camera.height, 1, 1.f);
  const bool lambert = canvas.lambert && *canvas.lambert;
  if (r.shading == ShadingSource::Lambert && !lambert)
    return canvas.lambert
               ? Outcome<Image>(canvas.lambert->failure())
               : Outcome<Image>(Failure{Reason::NoLight,
                                        "model " + r.model + " estimates no light; shading by the frame itself needs none"});
  if (lambert && r.shading != ShadingSource::Frame) {
    const LambertShading& l = **canvas.lambert;
    if (l.relativeRms > kPoorShading)
      result.remarks.push_back(
          formatted("a matt surface under the estimated light differs by %.0f %% from the frame's own shading "
                    "(a texture that is there already, other lights or shadows)",
                    100 * l.relativeRms));
    return l.shade;
  }
  cv::Mat mask;
  const Outcome<Image> plain = withoutHighlight(canvas, h, r.marginPx, mask, result);
  if (!plain) return plain.failure();
  if (r.shading == ShadingSource::Auto)
    result.remarks.emplace_back(
        "no light is known to shade the texture with; the frame without its highlight does, and what is painted on it shows "
        "through");
  Image shade(plain->width, plain->height, 1);
  for (std::size_t i = 0; i < shade.data.size(); ++i) shade.data[i] = grey(*plain, i);
  return shade;
}

/// Texture coordinates per pixel; not finite off the surface.
std::vector<Eigen::Vector2f> coordinatesIn(const Canvas& canvas, const TextureCoordinates& map, const ProgressFn& progress) {
  std::vector<Eigen::Vector2f> uv(std::size_t(canvas.camera.width) * std::size_t(canvas.camera.height),
                                  Eigen::Vector2f::Constant(std::nanf("")));
  forEachSurfacePixel(
      canvas.camera, *canvas.surface, [&](std::size_t i, const SurfacePoint& p) { uv[i] = map.at(p).cast<float>(); }, progress,
      "texture");
  return uv;
}

/// Size of a pixel in textures, from its right and lower neighbours; whole turns between them do not count.
/// @param shape  width and height of the texture over the larger one: pixels of a texture are square
double footprintAt(const std::vector<Eigen::Vector2f>& uv, std::size_t i, int x, int y, const Camera& camera,
                   const Eigen::Vector2d& shape) {
  double most = 0;
  const auto towards = [&](std::size_t j) {
    if (!uv[j].allFinite()) return;
    Eigen::Vector2d d = (uv[j] - uv[i]).cast<double>();
    d -= d.array().round().matrix();
    most = std::max(most, d.cwiseProduct(shape).norm());
  };
  if (x + 1 < camera.width) towards(i + 1);
  if (y + 1 < camera.height) towards(i + std::size_t(camera.width));
  return most;
}

Outcome<Image> textured(const Canvas& canvas, const RetextureRequest& r, const PredictedRadiance& h, Retextured& result,
                        const ProgressFn& progress) {
  if (!canvas.surface) return Failure{Reason::NoSurface, "a texture needs a surface to lie on"};
  const Outcome<Image> shade = shadeFor(canvas, r, h, result);
  if (!shade) return shade.failure();
  const TextureCoordinates map(*canvas.in.scene, canvas.frame, *canvas.surface, r.mapping, r.repeat);
  const TexturePyramid texture(r.picture);
  const bool light = r.shading == ShadingSource::None;
  const double albedo = r.albedo.value_or(light ? 1 : texture.mean());
  if (!(albedo > 0))
    return Failure{Reason::NotSupported, "the texture is black, so its mean cannot take the place of the surface's albedo"};
  const std::vector<Eigen::Vector2f> uv = coordinatesIn(canvas, map, progress);
  if (std::none_of(uv.begin(), uv.end(), [](const Eigen::Vector2f& p) { return p.allFinite(); }))
    return Failure{Reason::NoSurface, "no pixel of the frame shows the surface"};
  const Eigen::Vector2d size(r.picture.width, r.picture.height), shape = size / size.maxCoeff();
  Image base = canvas.pixels->linear;
  for (int y = 0; y < base.height; ++y)
    for (int x = 0; x < base.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(base.width) + std::size_t(x);
      if (!uv[i].allFinite() || !canvas.pixels->glossy[i]) continue;
      const Eigen::Vector3d t = texture.at(uv[i].cast<double>(), footprintAt(uv, i, x, y, canvas.camera, shape));
      for (int c = 0; c < 3; ++c) base.at(x, y, c) = float(t(c) * shade->data[i] / albedo);
    }
  result.remarks.push_back("assumed: the texture lies by " + map.words() + "; " +
                           (r.albedo ? formatted("the surface's albedo was %.3g", *r.albedo)
                            : light  ? std::string("its colour is the light that the surface sends")
                                     : std::string("its mean reflects as much as the surface did")));
  return base;
}

/// base + H in codes, with its marks.
void compose(const Image& base, const PredictedRadiance& h, const std::vector<char>* glossy, Retextured& result) {
  result.picture = Image(base.width, base.height, 3);
  result.marks.assign(base.data.size() / 3, RetextureMark::Untouched);
  std::size_t changed = 0, clipped = 0;
  for (std::size_t i = 0; i < result.marks.size(); ++i) {
    const bool on = !glossy || (*glossy)[i];
    bool visible = false, beyond = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const double under = std::isfinite(base.data[3 * i + c]) ? base.data[3 * i + c] : 0;
      const double sum = under + (on ? h.radiance.data[3 * i + c] : 0);
      const double code = codeOf(sum);
      visible = visible || (on && code - codeOf(under) >= kMarkedCodes);
      beyond = beyond || sum > 1;
      result.picture.data[3 * i + c] = float(code);
    }
    if (!visible) continue;
    ++changed;
    clipped += beyond;
    result.marks[i] = h.extrapolated[i] ? RetextureMark::Extrapolated : RetextureMark::Changed;
  }
  result.clippedShare = changed ? double(clipped) / double(changed) : 0;
  if (changed == 0) result.remarks.emplace_back("the predicted highlight changes no pixel of this frame");
  if (result.clippedShare > kClippedWorthSaying)
    result.remarks.push_back(formatted("%.1f %% of the highlight's pixels are brighter than the picture can show, and clipped",
                                       100 * result.clippedShare));
}

void composeRemoved(const Image& base, const cv::Mat& mask, Retextured& result) {
  result.picture = base;
  for (float& v : result.picture.data) v = float(std::isfinite(v) ? codeOf(v) : 0);
  result.marks.assign(base.data.size() / 3, RetextureMark::Untouched);
  std::size_t filled = 0;
  for (std::size_t i = 0; i < result.marks.size(); ++i)
    if (mask.data[i]) result.marks[i] = RetextureMark::Changed, ++filled;
  if (filled == 0) result.remarks.emplace_back("the predicted highlight changes no pixel of this frame; nothing was removed");
}

}  // namespace

ShadingSource shadingSourceNamed(const std::string& name) {
  const auto at = std::find(kShadingSources.begin(), kShadingSources.end(), name);
  require(at != kShadingSources.end(), "shadingSourceNamed: unknown name " + name);
  return ShadingSource(at - kShadingSources.begin());
}

Outcome<Retextured> retexture(const Inspection& in, int frame, const RetextureRequest& r, const ProgressFn& progress,
                              LearnedAppearances* known) {
  require(in.scene && in.given && frame >= 0 && frame < int(in.scene->frames.size()), "retexture: no such frame");
  require(!r.albedo || (*r.albedo > 0 && *r.albedo <= 1), "retexture: an albedo above 0, at most 1");
  require(r.marginPx >= 0 && std::isfinite(r.marginPx), "retexture: a margin of 0 or more");
  const Camera& camera = in.scene->frames[std::size_t(frame)].camera;
  const bool needsPicture = r.base != RetextureBase::Removed;
  require(!needsPicture || (r.picture.channels == 3 && !r.picture.empty()), "retexture: a colour picture");
  require(r.base != RetextureBase::Background || (r.picture.width == camera.width && r.picture.height == camera.height),
          "retexture: a background of the frame's size");
  Outcome<PredictedRadiance> h = predictedRadiance(in, frame, r.model, r.light, progress, known);
  if (!h) return h.failure();
  Canvas canvas{in, frame, camera, {}, {}, nullptr};
  if (in.surfaces)
    if (const auto surface = in.surfaces->surfaceOf(frame, meshPolicy(in.request.settings))) canvas.surface = *surface;
  Outcome<FramePixels> pixels = framePixels(in, frame);
  if (pixels) canvas.pixels = *std::move(pixels);
  Retextured result;
  result.remarks = h->remarks;
  if (r.base == RetextureBase::Background) {
    compose(r.picture, *h, canvas.pixels ? &canvas.pixels->glossy : nullptr, result);
  } else {
    if (!canvas.pixels) return pixels.failure();
    addLambert(canvas, r.model, h->radiance, progress);
    cv::Mat mask;
    const Outcome<Image> base = r.base == RetextureBase::Texture ? textured(canvas, r, *h, result, progress)
                                                                 : withoutHighlight(canvas, *h, r.marginPx, mask, result);
    if (!base) return base.failure();
    if (r.base == RetextureBase::Texture)
      compose(*base, *h, &canvas.pixels->glossy, result);
    else
      composeRemoved(*base, mask, result);
  }
  result.lights = std::move(h->lights);
  return result;
}

Image markPicture(const Retextured& result) {
  Image marks(result.picture.width, result.picture.height, 3);
  for (std::size_t i = 0; i < marks.data.size(); ++i) marks.data[i] = float(int(result.marks[i / 3])) / 2;
  return marks;
}

}  // namespace glint
