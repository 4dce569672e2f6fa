// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/json_text.h"
#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/geometry/camera.h"
#include "core/highlight/clipped_flank.h"

namespace glint {
namespace {

constexpr int kNoisePoints = 72;     // docs/formats.md, "Noise"
constexpr double kSameLevel = 1e-6;  // levels are typed with a few digits
constexpr double kHalfPx = 0.5;      // px: the image ends at the outer edges of its pixels

/// The reason when a part of the highlight lies where the lens distortion has no inverse.
std::optional<Failure> toIdealPixels(Highlight& h, const Camera& camera) {
  if (!camera.hasDistortion()) return std::nullopt;
  const auto undistort = [&](Pixel& p) -> std::optional<Failure> {
    const Outcome<Pixel> ideal = withoutDistortion(camera, p);
    if (!ideal) return ideal.failure();
    p = *ideal;
    return std::nullopt;
  };
  for (Pixel& p : h.contour.points)
    if (const std::optional<Failure> failure = undistort(p)) return failure;
  if (const std::optional<Failure> failure = undistort(h.peak)) return failure;
  h.areaPx2 = std::abs(signedArea(h.contour));
  h.ellipse.reset();
  if (!h.flank) return std::nullopt;
  auto flank = std::make_shared<ClippedFlank>(*h.flank);
  for (std::size_t i = 0; i < flank->levels.size(); ++i) {
    FlankLevel& level = flank->levels[i];
    for (Pixel& p : level.contour.points)
      if (undistort(p)) {  // lower levels reach farther out, where the lens may show nothing
        flank->levels.resize(i);
        break;
      }
    if (i == flank->levels.size()) break;
    level.areaPx2 = std::abs(signedArea(level.contour));
    level.ellipse.reset();
    if (const Outcome<Ellipse> e = fitEllipse(level.contour.points)) level.ellipse = *e;
  }
  h.flank = std::move(flank);
  return std::nullopt;
}

void fitMissingEllipse(Highlight& h) {
  if (h.ellipse || h.contour.points.size() < 5) return;
  if (const Outcome<Ellipse> e = fitEllipse(h.contour.points)) h.ellipse = *e;
}

/// The value of each pixel by the combination of the nearest region.
void takeSpecularPart(const Image& linear, const std::vector<SeparatedRegion>& separated, LinearPixels& pixels) {
  require(linear.channels == 3, "separated pixels: 3 channels");
  std::vector<Eigen::Matrix2d> inverse;
  for (const SeparatedRegion& region : separated) inverse.push_back(region.footprint.shape.inverse());
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x) {
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < separated.size(); ++k) {
        const Eigen::Vector2d d = Pixel(x, y) - separated[k].footprint.centre;
        if (const double squared = d.dot(inverse[k] * d); squared < least) {
          least = squared;
          nearest = k;
        }
      }
      const double s =
          separated[nearest].channels.dot(Eigen::Vector3d(linear.at(x, y, 0), linear.at(x, y, 1), linear.at(x, y, 2)));
      pixels.value.at(x, y) = std::isfinite(s) ? static_cast<float>(s) : 0.f;
    }
}

std::filesystem::path truthFile(const std::string& folder, const Frame& frame) {
  return std::filesystem::path(folder) / (fileNameOf(frame.id) + ".json");
}

}  // namespace

void addOtherLevels(const std::vector<Highlight>& given, std::vector<Highlight>& highlights) {
  for (const Highlight& other : given)
    for (Highlight& h : highlights) {
      if (std::abs(other.level - h.level) < kSameLevel || other.light != h.light || !contains(other.contour, h.peak)) continue;
      h.otherLevels.push_back({other.level, other.contour});
      break;
    }
}

DetectOptions detectOptionsFor(const Frame& frame, FrameSource source, const DetectSettings& settings) {
  DetectOptions options;
  options.level = settings.level;
  options.minAreaPx2 = settings.minAreaPx2;
  options.minContrast = settings.minContrast;
  options.peakWindowLevel = settings.peakWindowLevel;
  options.clipValue = settings.clipValue;
  const bool photograph = frame.radiance.empty() || (source == FrameSource::Image && !frame.image.empty());
  if (options.clipValue == 0 && photograph) options.clipValue = 1.0;  // linearised codes end at 1
  return options;
}

