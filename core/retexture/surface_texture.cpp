// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/surface_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/texture_panel.h"
#include "core/retexture/pixels.h"
#include "core/retexture/shading.h"
#include "core/scene/frame_name.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr double kGrazing = 0.25;       // cosine: beyond it a pixel covers four times its width on the surface
constexpr double kInHighlight2 = 4;     // squared radii at half of the peak: farther in, its light is no tail any more
constexpr double kFromHighlight2 = 36;  // at six radii also a long tail has faded to half a percent
constexpr std::size_t kViewsKept = 7;   // of a texel: three of them may show what does not belong there
constexpr double kLeastOfBest = 0.05;   // of the best view's weight: less says nothing beside it
constexpr float kLeastWeight = 1e-4f, kMostWeight = 1e4f;  // what a half float holds to three digits
constexpr double kApartPixels = 8;                         // between neighbours: a slope of kGrazing takes six at most
constexpr double kSteadySteps = 4;                         // of the median one: longer ones may cross a seam
constexpr double kBent = 0.25;           // of a step: a map that is smooth has its middle nearer to the mean than that
constexpr int kRowsForGain = 100;        // of a frame: some thousand texels tell a ratio to a few thousandths
constexpr double kSameGain = 0.02;       // automatic exposures differ by more; below it is noise
constexpr double kDarkShare = 0.05;      // of the brightest value: ratios of darker ones are noise
constexpr double kLeastLit = 0.05;       // of the mean shade: below, the ratio to it is noise
constexpr double kMostTexels = 1 << 23;  // they take 80 bytes each
constexpr double kBrightest = 0.9, kAlmostAll = 0.999;    // of an albedo's picture: room for interpolation above
constexpr double kFewViews = 0.5, kSeveralPlaces = 0.01;  // shares of the texels that are worth a warning
constexpr double kViewsDiffer = 8;                        // codes, median: poses and shading that fit leave one or two

/// Whole textures do not count.
Eigen::Vector2f unwrapped(Eigen::Vector2f step) { return step - step.array().round().matrix(); }

/// What one frame shows of the surface, per pixel. Points are in the coordinates of the object.
struct FrameOnSurface {
  int width = 0, height = 0;
  Image linear;
  std::vector<Eigen::Vector2f> uv;  ///< not finite where the pixel shows nothing that counts
  std::vector<Eigen::Vector3f> point, normal;
  std::vector<float> weight, pixelSize;  ///< the second in metres, across the line of sight
  std::shared_ptr<const TextureCoordinates> map;
  Eigen::Isometry3d sceneFromObject = Eigen::Isometry3d::Identity();
  Eigen::Vector2d texturesPerPixel{0, 0};  ///< medians, along u and v
  float brightest = 0;

  bool shows(std::size_t i) const { return uv[i].allFinite(); }
  /// Whether the surface and its map go on between two pixels.
  bool joined(std::size_t a, std::size_t b) const;
  void measure();
};

bool FrameOnSurface::joined(std::size_t a, std::size_t b) const {
  if ((point[a] - point[b]).norm() > kApartPixels * pixelSize[a]) return false;
  const Eigen::Vector2f step = unwrapped(uv[b] - uv[a]);
  if (step.norm() <= kSteadySteps * texturesPerPixel.maxCoeff()) return true;
  SurfacePoint middle;
  middle.position = sceneFromObject * (0.5 * (point[a] + point[b]).cast<double>());
  middle.normal = (sceneFromObject.linear() * (normal[a] + normal[b]).cast<double>()).normalized();
  const Eigen::Vector2f off = unwrapped(map->at(middle).cast<float>() - uv[a] - 0.5f * step);
  return off.norm() < kBent * step.norm();
}

void FrameOnSurface::measure() {
  std::array<std::vector<double>, 2> steps;
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x), below = i + std::size_t(width);
      if (!shows(i) || !shows(i + 1) || !shows(below)) continue;
      const Eigen::Vector2f right = unwrapped(uv[i + 1] - uv[i]).cwiseAbs(), down = unwrapped(uv[below] - uv[i]).cwiseAbs();
      for (int k = 0; k < 2; ++k) steps[std::size_t(k)].push_back(std::max(right(k), down(k)));
      for (int c = 0; c < 3; ++c) brightest = std::max(brightest, linear.at(x, y, c));
    }
  for (int k = 0; k < 2; ++k)
    if (!steps[0].empty()) texturesPerPixel(k) = upperMedian(steps[std::size_t(k)]);
}

