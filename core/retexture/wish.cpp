// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/wish.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/image_header.h"
#include "core/pipeline/pipeline.h"
#include "core/scene/scene.h"

namespace glint {

namespace {

constexpr double kMostRepeats = 1e4;     // more textures than a frame has pixels
constexpr double kLargestMargin = 1000;  // px

/// The model asked for, the one that the session shows, or the richest of its models.
std::string modelFor(const RetextureWish& wish, const std::vector<std::string>& models) {
  if (!wish.model.empty()) return modelByName(wish.model).id();
  if (std::find(models.begin(), models.end(), wish.shown) != models.end()) return wish.shown;
  std::string richest;
  for (const std::string& name : modelIds())
    if (std::find(models.begin(), models.end(), name) != models.end()) richest = name;
  if (richest.empty()) throw InputError(wish.session, "--model", "the session names no model; give one");
  return richest;
}

RetextureRequest requestOf(const RetextureWish& wish, const std::string& model, const Camera& camera) {
  RetextureRequest r;
  r.model = model;
  r.light = wish.light;
  r.mapping = textureMappingNamed(wish.mapping);
  r.shading = shadingSourceNamed(wish.shading);
  r.repeat = wish.repeat;
  if (wish.albedo > 0) r.albedo = wish.albedo;
  r.marginPx = wish.marginPx;
  r.base = wish.remove ? RetextureBase::Removed : wish.texture.empty() ? RetextureBase::Background : RetextureBase::Texture;
  if (wish.picture)
    r.picture = *wish.picture;
  else if (r.base == RetextureBase::Texture)
    r.picture = readTexture(wish.texture, "--texture");
  else if (r.base == RetextureBase::Background)
    r.picture = readBackground(wish.background, camera, "--background");
  return r;
}

/// A light that no frame nor fit names is a slip of the pen, not a lack of data.
void requireLight(const std::string& light, const Inspection& inspection, const std::string& model) {
  if (light.empty()) return;
  std::set<std::string> known;
  for (const ModelResult::Fit& f : inspection.models.at(model).fits) known.insert(f.light);
  if (known.count(light)) return;
  std::string names;
  for (const std::string& id : known) names += (names.empty() ? "" : ", ") + id;
  throw InputError("", "--light", "there is no light \"" + light + "\"" + (names.empty() ? "" : "; the model has " + names));
}

}  // namespace

void requireRepeat(double repeat) {
  if (!(repeat > 0 && repeat <= kMostRepeats)) throw InputError("", "--repeat", "must be above 0, at most 10000");
}

void requireAnswerable(const RetextureWish& wish) {
  const int asked = int(!wish.texture.empty()) + int(!wish.background.empty()) + int(wish.remove);
  if (asked != 1) throw InputError("", "retexture", "give one of --texture FILE, --background FILE and --remove");
  requireRepeat(wish.repeat);
  if (!(wish.albedo >= 0 && wish.albedo <= 1)) throw InputError("", "--albedo", "must be above 0, at most 1");
  if (!(wish.marginPx >= 0 && wish.marginPx <= kLargestMargin)) throw InputError("", "--margin", "must be 0 to 1000 px");
}

RetexturedFrame retextureAsWished(std::shared_ptr<const Scene> scene, InspectionRequest request, int frame,
                                  const RetextureWish& wish, const ProgressFn& progress, const Inspection* previous) {
  requireAnswerable(wish);
  const std::string model = modelFor(wish, request.models);
  request.models = {model};
  const Frame& about = scene->frames.at(static_cast<std::size_t>(frame));
  const RetextureRequest wanted = requestOf(wish, model, about.camera);
  Inspection inspection = answer(scene, {request, Question::Part::Frame, frame}, progress,
                                 previous ? std::vector{previous} : std::vector<const Inspection*>{});
  requireLight(wish.light, inspection, model);
  Outcome<Retextured> result = retexture(inspection, frame, wanted, progress);
  if (!result) {
    const Failure& f = result.failure();
    result = Failure{f.reason, model + ", frame " + about.id + (f.detail.empty() ? "" : ": " + f.detail)};
  }
  return {model, std::move(inspection), std::move(result)};
}

namespace {

/// A failure's detail begins with the file, which the error names itself.
std::string withoutFile(const std::string& detail, const std::filesystem::path& file) {
  const std::string start = file.string() + ": ";
  return detail.rfind(start, 0) == 0 ? detail.substr(start.size()) : detail;
}

}  // namespace

Image readBackground(const std::filesystem::path& file, const Camera& camera, const std::string& flag) {
  Frame frame;  // the one decoder of photographs, with its checks
  frame.image = file;
  frame.camera.width = camera.width;
  frame.camera.height = camera.height;
  const Outcome<Image> read = readLinear(frame, FrameSource::Image);
  if (!read) throw InputError(file.string(), flag, withoutFile(read.failure().detail, file));
  Image image(read->width, read->height, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const float v = read->data[read->channels == 3 ? i : i / 3];
    if (!std::isfinite(v) || v < 0)
      throw InputError(file.string(), flag,
                       "pixel (" + std::to_string(i / 3 % std::size_t(image.width)) + ", " +
                           std::to_string(i / 3 / std::size_t(image.width)) + ") is negative or not finite; light is neither");
    image.data[i] = v;
  }
  return image;
}

Image readTexture(const std::filesystem::path& file, const std::string& flag) {
  const ImageHeader header = readImageHeader(readFile(file, Limit::ImageMegabytes));
  if (!header.problem.empty()) throw InputError(file.string(), flag, header.problem);
  constexpr auto kMost = std::uint64_t(std::numeric_limits<int>::max());
  if (header.width > kMost || header.height > kMost) throw InputError(file.string(), flag, "the image is too large");
  Camera size;
  size.width = int(header.width);
  size.height = int(header.height);
  return readBackground(file, size, flag);
}

}  // namespace glint