Outcome<LinearPixels> pixelsOf(const Frame& frame, FrameSource source, const DetectSettings& settings,
                               const std::vector<SeparatedRegion>& separated, const DiffuseLight* under) {
  const Outcome<MaskedImage> image = readMasked(frame, source);
  if (!image) return image.failure();
  const double clipValue = detectOptionsFor(frame, source, settings).clipValue;
  LinearPixels pixels = linearPixels(image->linear, image->maskIfAny(), clipValue, under);
  if (!separated.empty()) takeSpecularPart(image->linear, separated, pixels);
  return pixels;
}

FrameEvidence gatherEvidence(const Scene& scene, int index, FrameSource source, const DetectSettings& settings,
                             const SeparateLights& lights, std::shared_ptr<const DiffuseLight> diffuse) {
  const Frame& frame = scene.frames[index];
  FrameEvidence evidence;
  evidence.frame = index;
  evidence.id = frame.id;
  const double level = settings.level;
  for (const Highlight& h : frame.highlights)
    if (std::abs(h.level - level) < kSameLevel) evidence.highlights.push_back(h);
  addOtherLevels(frame.highlights, evidence.highlights);
  if (evidence.highlights.empty()) {
    if (frame.radiance.empty() && frame.image.empty()) {
      if (!frame.highlights.empty()) {
        evidence.failure = Failure{Reason::NoHighlight, "frame " + frame.id + " has highlights at other levels only"};
        return evidence;
      }
      evidence.failure = Failure{Reason::FrameUnreadable, "frame " + frame.id + " has no image, radiance or highlights"};
      return evidence;
    }
    const Outcome<MaskedImage> image = readMasked(frame, source);
    if (!image) {
      evidence.failure = image.failure();
      return evidence;
    }
    DetectOptions options = detectOptionsFor(frame, source, settings);
    options.separatePeaks = lights.separate || frame.lightsOn.size() > 1;
    options.references = lights.references;
    options.under = diffuse.get();
    evidence.diffuse = std::move(diffuse);
    if (settings.texture) {
      const LinearPixels pixels = linearPixels(image->linear, image->maskIfAny(), options.clipValue);
      evidence.structure = fineStructure(pixels.value, pixels.usable);
    }
    for (PeakReference& r : options.references) r.peak = frame.camera.distorted(r.peak);
    Outcome<std::vector<Highlight>> found = detectHighlights(image->linear, image->maskIfAny(), options, &evidence.rejected);
    if (!found) {
      evidence.failure = found.failure();
      return evidence;
    }
    for (Highlight& h : *found) {
      if (std::optional<Failure> failure = toIdealPixels(h, frame.camera))
        evidence.failure = std::move(failure);  // kept only if no other highlight is left
      else
        evidence.highlights.push_back(std::move(h));
    }
    if (evidence.highlights.empty()) return evidence;
    evidence.failure.reset();
  }
  for (Highlight& h : evidence.highlights) {
    // With several lights on, the assignment over all frames decides.
    if (h.light.empty() && frame.lightsOn.size() <= 1) h.light = frame.lightsOn.empty() ? "light" : frame.lightsOn.front();
    if (h.areaPx2 == 0) h.areaPx2 = std::abs(signedArea(h.contour));
    fitMissingEllipse(h);
  }
  return evidence;
}

SpecularSeparation separateEvidence(const Scene& scene, int index, FrameSource source, const DetectSettings& settings,
                                    FrameEvidence& evidence) {
  const auto because = [](std::string reason) {
    SpecularSeparation none;
    none.reason = std::move(reason);
    return none;
  };
  const Frame& frame = scene.frames[static_cast<std::size_t>(index)];
  if (evidence.highlights.empty()) return because("there is no highlight");
  if (std::any_of(evidence.highlights.begin(), evidence.highlights.end(), [](const Highlight& h) { return h.fromScene; }))
    return because("the scene gives the highlights");
  const Outcome<MaskedImage> image = readMasked(frame, source);
  if (!image) return because(image.failure().message());
  std::vector<Highlight> measured = evidence.highlights;
  if (frame.camera.hasDistortion())
    for (Highlight& h : measured) {
      for (Pixel& p : h.contour.points) p = frame.camera.distorted(p);
      h.peak = frame.camera.distorted(h.peak);
      h.ellipse.reset();
      fitMissingEllipse(h);
    }
  DetectOptions options = detectOptionsFor(frame, source, settings);
  options.separatePeaks = frame.lightsOn.size() > 1;
  SpecularSeparation separation = separateHighlights(image->linear, image->maskIfAny(), options, measured);
  if (!separation.separated) return separation;
  for (Highlight& h : measured) {
    if (const std::optional<Failure> failure = toIdealPixels(h, frame.camera)) return because(failure->message());
    fitMissingEllipse(h);
  }
  evidence.highlights = std::move(measured);
  return separation;
}