/// The size of a texture.
struct TextureSize {
  int width = 0, height = 0;
};

/// Calls take(texel, {pixels}, {their shares}, texels per pixel) for each texel whose centre lies between three pixels.
template <class Take>
void overTexels(const FrameOnSurface& f, const TextureSize& size, int rowStep, const Take& take) {
  const Eigen::Array2d scale(size.width, size.height);
  const auto triangle = [&](std::size_t i, std::size_t j, std::size_t k) {
    if (!f.shows(i) || !f.shows(j) || !f.shows(k) || !f.joined(i, j) || !f.joined(i, k) || !f.joined(j, k)) return;
    const Eigen::Vector2f toJ = unwrapped(f.uv[j] - f.uv[i]), toK = unwrapped(f.uv[k] - f.uv[i]);
    if ((toK - toJ).cwiseAbs().maxCoeff() >= 0.5f) return;  // around a pole
    const Eigen::Vector2d at = f.uv[i].cast<double>().array() * scale - 0.5, b = toJ.cast<double>().array() * scale,
                          c = toK.cast<double>().array() * scale;
    const double area = b.x() * c.y() - b.y() * c.x();
    if (!(std::abs(area) > std::numeric_limits<double>::min())) return;
    const Eigen::Vector2d low = at + b.cwiseMin(c).cwiseMin(0), high = at + b.cwiseMax(c).cwiseMax(0);
    for (double y = std::ceil(low.y()); y <= high.y(); ++y)
      for (double x = std::ceil(low.x()); x <= high.x(); ++x) {
        const Eigen::Vector2d q = Eigen::Vector2d(x, y) - at;
        const double s = (q.x() * c.y() - q.y() * c.x()) / area, t = (b.x() * q.y() - b.y() * q.x()) / area;
        if (s < 0 || t < 0 || s + t > 1) continue;
        const auto place = [](double v, int n) { return std::size_t(v - n * std::floor(v / n)) % std::size_t(n); };
        take(place(y, size.height) * std::size_t(size.width) + place(x, size.width), std::array{i, j, k},
             std::array{1 - s - t, s, t}, std::abs(area));
      }
  };
  for (int y = 0; y + 1 < f.height; y += rowStep)
    for (int x = 0; x + 1 < f.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(f.width) + std::size_t(x), below = i + std::size_t(f.width);
      triangle(i, i + 1, below);
      triangle(i + 1, below + 1, below);
    }
}

/// The best views of each texel.
class TexelViews {
 public:
  explicit TexelViews(TextureSize size) : size_(size), texels_(std::size_t(size.width) * std::size_t(size.height)) {}

  /// @param exact  every gain counts; else those near 1 are 1
  void add(const FrameOnSurface& f, int frame, bool samePlaces, bool exact);
  /// The mean of the middle half, and the distance between the quarters in codes of 8 bits of the light times `scale`.
  std::pair<Eigen::Vector3f, float> middleOf(std::size_t texel, double scale) const;
  int viewsOf(std::size_t texel) const { return texels_[texel].views; }
  double severalPlaces() const;  ///< share of the texels that are seen
  const std::vector<double>& gains() const { return gains_; }
  const TextureSize& size() const { return size_; }

 private:
  struct View {
    std::array<Eigen::half, 3> value;
    Eigen::half weight;
  };
  struct Texel {
    std::array<View, kViewsKept> best;
    Eigen::Vector3f place;  ///< where the first frame has it
    int lastFrame = -1;
    std::uint16_t views = 0;
    bool elsewhere = false;  ///< another frame has it at another place
    std::size_t kept() const { return std::min<std::size_t>(views, kViewsKept); }
  };
  double gainOf(const FrameOnSurface& f, bool exact) const;

  TextureSize size_;
  std::vector<Texel> texels_;
  std::vector<double> gains_;
};

Eigen::Vector3d mixed(const FrameOnSurface& f, const std::array<std::size_t, 3>& pixels, const std::array<double, 3>& shares) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    sum += shares[k] * Eigen::Map<const Eigen::Vector3f>(&f.linear.data[3 * pixels[k]]).cast<double>();
  return sum;
}

