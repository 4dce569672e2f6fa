// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/given_labels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/json_text.h"
#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/geometry/camera.h"
#include "core/pipeline/evidence.h"

// COCO's object detection format (Lin et al., Microsoft COCO: Common objects in context, ECCV 2014; cocodataset.org).

namespace glint {
namespace {

constexpr double kLabelLevel = 0.5;       // of a label that does not say: half of the peak, as contours are taken by default
constexpr double kBesideImagePx = 1;      // labelling programs place corners on the image's edge, or just beyond
constexpr double kFromCocoCorner = -0.5;  // COCO's origin is the corner of the first pixel
constexpr std::size_t kFewestPoints = 5;  // of a contour in a scene file
constexpr double kLeastAreaPx2 = 1e-6;    // far below any highlight, far above what the lens and printed digits change
constexpr double kSameLabelLevel = 1e-6;  // levels are typed with a few digits

/// Which frame an image is, by everything that names a frame.
class FrameNames {
 public:
  explicit FrameNames(const Scene& scene) {
    for (int f = 0; f < static_cast<int>(scene.frames.size()); ++f) {
      const Frame& frame = scene.frames[static_cast<std::size_t>(f)];
      for (const std::filesystem::path& file : {frame.image, frame.radiance}) {
        if (file.empty()) continue;
        add(paths_, file.lexically_relative(scene.folder).generic_string(), f);
        add(names_, file.filename().string(), f);
        add(stems_, file.stem().string(), f);
      }
      add(ids_, frame.id, f);
    }
  }
  /// -1: none, or more than one.
  int frameOf(const std::string& fileName) const {
    const std::filesystem::path path(fileName);
    const std::string name = path.filename().string(), stem = path.stem().string();
    for (const auto& [names, asked] : {std::pair(&paths_, &fileName), std::pair(&ids_, &fileName), std::pair(&names_, &name),
                                       std::pair(&ids_, &stem), std::pair(&stems_, &stem)}) {
      const auto found = names->find(*asked);
      if (found != names->end()) return found->second;
    }
    return -1;
  }

 private:
  using Names = std::map<std::string, int>;
  static void add(Names& names, const std::string& name, int frame) {
    const auto [at, isNew] = names.emplace(name, frame);
    if (!isNew && at->second != frame) at->second = -1;
  }
  Names paths_, names_, stems_, ids_;
};

class LabelReading {
 public:
  LabelReading(const Scene& scene, const JsonNode& root, const ProgressFn& progress)
      : given_(scene), root_(root), progress_(progress) {
    out_.scene = scene;
  }

  LabelledScene read() {
    if (!root_.isObject() || !root_.has("images") || !root_.has("annotations"))
      root_.fail("is no COCO file: it has no 'images' and 'annotations'");
    readCategories();
    readImages();
    readAnnotations();
    replaceHighlights();
    return std::move(out_);
  }

 private:
  void readCategories() {
    std::set<std::string> lights;
    for (const TrueLight& l : given_.lights) lights.insert(l.id);
    for (const Frame& f : given_.frames) {
      lights.insert(f.lightsOn.begin(), f.lightsOn.end());
      for (const Highlight& h : f.highlights) lights.insert(h.light);
    }
    lights.erase("");
    const JsonNode list = root_.at("categories");
    for (std::size_t i = 0; i < list.size(); ++i) {
      const JsonNode node = list.at(i);
      const std::string name = node.at("name").text(), start = "highlight ";
      const std::string bare = name.compare(0, start.size(), start) == 0 ? name.substr(start.size()) : name;
      // If the scene names no light, every category is one: such a scene's own is called "light".
      const bool known = lights.count(bare) || lights.count(name) || (lights.empty() && bare == "light");
      if (!categories_.emplace(node.at("id").integer(), known ? (lights.count(name) ? name : bare) : "").second)
        node.at("id").fail("duplicate id");
      if (!known) unknown_.push_back(name);
    }
  }

  void readImages() {
    const FrameNames names(given_);
    std::set<int> frames;
    const JsonNode list = root_.at("images");
    std::vector<std::string> unmatched;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const JsonNode node = list.at(i);
      const std::string name = node.at("file_name").text();
      const int frame = names.frameOf(name);
      if (!images_.emplace(node.at("id").integer(), frame).second) node.at("id").fail("duplicate id");
      if (frame < 0) {
        unmatched.push_back(name);
        continue;
      }
      const Frame& f = given_.frames[static_cast<std::size_t>(frame)];
      if (!frames.insert(frame).second) node.at("file_name").fail("a second image of frame '" + f.id + "'");
      const int width = node.at("width").integer(), height = node.at("height").integer();
      if (width != f.camera.width || height != f.camera.height)
        node.fail(
            formatted("is %d x %d pixels, frame '%s' %d x %d", width, height, f.id.c_str(), f.camera.width, f.camera.height));
    }
    const std::string first = unmatched.empty() ? "" : ", first: " + messageLine(unmatched.front());
    if (frames.empty()) list.fail("none of the " + std::to_string(list.size()) + " images is a frame of this scene" + first);
    if (!unmatched.empty())
      out_.warnings.push_back("labels: " + std::to_string(unmatched.size()) + " of " + std::to_string(list.size()) +
                              " images are no frame of this scene, or of several" + first);
    listed_ = std::move(frames);
  }

