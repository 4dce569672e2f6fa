// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/diffuse_texture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/hand_edits.h"
#include "core/pipeline/highlight_motion.h"
#include "core/pipeline/texture_panel.h"

namespace glint {
namespace {

constexpr double kExplained = 0.5;      // of the fine structure, that other views must leave at most
constexpr std::size_t kLeastPanel = 4;  // views: the median of three is the first that a highlight in one cannot move
constexpr double kKeptReach = 6;        // radii around a highlight that are kept: a patch of pixels reaches 3.2
constexpr int kKeptMarginPx = 12;       // beyond that, for small ones

/// The part of a picture of diffuse light that these highlights need.
std::shared_ptr<const DiffuseLight> aroundHighlights(const Image& diffuse, const Camera& camera,
                                                     const std::vector<Highlight>& highlights) {
  Eigen::AlignedBox2i box;
  for (const Highlight& h : highlights) {
    Eigen::AlignedBox2d own;
    for (const Pixel& p : h.contour.points)
      if (const Pixel measured = camera.distorted(p); measured.allFinite()) own.extend(measured);
    if (own.isEmpty()) continue;
    const Pixel reach = 0.5 * kKeptReach * own.sizes() + Pixel::Constant(kKeptMarginPx);
    box.extend((own.center() - reach).array().floor().matrix().cast<int>().eval());
    box.extend((own.center() + reach).array().ceil().matrix().cast<int>().eval());
  }
  box = box.intersection(Eigen::AlignedBox2i(Eigen::Vector2i(0, 0), Eigen::Vector2i(diffuse.width - 1, diffuse.height - 1)));
  if (box.isEmpty()) return nullptr;
  DiffuseLight part;
  part.left = box.min().x();
  part.top = box.min().y();
  part.value = Image(box.sizes().x() + 1, box.sizes().y() + 1, 1);
  for (int y = 0; y < part.value.height; ++y)
    for (int x = 0; x < part.value.width; ++x) part.value.at(x, y) = diffuse.at(part.left + x, part.top + y);
  return std::make_shared<const DiffuseLight>(std::move(part));
}

std::shared_ptr<const DiffuseLight> whole(Image diffuse) {
  return std::make_shared<const DiffuseLight>(DiffuseLight{0, 0, std::move(diffuse)});
}

/// Whether the other views explain a view's fine structure: what is left where both are known.
bool isExplained(const TextureView& view, const Image& diffuse) {
  Image before = view.value, after = view.value;
  std::vector<char> usable(before.data.size(), 0);
  for (std::size_t i = 0; i < usable.size(); ++i) {
    usable[i] = std::isfinite(before.data[i]) && std::isfinite(diffuse.data[i]);
    if (!usable[i]) continue;
    after.data[i] -= diffuse.data[i];
  }
  const FineStructure structure = fineStructure(before, usable);
  return structure.isTexture() && fineStructure(after, usable).amount <= kExplained * structure.amount;
}

class TextureOff {
 public:
  TextureOff(Inspection& r, const SurfaceOfFrame& surfaceOf, const ProgressFn& progress)
      : r_(r), surfaceOf_(surfaceOf), progress_(progress), in_(*r.inputs.evidence) {}

  /// Frames of one surface. @param panel  the views that are asked. @param frames  those to be detected again
  void operator()(const std::vector<int>& panel, const std::vector<int>& frames) {
    const std::shared_ptr<const Surface> surface = surfaceOf_(frames.front());
    if (!surface || panel.size() < kLeastPanel) return;
    std::vector<int> held = panel;
    held.insert(held.end(), frames.begin(), frames.end());
    const PhotographsHeld photographs(*r_.scene, held);
    std::vector<std::optional<TextureView>> read(panel.size());
    parallelFor(
        static_cast<int>(panel.size()), [&](int n) { read[std::size_t(n)] = viewOf(panel[std::size_t(n)], *surface); }, progress_,
        "texture");
    std::vector<TextureView> views;
    for (std::optional<TextureView>& view : read)
      if (view) views.push_back(*std::move(view));
    TexturePanel asked(std::move(views), surface);
    if (!findSpots(asked)) return;
    asked.fitTails();
    parallelFor(
        static_cast<int>(frames.size()), [&](int n) { detectAgain(frames[std::size_t(n)], asked, *surface); }, progress_,
        "detect again");
  }