double TexelViews::gainOf(const FrameOnSurface& f, bool exact) const {
  std::vector<double> ratios;
  overTexels(f, size_, std::max(1, f.height / kRowsForGain),
             [&](std::size_t texel, const auto& pixels, const auto& shares, double) {
               const Texel& t = texels_[texel];
               if (t.views == 0) return;
               const auto best = std::max_element(t.best.begin(), t.best.begin() + std::ptrdiff_t(t.kept()),
                                                  [](const View& a, const View& b) { return a.weight < b.weight; });
               const double own = mixed(f, pixels, shares).sum();
               const double there = float(best->value[0]) + float(best->value[1]) + float(best->value[2]);
               if (own > kDarkShare * f.brightest && there > 0) ratios.push_back(there / own);
             });
  const double gain = ratios.empty() ? 1 : upperMedian(ratios);
  return exact || std::abs(gain - 1) > kSameGain ? gain : 1;
}

void TexelViews::add(const FrameOnSurface& f, int frame, bool samePlaces, bool exact) {
  const double gain = gainOf(f, exact);
  gains_.push_back(gain);
  overTexels(f, size_, 1, [&](std::size_t texel, const auto& pixels, const auto& shares, double texelsPerPixel) {
    Texel& t = texels_[texel];
    Eigen::Vector3f place = Eigen::Vector3f::Zero();
    double weight = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      place += float(shares[k]) * f.point[pixels[k]];
      weight += shares[k] * f.weight[pixels[k]];
    }
    if (t.views == 0) t.place = place;
    if (samePlaces && (place - t.place).norm() > kApartPixels * f.pixelSize[pixels[0]]) t.elsewhere = true;
    if (t.lastFrame == frame) return;  // on an edge between two triangles
    t.lastFrame = frame;
    View view;
    const Eigen::Vector3d value = gain * mixed(f, pixels, shares);
    for (int c = 0; c < 3; ++c) view.value[std::size_t(c)] = Eigen::half(float(value(c)));
    view.weight = Eigen::half(std::clamp(float(weight / texelsPerPixel), kLeastWeight, kMostWeight));
    if (t.views < kViewsKept) {
      t.best[t.views] = view;
    } else {
      const auto worst =
          std::min_element(t.best.begin(), t.best.end(), [](const View& a, const View& b) { return a.weight < b.weight; });
      if (worst->weight < view.weight) *worst = view;
    }
    if (t.views < std::numeric_limits<std::uint16_t>::max()) ++t.views;
  });
}

std::pair<Eigen::Vector3f, float> TexelViews::middleOf(std::size_t texel, double scale) const {
  const Texel& t = texels_[texel];
  Eigen::Vector3f colour;
  float codes = t.kept() > 1 ? 0 : 255;
  double best = 0, sum = 0;
  for (std::size_t k = 0; k < t.kept(); ++k) best = std::max(best, double(float(t.best[k].weight)));
  std::array<std::pair<double, double>, kViewsKept> sorted;  // value, weight
  const auto code = [&](double v) { return 255 * srgbFromLinear(std::clamp(v * scale, 0.0, 1.0)); };
  for (std::size_t c = 0; c < 3; ++c) {
    std::size_t n = 0;
    sum = 0;
    for (std::size_t k = 0; k < t.kept(); ++k)
      if (const double w = float(t.best[k].weight); w >= kLeastOfBest * best)
        sorted[n++] = {float(t.best[k].value[c]), w}, sum += w;
    std::sort(sorted.begin(), sorted.begin() + std::ptrdiff_t(n));
    double before = 0, mean = 0, low = sorted[0].first, high = low;
    for (std::size_t k = 0; k < n; ++k) {
      const auto& [value, w] = sorted[k];
      mean += value * std::max(0.0, std::min(before + w, 0.75 * sum) - std::max(before, 0.25 * sum));
      if (before < 0.25 * sum) low = value;
      if (before < 0.75 * sum) high = value;
      before += w;
    }
    colour(Eigen::Index(c)) = float(mean / (0.5 * sum));
    codes = std::max(codes, float(code(high) - code(low)));
  }
  return {colour, codes};
}