  void readAnnotations() {
    const JsonNode list = root_.at("annotations");
    for (std::size_t i = 0; i < list.size(); ++i) {
      const JsonNode node = list.at(i);
      const JsonNode imageId = node.at("image_id"), categoryId = node.at("category_id");
      const auto image = images_.find(imageId.integer());
      if (image == images_.end()) imageId.fail("no image has this id");
      const auto category = categories_.find(categoryId.integer());
      if (category == categories_.end()) categoryId.fail("no category has this id");
      if (image->second < 0) continue;
      const Frame& frame = given_.frames[static_cast<std::size_t>(image->second)];
      Highlight h = highlightOf(node, frame);
      h.light = category->second;
      if (h.light.empty()) ++withoutLight_;
      found_[image->second].push_back(std::move(h));
    }
  }

  Highlight highlightOf(const JsonNode& node, const Frame& frame) {
    const JsonNode parts = node.at("segmentation");
    if (parts.isObject()) parts.fail("is a bit mask (RLE); only polygons are read");
    if (parts.size() == 0) parts.fail("has no polygon: a box is no contour");
    Polyline measured;
    std::size_t largest = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      Polyline polygon = polygonOf(parts.at(k), frame.camera);
      if (k > 0 && std::abs(signedArea(polygon)) <= std::abs(signedArea(measured))) continue;
      measured = std::move(polygon);
      largest = k;
    }
    if (parts.size() > 1) ++severalParts_;
    Highlight h;
    h.fromScene = true;
    h.level = kLabelLevel;
    if (const auto attributes = node.find("attributes"); attributes && attributes->isObject())
      if (const auto level = attributes->find("level"); level && level->isNumber()) {
        h.level = level->number();
        if (!(h.level >= kLeastLevel && h.level <= kMostLevel)) level->fail("must be between 0.000001 and 0.999999");
      }
    for (const Pixel& p : measured.points) {
      const Outcome<Pixel> ideal = withoutDistortion(frame.camera, p);
      if (!ideal) parts.at(largest).fail("lies where the lens distortion cannot be removed: " + ideal.failure().detail);
      h.contour.points.push_back(*ideal);
    }
    if (signedArea(h.contour) < 0) std::reverse(h.contour.points.begin() + 1, h.contour.points.end());
    h.areaPx2 = std::abs(signedArea(h.contour));
    if (!(h.areaPx2 > kLeastAreaPx2)) parts.at(largest).fail("encloses no area");
    return h;
  }

  /// Our pixels, as measured; within the image.
  static Polyline polygonOf(const JsonNode& node, const Camera& camera) {
    const std::size_t n = node.size();
    if (n < 6 || n % 2 != 0) node.fail("must be x y of at least 3 points, has " + std::to_string(n) + " numbers");
    Polyline polygon;
    for (std::size_t i = 0; i < n; i += 2) {
      const double x = bounded(node.at(i), kFarthestPx), y = bounded(node.at(i + 1), kFarthestPx);
      if (x < -kBesideImagePx || y < -kBesideImagePx || x > camera.width + kBesideImagePx || y > camera.height + kBesideImagePx)
        node.at(i).fail(formatted("lies outside of the image: (%g, %g)", x, y));
      const Pixel edge(std::clamp(x, 0.0, double(camera.width)), std::clamp(y, 0.0, double(camera.height)));
      polygon.points.push_back(edge + Pixel(kFromCocoCorner, kFromCocoCorner));
    }
    polygon = withoutRepeats(polygon);
    if (polygon.points.size() < 3) node.fail("encloses no area");
    // A scene's contour has five points at least: the middles of a triangle's sides change nothing.
    while (polygon.points.size() < kFewestPoints) {
      std::vector<Pixel> finer;
      for (std::size_t i = 0; i < polygon.points.size(); ++i) {
        const Pixel &a = polygon.points[i], &b = polygon.points[(i + 1) % polygon.points.size()];
        finer.push_back(a);
        finer.push_back((a + b) / 2);
      }
      polygon.points = std::move(finer);
    }
    return polygon;
  }