 private:
  std::optional<TextureView> viewOf(int frame, const Surface& surface) const {
    Outcome<TextureView> view = textureView(*r_.scene, frame, in_.source, in_.detect, surface);
    return view ? std::optional(*std::move(view)) : std::nullopt;
  }

  /// The spots of each view over the median of the others. @return whether the surface is textured
  bool findSpots(TexturePanel& panel) const {
    std::vector<char> explained(panel.views().size(), 0);
    std::vector<std::vector<LobeSpot>> spots(panel.views().size());
    parallelFor(
        static_cast<int>(panel.views().size()),
        [&](int n) {
          const TextureView& view = panel.views()[std::size_t(n)];
          Image diffuse = panel.underByMedian(view);
          explained[std::size_t(n)] = isExplained(view, diffuse);
          if (!explained[std::size_t(n)]) return;
          spots[std::size_t(n)] =
              lobeSpots(gatherEvidence(*r_.scene, view.frame, in_.source, in_.detect, {}, whole(std::move(diffuse))).highlights);
        },
        progress_, "texture");
    for (std::size_t n = 0; n < spots.size(); ++n) panel.views()[n].spots = std::move(spots[n]);
    return 2 * static_cast<std::size_t>(std::count(explained.begin(), explained.end(), 1)) > explained.size();
  }

  void detectAgain(int frame, const TexturePanel& panel, const Surface& surface) {
    const std::optional<TextureView> view = viewOf(frame, surface);
    if (!view) return;
    Image diffuse = panel.under(*view);
    FrameEvidence& evidence = r_.evidence[static_cast<std::size_t>(frame)];
    const FrameEvidence first = gatherEvidence(*r_.scene, frame, in_.source, in_.detect, {}, whole(diffuse));
    const Camera& camera = r_.scene->frames[static_cast<std::size_t>(frame)].camera;
    std::shared_ptr<const DiffuseLight> part = aroundHighlights(diffuse, camera, first.highlights);
    if (!part) part = whole(std::move(diffuse));
    FrameEvidence again = evidenceFor(*r_.scene, frame, in_, std::move(part));
    again.asSeen = std::make_shared<const FrameEvidence>(std::move(evidence));
    evidence = std::move(again);
  }

  Inspection& r_;
  const SurfaceOfFrame& surfaceOf_;
  const ProgressFn& progress_;
  const EvidenceInputs& in_;
};

}  // namespace

void takeTextureOff(Inspection& r, const std::vector<int>& frames, const SurfaceOfFrame& surfaceOf, const ProgressFn& progress) {
  if (!r.inputs.evidence->detect.texture || r.request.whatIf.synthesise) return;
  std::map<std::string, std::vector<int>> textured;
  for (const int f : frames) {
    const FrameEvidence& e = r.evidence[static_cast<std::size_t>(f)];
    const Frame& frame = r.scene->frames[static_cast<std::size_t>(f)];
    if (e.structure.isTexture() && !e.diffuse && !frame.surface.empty()) textured[r.surfaces->keyOf(f)].push_back(f);
  }
  if (textured.empty()) return;
  const std::vector<std::vector<int>> panels = motionPanels(*r.scene, *r.surfaces);
  TextureOff takeOff(r, surfaceOf, progress);
  for (const auto& [key, own] : textured) {
    // Each frame's panel leaves the frame itself out.
    std::set<int> panel;
    for (int f = 0; f < static_cast<int>(panels.size()); ++f)
      if (!r.scene->frames[static_cast<std::size_t>(f)].surface.empty() && r.surfaces->keyOf(f) == key)
        panel.insert(panels[static_cast<std::size_t>(f)].begin(), panels[static_cast<std::size_t>(f)].end());
    takeOff({panel.begin(), panel.end()}, own);
  }
}

std::string takenOffRemark(const Inspection& r) {
  std::size_t frames = 0, of = 0;
  for (const int f : r.train.frames) {
    if (!r.isTraining(f)) continue;
    ++of;
    frames += r.evidence[static_cast<std::size_t>(f)].diffuse != nullptr;
  }
  if (frames == 0) return "";
  return formatted(
      "the surface is textured: under the highlights of %zu of %zu training frames, the diffuse light was taken from the other "
      "views "
      "(detect.texture)",
      frames, of);
}

}  // namespace glint