double TexelViews::severalPlaces() const {
  std::size_t seen = 0, elsewhere = 0;
  for (const Texel& t : texels_) seen += t.views > 0, elsewhere += t.elsewhere;
  return seen ? double(elsewhere) / double(seen) : 0;
}

/// Each pixel over the Lambert shading of the frame.
std::optional<Failure> divideShading(const Inspection& in, int frame, const Surface& surface, FramePixels& pixels,
                                     const std::vector<char>& beside, const ProgressFn& progress) {
  std::vector<Light> lights;
  std::string why = "no light is known";
  for (const auto& [id, estimate] : in.lightsFor(frame))
    if (*estimate)
      lights.push_back(carried((*estimate)->light, in.lightFromScene(frame, id).inverse()));
    else
      why = estimate->failure().message();
  if (lights.empty()) return Failure{Reason::NoLight, "its shading cannot be divided out: " + why};
  const Image none(pixels.linear.width, pixels.linear.height, 3);
  const Outcome<LambertShading> fit =
      fitLambert(surface, in.scene->frames[std::size_t(frame)].camera, lights, {pixels.linear, none, beside}, progress);
  if (!fit) return fit.failure();
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < fit->onSurface.size(); ++i)
    if (fit->onSurface[i]) sum += fit->shade.data[i], ++n;
  if (!(sum > 0)) return Failure{Reason::NoLight, "its shading cannot be divided out: it is black"};
  for (std::size_t i = 0; i < pixels.linear.data.size(); ++i)
    pixels.linear.data[i] /= float(std::max(double(fit->shade.data[i / 3]), kLeastLit * sum / n));
  return std::nullopt;
}