  void replaceHighlights() {
    std::size_t done = 0;
    for (auto& [f, highlights] : found_) {
      if (!report(progress_, {"labels", static_cast<int>(done++), static_cast<int>(found_.size())})) throw Stopped{};
      std::vector<Highlight>& kept = out_.scene.frames[static_cast<std::size_t>(f)].highlights;
      setPeaks(f, highlights);
      const auto replaced = [&list = highlights](const Highlight& old) {
        return std::any_of(list.begin(), list.end(),
                           [&](const Highlight& h) { return std::abs(h.level - old.level) < kSameLabelLevel; });
      };
      kept.erase(std::remove_if(kept.begin(), kept.end(), replaced), kept.end());
      kept.insert(kept.end(), highlights.begin(), highlights.end());
      ++out_.frames;
      out_.highlights += static_cast<int>(highlights.size());
    }
    say();
  }

  void setPeaks(int f, std::vector<Highlight>& highlights) {
    const Frame& frame = given_.frames[static_cast<std::size_t>(f)];
    std::optional<std::vector<Highlight>> detected;  // once, and only where it is asked for
    for (Highlight& h : highlights) {
      if (takePeak(frame.highlights, h)) continue;
      if (!detected) detected = detectedIn(frame);
      if (takePeak(*detected, h)) continue;
      h.peak = middleOf(h.contour);
      ++centroids_;
    }
  }

  /// The peak inside of the contour, of the same light where both are known; the first is the strongest.
  static bool takePeak(const std::vector<Highlight>& from, Highlight& h) {
    for (const Highlight& other : from) {
      if (!other.light.empty() && !h.light.empty() && other.light != h.light && other.fromScene) continue;
      if (!contains(h.contour, other.peak)) continue;
      h.peak = other.peak;
      return true;
    }
    return false;
  }

  /// The centroid; where a polygon crosses itself, that may lie far outside, and the middle of its box stands for it.
  static Pixel middleOf(const Polyline& contour) {
    Eigen::AlignedBox2d box;
    for (const Pixel& p : contour.points) box.extend(p);
    const Pixel middle = centroid(contour);
    return box.contains(middle) ? middle : Pixel(box.center());
  }

  static std::vector<Highlight> detectedIn(const Frame& frame) {
    if (frame.image.empty() && frame.radiance.empty()) return {};
    Scene alone;
    alone.frames = {frame};
    alone.frames.front().highlights.clear();
    return gatherEvidence(alone, 0, FrameSource::Radiance, Settings(), {}).highlights;
  }

  void say() {
    const auto count = [](std::size_t n, const char* one, const char* many) {
      return std::to_string(n) + " " + (n == 1 ? one : many);
    };
    if (!unknown_.empty())
      out_.warnings.push_back("labels: " + count(unknown_.size(), "category names", "categories name") +
                              " no light of this scene, first: " + messageLine(unknown_.front()) + "; " +
                              count(withoutLight_, "highlight has", "highlights have") + " no light");
    if (severalParts_ > 0)
      out_.warnings.push_back("labels: " + count(severalParts_, "annotation has", "annotations have") +
                              " several polygons, of which the largest counts");
    if (centroids_ > 0)
      out_.warnings.push_back("labels: " + count(centroids_, "highlight has", "highlights have") +
                              " no peak in the photograph; the polygon's centroid stands for it");
    std::size_t empty = 0;
    for (const int f : listed_) empty += found_.count(f) == 0;
    if (empty > 0)
      out_.warnings.push_back("labels: " + count(empty, "image has", "images have") +
                              " no label; a scene file cannot say so, and its highlights stay as they were or are detected");
  }

  const Scene& given_;
  const JsonNode& root_;
  const ProgressFn& progress_;
  LabelledScene out_;
  std::map<int, std::string> categories_;  // light by id; "" = none that the scene knows
  std::map<int, int> images_;              // frame by id; -1 = none
  std::set<int> listed_;
  std::map<int, std::vector<Highlight>> found_;
  std::vector<std::string> unknown_;
  std::size_t withoutLight_ = 0, severalParts_ = 0, centroids_ = 0;
};

}  // namespace

LabelledScene withLabels(const Scene& scene, const std::string& text, const std::string& file, const ProgressFn& progress) {
  return LabelReading(scene, JsonNode::parse(text, file), progress).read();
}

LabelledScene withLabels(const Scene& scene, const std::filesystem::path& file, const ProgressFn& progress) {
  return withLabels(scene, readFile(file, Limit::JsonMegabytes), file.string(), progress);
}

}  // namespace glint