void requireTruthFolder(const std::string& folder, const Scene& scene) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) throw InputError(folder, "--truth", "this folder does not exist");
  for (const Frame& frame : scene.frames)
    if (std::filesystem::exists(truthFile(folder, frame))) return;
  throw InputError(folder, "--truth",
                   "contains no contours of these frames, such as " + fileNameOf(scene.frames.front().id) + ".json");
}

Outcome<std::vector<Highlight>> readTruth(const std::string& folder, const Scene& scene, int index, double level) {
  const Frame& frame = scene.frames[index];
  const std::filesystem::path file = truthFile(folder, frame);
  if (!std::filesystem::exists(file)) return Failure{Reason::FrameUnreadable, file.string() + ": this file does not exist"};
  std::vector<Highlight> truth;
  const std::string key = formatted("%.2f", level), asked = formatted("%g", level);
  const JsonNode root = JsonNode::parse(readFile(file, Limit::JsonMegabytes), file.string());
  const JsonNode levels = root.at("levels");
  const std::optional<JsonNode> contours = levels.find(key);
  constexpr double kHundredths = 100;  // the keys have two decimals
  if (!contours || std::abs(std::round(level * kHundredths) / kHundredths - level) > kSameLevel)
    levels.fail("no contours at level " + key + " (requested " + asked + ")");
  for (std::size_t i = 0; i < contours->size(); ++i) {
    const JsonNode c = contours->at(i);
    Highlight h;
    h.light = frame.lightsOn.empty() ? "light" : frame.lightsOn.front();
    h.level = level;
    const JsonNode points = c.at("points");
    for (std::size_t k = 0; k < points.size(); ++k) h.contour.points.push_back(pixel(points.at(k)));
    const std::optional<JsonNode> closed = c.find("closed"), atEdge = c.find("edge_fraction");
    h.contour.closed = !closed || closed->boolean();
    h.contour = withoutRepeats(h.contour);
    h.areaPx2 = std::abs(signedArea(h.contour));
    if (!(h.areaPx2 > 0)) points.fail("the contour encloses no area");
    h.touchesBorder = !h.contour.closed || (atEdge && atEdge->number() > 0);
    h.peak = centroid(h.contour);
    truth.push_back(std::move(h));
  }
  // The stored sub-pixel peak belongs to the highlight that contains it; the others keep their centroid.
  if (const std::optional<JsonNode> n = root.find("peak_subpixel"); n && !n->isNull()) {
    const Pixel peak = pixel(*n);
    const bool beyond =
        peak.minCoeff() < -kHalfPx || peak.x() > frame.camera.width - kHalfPx || peak.y() > frame.camera.height - kHalfPx;
    for (Highlight& h : truth) {
      if (!contains(h.contour, peak) && !(beyond && truth.size() == 1)) continue;
      h.peak = peak;
      h.peakCut = h.touchesBorder && beyond;  // whoever made the file saw no more than that
    }
  }
  for (Highlight& h : truth) {
    if (const std::optional<Failure> failure = toIdealPixels(h, frame.camera)) return *failure;
    h.touchesBorder = h.touchesBorder || runsAlongImageBorder(frame.camera, h.contour);
    fitMissingEllipse(h);
  }
  return truth;
}

Highlight withNoise(const Highlight& highlight, double sigma, unsigned seed, int frame, int index) {
  if (!(sigma > 0) || highlight.contour.points.size() < 3) return highlight;
  std::seed_seq sequence{seed, static_cast<unsigned>(frame), static_cast<unsigned>(index)};
  std::mt19937_64 engine(sequence);
  std::normal_distribution<double> gauss(0, sigma);
  Highlight noisy = highlight;
  const auto shake = [&](Polyline& contour) {
    contour.points = resample(contour, kNoisePoints);
    for (Pixel& p : contour.points) {
      p.x() += gauss(engine);
      p.y() += gauss(engine);
    }
  };
  shake(noisy.contour);
  noisy.peak.x() += gauss(engine);
  noisy.peak.y() += gauss(engine);
  for (LevelContour& c : noisy.otherLevels)
    if (c.contour.points.size() >= 3) shake(c.contour);
  noisy.areaPx2 = std::abs(signedArea(noisy.contour));
  noisy.ellipse.reset();
  fitMissingEllipse(noisy);
  return noisy;
}

}  // namespace glint