Outcome<FrameOnSurface> frameOnSurface(const Inspection& in, int frame, const SurfaceTextureRequest& r,
                                       const ProgressFn& progress) {
  Outcome<FramePixels> pixels = framePixels(in, frame);
  if (!pixels) return pixels.failure();
  const Outcome<std::shared_ptr<const Surface>> surface = in.surfaces->surfaceOf(frame, meshPolicy(in.request.settings));
  if (!surface) return surface.failure();
  const Frame& about = in.scene->frames[std::size_t(frame)];
  const Camera& camera = about.camera;
  const std::size_t count = pixels->usable.size();
  FrameOnSurface f;
  f.width = camera.width;
  f.height = camera.height;
  f.uv.assign(count, Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  f.point.resize(count);
  f.normal.resize(count);
  f.weight.resize(count);
  f.pixelSize.resize(count);
  f.sceneFromObject = about.worldFromObject;
  f.map = std::make_shared<const TextureCoordinates>(*in.scene, frame, **surface, r.mapping, r.repeat);
  const FrameEvidence& evidence = in.evidence[std::size_t(frame)];
  std::vector<LobeSpot> spots = lobeSpots(evidence.highlights);
  for (const LobeSpot& ignored : lobeSpots(evidence.ignored)) spots.push_back(ignored);
  const Eigen::Isometry3d back = about.worldFromObject.inverse();
  const Eigen::Vector3d eye = camera.centreInWorld();
  std::vector<char> beside(count, 0);
  forEachSurfacePixel(
      camera, **surface,
      [&](std::size_t i, const SurfacePoint& p) {
        const double distance = (eye - p.position).norm(), cosine = p.normal.dot(eye - p.position) / distance;
        const std::optional<Pixel> ideal = camera.project(p.position);
        if (!pixels->usable[i] || !ideal || !(cosine > kGrazing)) return;
        double away2 = kFromHighlight2;
        for (const LobeSpot& spot : spots) away2 = std::min(away2, spot.squaredRadius(*ideal));
        if (away2 < kInHighlight2) return;
        beside[i] = 1;
        f.uv[i] = f.map->at(p).cast<float>();
        f.point[i] = (back * p.position).cast<float>();
        f.normal[i] = (back.linear() * p.normal).cast<float>();
        f.weight[i] = float(cosine * (away2 / kFromHighlight2) * (away2 / kFromHighlight2));
        f.pixelSize[i] = float(distance / camera.pixelFromRay(0, 0));
      },
      progress, "texture");
  if (r.withoutShading)
    if (const std::optional<Failure> failure = divideShading(in, frame, **surface, *pixels, beside, progress)) return *failure;
  f.linear = std::move(pixels->linear);
  f.measure();
  if (!(f.texturesPerPixel.minCoeff() > 0)) return Failure{Reason::NoSurface, "no pixel shows the surface beside highlights"};
  return f;
}

/// Texels as fine as the frame's pixels, in a number of them for each texel that is asked for.
TextureSize finestSize(const FrameOnSurface& f, int& width, int& perTexel) {
  const auto power = [&](int k) { return std::exp2(std::clamp(std::ceil(-std::log2(f.texturesPerPixel(k))), 0.0, 30.0)); };
  const double finest = power(0), ratio = power(1) / finest;
  constexpr double kWidestByItself = kWidestTexture / 2;  // more takes hundreds of megabytes
  if (width == 0) width = int(std::min({finest, kWidestByItself, std::max(1.0, kWidestByItself / ratio)}));
  const double height = std::clamp(std::round(width * ratio), 1.0, double(kWidestTexture));
  perTexel = int(std::clamp(std::min(finest / width, std::sqrt(kMostTexels / (width * height))), 1.0, 64.0));
  return {width * perTexel, int(height) * perTexel};
}

/// Meshes have no coordinates that go with them: all frames must show the same one. @return whether there is one surface alone
Outcome<bool> oneSurface(const Scene& scene, const std::vector<int>& frames, TextureMapping mapping) {
  const Frame& first = scene.frames[std::size_t(frames.front())];
  const AnalyticSpec* const formula = scene.formulaOf(first.surface);
  bool same = true;
  for (const int i : frames) {
    const Frame& f = scene.frames[std::size_t(i)];
    if (f.surface == first.surface) continue;
    same = false;
    const AnalyticSpec* const other = scene.formulaOf(f.surface);
    if (formula && other && formula->type == other->type && mapping == TextureMapping::Natural) continue;
    return Failure{Reason::NotSupported, "frames " + first.id + " and " + f.id + " show different surfaces (" + first.surface +
                                             ", " + f.surface +
                                             "), and no coordinates go from one to the other; choose frames of one"};
  }
  if (first.surface.empty() && mapping == TextureMapping::Spherical)
    return Failure{Reason::NotSupported, "each depth map has a middle of its own; the mapping box or planar is the same for all"};
  return same;
}

SurfaceTexture textureFrom(const TexelViews& texels, int width, int perTexel, bool withoutShading) {
  const TextureSize fine = texels.size();
  SurfaceTexture result;
  const int height = fine.height / perTexel;
  result.colour = Image(width, height, 3);
  result.views.assign(std::size_t(width) * std::size_t(height), 0);
  result.codes.assign(result.views.size(), 0);
  const auto eachPart = [&](std::size_t texel, const auto& work) {
    const std::size_t x = texel % std::size_t(width) * std::size_t(perTexel),
                      y = texel / std::size_t(width) * std::size_t(perTexel);
    for (std::size_t k = 0; k < std::size_t(perTexel) * std::size_t(perTexel); ++k) {
      const std::size_t part = (y + k / std::size_t(perTexel)) * std::size_t(fine.width) + x + k % std::size_t(perTexel);
      if (texels.viewsOf(part) > 0) work(part);
    }
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<float> brightest;
  double scale = 1 / upperMedian(texels.gains());
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    float n = 0;
    eachPart(i, [&](std::size_t part) {
      sum += texels.middleOf(part, scale).first;
      result.views[i] = std::max(result.views[i], texels.viewsOf(part));
      ++n;
    });
    if (n == 0) continue;
    Eigen::Map<Eigen::Vector3f>(&result.colour.data[3 * i]) = sum / n;
    mean += (sum / n).cast<double>();
    brightest.push_back((sum / n).maxCoeff());
  }
  mean /= std::max<double>(1, double(brightest.size()));
  if (withoutShading) {
    result.albedo =
        std::min(1.0, kBrightest / (scale * ranked(brightest, std::size_t(kAlmostAll * double(brightest.size() - 1)))));
    scale *= result.albedo;
  }
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    Eigen::Map<Eigen::Vector3f> colour(&result.colour.data[3 * i]);
    if (result.views[i] == 0) colour = mean.cast<float>();
    colour *= float(scale);
    eachPart(i, [&](std::size_t part) { result.codes[i] = std::max(result.codes[i], texels.middleOf(part, scale).second); });
  }
  return result;
}

void addTextureRemarks(const TexelViews& texels, bool withoutShading, SurfaceTexture& result) {
  const auto& gains = texels.gains();
  const auto [least, most] = std::minmax_element(gains.begin(), gains.end());
  if (!withoutShading && *least < *most)
    result.remarks.push_back(
        formatted("the frames' brightness differs by a factor of %.2f, and all are brought to one; where the "
                  "light moves over the surface, --shading remove is better",
                  *most / *least));
  if (const double share = texels.severalPlaces(); share > kSeveralPlaces)
    result.remarks.push_back(
        formatted("%.0f %% of the texels lie on several places of the surface, whose colours are mixed there; another --mapping "
                  "(spherical), or --repeat, may keep them apart",
                  100 * share));
  std::vector<float> codes;
  std::size_t seen = 0, few = 0;
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    if (result.views[i] == 0) continue;
    ++seen;
    few += result.views[i] < 3;
    if (result.views[i] > 1) codes.push_back(result.codes[i]);
  }
  if (double(few) > kFewViews * double(seen))
    result.remarks.push_back(
        formatted("fewer than three views see %.0f %% of the texels: a highlight that was not found stays there",
                  100 * double(few) / double(seen)));
  if (const double differ = codes.empty() ? 0 : upperMedian(codes); differ > kViewsDiffer)
    result.remarks.push_back(
        formatted("the views of a texel differ by %.0f codes (median): poses or surface are off, or the light "
                  "moves over the surface",
                  differ));
}

}  // namespace

Outcome<SurfaceTexture> surfaceTexture(const Inspection& in, const SurfaceTextureRequest& r, const ProgressFn& progress) {
  require(in.scene && in.given && in.surfaces, "surfaceTexture: an inspection");
  require(r.width >= 0 && r.width <= kWidestTexture, "surfaceTexture: a width of 0 to 4096 px");
  const std::set<int> excluded(in.request.excluded.begin(), in.request.excluded.end());
  std::vector<int> frames = r.frames;
  for (int i = 0; r.frames.empty() && i < int(in.scene->frames.size()); ++i)
    if (!excluded.count(i)) frames.push_back(i);
  require(!frames.empty(), "surfaceTexture: at least one frame");
  const Outcome<bool> same = oneSurface(*in.scene, frames, r.mapping);
  if (!same) return same.failure();
  std::optional<TexelViews> texels;
  std::vector<std::string> left;
  std::optional<Failure> first;
  std::string words;
  int width = r.width, perTexel = 1;
  for (const int frame : frames) {
    const Outcome<FrameOnSurface> seen = frameOnSurface(in, frame, r, progress);
    if (!seen) {
      left.push_back(frameName(*in.scene, frame));
      if (!first) first = Failure{seen.failure().reason, "frame " + left.front() + ": " + seen.failure().detail};
      continue;
    }
    if (!texels) texels.emplace(finestSize(*seen, width, perTexel));
    texels->add(*seen, frame, *same, r.withoutShading);
    words = seen->map->words();
  }
  if (!texels) return *first;
  SurfaceTexture result = textureFrom(*texels, width, perTexel, r.withoutShading);
  result.frames = int(frames.size() - left.size());
  result.words = words;
  if (first) result.remarks.push_back(framesText(left) + (left.size() == 1 ? " is" : " are") + " left out: " + first->message());
  addTextureRemarks(*texels, r.withoutShading, result);
  return result;
}

Image texturePicture(const SurfaceTexture& t) {
  Image picture(t.colour.width, t.colour.height, 4);
  for (std::size_t i = 0; i < t.views.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      picture.data[4 * i + c] = float(srgbFromLinear(std::clamp(double(t.colour.data[3 * i + c]), 0.0, 1.0)));
    picture.data[4 * i + 3] = t.views[i] > 0 ? 1.f : 0.f;
  }
  return picture;
}

Image surePicture(const SurfaceTexture& t) {
  Image picture(t.colour.width, t.colour.height, 3);
  for (std::size_t i = 0; i < t.views.size(); ++i) {
    picture.data[3 * i] = float(std::min(t.views[i], 255)) / 255;
    picture.data[3 * i + 1] = std::min(t.codes[i], 255.f) / 255;
  }
  return picture;
}

}  // namespace glint
