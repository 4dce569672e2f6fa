// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/lobe_stage.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <set>

#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/geometry/transforms.h"
#include "core/model/model.h"
#include "core/model/models.h"
#include "core/model/pixel_evidence.h"
#include "core/model/reflectance_settings.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/depth_motion.h"
#include "core/pipeline/diffuse_checks.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/hand_edits.h"
#include "core/pipeline/highlight_motion.h"
#include "core/pipeline/known_lamps.h"
#include "core/pipeline/response_check.h"
#include "core/pipeline/stage_inputs.h"
#include "core/pipeline/training.h"
#include "core/reflectance/other_lamps.h"
#include "core/reflectance/pixel_fit.h"

namespace glint {

namespace {

constexpr int kRoundsWithoutOthers = 2;  // after one, a lobe may still hide a blur: 0.09 % of the diameter (GGX, four lamps)
constexpr int kEnoughWhole = 3;          // training highlights that determine every model's light; a cut one adds little to them

bool trains(const Inspection& r, int frame) {
  return std::binary_search(r.train.frames.begin(), r.train.frames.end(), frame) &&
         std::find(r.request.excluded.begin(), r.request.excluded.end(), frame) == r.request.excluded.end();
}

/// What else is bright in the frame.
std::vector<Highlight> ofOthers(const FrameEvidence& e, const std::string& light) {
  std::vector<Highlight> others;
  for (const Highlight& h : e.highlights)
    if (h.light != light) others.push_back(h);
  for (const WithheldTexture& t : e.textures) others.push_back(t.highlight);
  return others;
}

/// With the level as a share of the highlight's own peak: that of a weak one is larger than the level of the frame's strongest,
/// and its contour small beside its footprint.
Highlight atOwnLevel(Highlight h, const FrameEvidence& e) {
  double strongest = h.peakValue;
  for (const Highlight& o : e.highlights)
    if (o.light == h.light) strongest = std::max(strongest, o.peakValue);
  if (h.peakValue > 0) h.level *= strongest / h.peakValue;
  return h;
}

bool wasDetected(const FrameEvidence& e) {
  return e.frame >= 0 && !e.highlights.empty() &&
         std::none_of(e.highlights.begin(), e.highlights.end(), [](const Highlight& h) { return h.fromScene; });
}

/// The lobe of the detection is the one that the pixels show, whatever the model is told to take: contours do not depend on it.
constexpr std::array<const char*, 2> kOfTheModel{"fit.lobe", "fit.light_size"};
Settings anyLobe(Settings settings) {
  for (const char* key : kOfTheModel) settings.reset(key);
  return settings;
}
bool takesAnyLobe(const Settings& settings) {
  const Settings any = anyLobe(settings);
  return std::all_of(kOfTheModel.begin(), kOfTheModel.end(),
                     [&](const char* key) { return settings.text(key) == any.text(key); });
}

/// A lobe as wide as the contours say, for pixels that no lobe explained.
std::optional<LobeModel> startOf(const std::vector<TrainingView>& views, const Light& light) {
  constexpr int kPoints = 36;  // of a contour
  const double alpha = medianContourAngle(views, light, kPoints);
  if (!(alpha > 0)) return std::nullopt;
  LobeModel start;
  start.lamp = light;
  start.roughness = std::min(std::tan(alpha) / std::sqrt(std::log(2.0)), 1.0);  // of a Gaussian at half of its peak
  return start;
}

/// Whether the pixels are what the codes of the images mean, and nothing was taken off.
bool showCodes(const Inspection& r, const std::vector<TrainingView>& views) {
  return std::all_of(views.begin(), views.end(), [&](const TrainingView& v) {
    const FrameEvidence& e = r.evidence[static_cast<std::size_t>(v.frame)];
    return isIdentity(r.lightFromScene(v.frame, v.highlight.light)) && !e.diffuse && e.separated.empty() &&
           !(r.scene->frames[static_cast<std::size_t>(v.frame)].response.vignetting() > 0);
  });
}

/// One light's. What fails is kept with its question.
/// @param near  see fitViewsPixels()
void fitLobe(Inspection& r, const FitKey& key, const std::vector<TrainingView>& views, const PixelFit* near,
             const ProgressFn& goesOn) {
  // The start is the same whatever the settings of the light are: they do not matter to where the fit ends.
  const Outcome<LightEstimate> estimate = estimateLight(views, Settings{});
  const std::optional<LightEstimate> light = estimate ? std::optional(*estimate) : std::nullopt;
  const Settings settings = anyLobe(r.request.settings);
  Outcome<PixelFit> fit = fitViewsPixels(views, light, settings, goesOn, near);
  ++r.work.pixelFits;
  const std::optional<LobeModel> start = fit     ? asksForResponse(*fit) ? std::optional(fit->model) : std::nullopt
                                         : light ? startOf(views, light->light)
                                                 : std::nullopt;
  if (start && showCodes(r, views))
    addDoubt(r, key, responseDoubt(*r.scene, r.inputs.lobes->evidence.source, views, *start, goesOn));
  if (fit) {
    r.pixelFits.insert_or_assign(key, std::make_shared<const PixelFit>(*std::move(fit)));
    return;
  }
  r.pixelFits.insert_or_assign(key, fit.failure());
  r.unexplained.insert_or_assign(
      key, std::make_shared<const UnexplainedPixels>(UnexplainedPixels{views, light, settings, fit.failure()}));
}

using Groups = std::map<FitKey, std::vector<TrainingView>>;

/// One group in place of those of all known lamps that share a material: that of the first of them. @return who shares it
std::map<FitKey, std::vector<FitKey>> poolKnownLamps(const Inspection& r, Groups& groups) {
  std::map<FitKey, std::vector<FitKey>> pools;
  Groups pooled;
  for (const auto& [key, views] : groups) {
    const std::optional<KnownLamp> lamp = knownLamp(*r.scene, key.light);
    if (!lamp) {
      pooled.emplace(key, views);
      continue;
    }
    const auto first = std::find_if(pools.begin(), pools.end(), [&, &surface = key.surface](const auto& pool) {
      return pool.first.surface == surface && shareMaterial(*knownLamp(*r.scene, pool.first.light), *lamp);
    });
    const FitKey& of = first == pools.end() ? key : first->first;
    if (first == pools.end())  // also lamps that no frame shows
      for (const TrueLight& other : r.scene->lights)
        if (other.known && shareMaterial(*knownLamp(*r.scene, other.id), *lamp)) pools[key].push_back({other.id, key.surface});
    std::vector<TrainingView>& all = pooled[of];
    all.insert(all.end(), views.begin(), views.end());
  }
  for (const auto& [key, sharers] : pools) pooled[key] = pooledViews(pooled[key], *knownLamp(*r.scene, key.light));
  groups = std::move(pooled);
  return pools;
}

/// The lobe of one known lamp's pixels for the others.
void shareLobe(Inspection& r, const FitKey& of, const std::vector<FitKey>& sharers) {
  for (const FitKey& key : sharers) {
    if (key == of) continue;
    const Outcome<std::shared_ptr<const PixelFit>>& found = r.pixelFits.at(of);
    if (found) {
      PixelFit own = **found;
      own.model.lamp = knownLamp(*r.scene, key.light)->lamp;
      r.pixelFits.insert_or_assign(key, std::make_shared<const PixelFit>(std::move(own)));
    } else {
      r.pixelFits.insert_or_assign(key, found.failure());
    }
    if (const auto doubt = r.pixelDoubts.find(of); doubt != r.pixelDoubts.end()) r.pixelDoubts[key] = doubt->second;
  }
}

/// The lobe of a fit in the scene's coordinates of a frame, in which pixels are.
LobeModel lobeInScene(const Inspection& r, int frame, const std::string& light, LobeModel model) {
  model.lamp = carried(model.lamp, r.lightFromScene(frame, light).inverse());
  return model;
}

/// Takes the light of the other lamps off the pixels of each, where their lobes are known and reach there.
/// @return  whose pixels changed
std::set<FitKey> takeOtherLampsOff(Inspection& r, Groups& groups) {
  std::map<int, std::map<FitKey, std::vector<TrainingView*>>> byFrame;
  for (auto& [key, views] : groups)
    if (const auto fit = r.pixelFits.find(key); fit != r.pixelFits.end() && fit->second)
      for (TrainingView& v : views) byFrame[v.frame][key].push_back(&v);
  std::set<FitKey> changed;
  for (const auto& [frame, own] : byFrame) {
    std::vector<LampPatches> lamps;
    for (const auto& [key, views] : own) {
      const PixelFit& fit = **r.pixelFits.at(key);
      lamps.push_back({{}, lobeInScene(r, frame, key.light, fit.model), fit.background});
      for (const TrainingView* v : views) lamps.back().patches.push_back(v->pixels.get());
    }
    const TrainingView any = carried(*own.begin()->second.front(), own.begin()->second.front()->fromScene.inverse());
    const std::vector<std::vector<LampLight>> others = lightOfOthers(lamps, *any.surface, any.camera);
    std::size_t lamp = 0;
    for (const auto& [key, views] : own) {
      const std::vector<LampLight>& light = others[lamp++];
      if (light.empty()) continue;
      changed.insert(key);
      for (TrainingView* v : views) {
        const auto left =
            std::make_shared<PixelPatch>(withoutLight(*v->pixels, lightOn(*v->pixels, light, *any.surface, any.camera)));
        for (auto p = r.patches.lower_bound({frame, 0}); p != r.patches.end() && p->first.first == frame; ++p)
          if (p->second == v->pixels) p->second = left;
        v->pixels = left;
      }
    }
  }
  return changed;
}

using PixelFits = std::map<FitKey, Outcome<std::shared_ptr<const PixelFit>>>;

/// Fits the lobes of lamps; known ones that share a material as one.
/// @param own   each lamp's views. @param only  those whose pixels changed; null = all
/// @param near  where their fits start; null = they search
void fitGroups(Inspection& r, const Groups& own, const std::set<FitKey>* only, const PixelFits* near,
               const ProgressFn& progress) {
  Groups groups = own;
  const std::map<FitKey, std::vector<FitKey>> pools = poolKnownLamps(r, groups);
  int done = 0;
  const auto goesOn = [&](const StageEvent&) { return report(progress, {"lobe", done, static_cast<int>(groups.size())}); };
  for (const auto& [key, views] : groups) {
    if (!goesOn({})) throw Stopped{};
    const auto pool = pools.find(key);
    const std::vector<FitKey> sharers = pool == pools.end() ? std::vector{key} : pool->second;
    ++done;
    if (only && std::none_of(sharers.begin(), sharers.end(), [&](const FitKey& k) { return only->count(k) > 0; })) continue;
    std::optional<PixelFit> start;
    if (const auto found = near ? near->find(key) : PixelFits::const_iterator(); near && found != near->end() && found->second) {
      start = **found->second;
      start->model.blurVariance = 1;  // asks for a blur, which the other lamps may have hidden
    }
    fitLobe(r, key, views, start ? &*start : nullptr, goesOn);
    shareLobe(r, key, sharers);
  }
}

/// All lamps; then again those into whose pixels others reach, without the light of these: from scratch, since tails may have
/// passed for a background, and from there once more with the better lobes.
void fitLobesOf(Inspection& r, const Groups& seen, const ProgressFn& progress) {
  const std::map<FitKey, std::string> doubts = r.pixelDoubts;
  fitGroups(r, seen, nullptr, nullptr, progress);
  const std::map<std::pair<int, int>, std::shared_ptr<const PixelPatch>> patches = r.patches;
  for (int round = 0; round < kRoundsWithoutOthers; ++round) {
    Groups left = seen;
    r.patches = patches;
    const PixelFits before = r.pixelFits;
    const std::set<FitKey> changed = takeOtherLampsOff(r, left);
    if (changed.empty()) return;
    for (const FitKey& key : changed) {
      r.pixelDoubts.erase(key);
      if (const auto own = doubts.find(key); own != doubts.end()) r.pixelDoubts.insert(*own);
    }
    fitGroups(r, left, &changed, round > 0 ? &before : nullptr, progress);
  }
}

/// For each light of a frame with a known lobe, the light of the other ones where it shows.
std::map<std::string, std::vector<LampLight>> otherLampsIn(const Inspection& lobes, const LinearPixels& pixels,
                                                           const FrameEvidence& detected, const Camera& camera,
                                                           const Surface& surface) {
  std::vector<PixelPatch> patches;
  patches.reserve(detected.highlights.size());
  std::map<std::string, LampPatches> lamps;
  for (const Highlight& h : detected.highlights) {
    const auto fit = lobes.pixelFits.find(lobes.keyFor(detected.frame, h.light));
    if (h.light.empty() || fit == lobes.pixelFits.end() || !fit->second) continue;
    Outcome<PixelPatch> patch = pixelPatch(pixels, camera, surface, detected.frame, h, ofOthers(detected, h.light));
    if (!patch) continue;
    LampPatches& lamp = lamps
                            .try_emplace(h.light, LampPatches{{},
                                                              lobeInScene(lobes, detected.frame, h.light, (*fit->second)->model),
                                                              (*fit->second)->background})
                            .first->second;
    lamp.patches.push_back(&patches.emplace_back(*std::move(patch)));
  }
  std::map<std::string, std::vector<LampLight>> others;
  std::vector<LampPatches> all;
  for (const auto& [light, lamp] : lamps) all.push_back(lamp);
  std::vector<std::vector<LampLight>> found = lightOfOthers(all, surface, camera);
  std::size_t n = 0;
  for (const auto& [light, lamp] : lamps) others[light] = std::move(found[n++]);
  return others;
}

}  // namespace

bool looksAtPixels(const InspectionRequest& request) {
  const std::string& evidence = request.settings.text("fit.evidence");
  return request.settings.text("detect.background") == "lobe" || evidence == "auto" || evidence == "pixels";
}

bool worthALook(const Scene& scene, const InspectionRequest& request, const std::vector<const Inspection*>& known) {
  const auto takesPixels = [](const std::string& m) { return modelByName(m).takesPixels(); };
  if (!looksAtPixels(request) || std::all_of(request.models.begin(), request.models.end(), takesPixels)) return false;
  const auto withPixels = [](const Inspection* k) { return !k->pixelsLeft; };
  const auto newest =
      std::find_if(known.begin(), known.end(), [&](const Inspection* k) { return withPixels(k) && !k->models.empty(); });
  if (newest == known.end()) return true;
  // Contours that are found again would move twice at every step of a drag: their first ones serve where there are no others yet.
  if (DetectSettings(request.settings).background == BackgroundUse::Lobe) return false;
  StageInputs asked;
  asked.lobes = lobeInputs(request, parseTrainSpec(request.train, scene), lightsAreOpenIn(scene, request));
  const auto hasLobes = [&](const Inspection* k) { return withPixels(k) && asked.same(Stage::Lobes, k->inputs); };
  const auto isShown = [&](const std::string& m) { return takesPixels(m) && (*newest)->models.count(m); };
  return std::none_of(known.begin(), known.end(), hasLobes) &&
         std::none_of(request.models.begin(), request.models.end(), isShown);
}

void fitLobes(Inspection& r, const SurfaceOfFrame& surfaceOf, bool together, const ProgressFn& progress) {
  if (!looksAtPixels(r.request)) return;
  std::vector<int> frames;
  for (const int f : r.train.frames)
    if (trains(r, f) && wasDetected(r.evidence[static_cast<std::size_t>(f)])) frames.push_back(f);
  struct Seen {
    std::vector<TrainingView> views;
    std::vector<std::pair<int, int>> ids;
  };
  std::vector<Seen> seen(frames.size());
  const std::map<FitKey, CutUse> cut = useOfCut(r, CutUse::Pixels);
  const EvidenceInputs& asked = r.inputs.lobes->evidence;
  const bool sameLevel = together || r.inputs.evidence->detect.level == asked.detect.level;
  parallelFor(
      static_cast<int>(frames.size()),
      [&](int n) {
        const int f = frames[static_cast<std::size_t>(n)];
        const Frame& frame = r.scene->frames[static_cast<std::size_t>(f)];
        const FrameEvidence& own = r.evidence[static_cast<std::size_t>(f)];
        FrameEvidence evidence = sameLevel ? own : evidenceFor(*r.scene, f, asked, own.diffuse);
        if (!sameLevel) dropTextures(evidence, own.textures);
        const std::shared_ptr<const Surface> surface = surfaceOf(f);
        const Outcome<LinearPixels> pixels =
            pixelsOf(frame, asked.source, asked.detect, evidence.separated, evidence.diffuse.get());
        if (!surface || !pixels) return;
        for (int h = 0; h < static_cast<int>(evidence.highlights.size()); ++h) {
          const Highlight& highlight = evidence.highlights[static_cast<std::size_t>(h)];
          if (highlight.light.empty() || isSwitchedOff(r.request.whatIf, f, highlight.light) ||
              isIgnored(r.request.whatIf, f, highlight))
            continue;
          const auto use = cut.find(r.keyFor(f, highlight.light));
          TrainingView view = trainingViewIn(r, evidence, h, surface, use == cut.end() ? CutUse::None : use->second);
          if (!view.seen) continue;
          Outcome<PixelPatch> patch = pixelPatch(*pixels, frame.camera, *surface, f, atOwnLevel(highlight, evidence),
                                                 ofOthers(evidence, highlight.light));
          if (!patch) continue;
          view.pixels = std::make_shared<PixelPatch>(*std::move(patch));
          seen[static_cast<std::size_t>(n)].views.push_back(std::move(view));
          seen[static_cast<std::size_t>(n)].ids.emplace_back(f, h);
        }
      },
      progress, "pixels");
  Groups groups;
  for (const Seen& s : seen)
    for (std::size_t i = 0; i < s.views.size(); ++i) {
      r.patches[s.ids[i]] = s.views[i].pixels;
      groups[r.keyFor(s.views[i].frame, s.views[i].highlight.light)].push_back(s.views[i]);
    }
  const std::vector<SightedSurface> sighted = sightedSurfaces(r, frames, surfaceOf);
  addVignetting(r, sighted);
  fitLobesOf(r, groups, progress);
  addSecondLobes(r, sighted, groups);
}

std::map<FitKey, CutUse> useOfCut(const Inspection& r, CutUse few) {
  std::map<FitKey, int> whole;
  for (const int f : r.train.frames)
    for (const Highlight& h : r.evidence[static_cast<std::size_t>(f)].highlights)
      whole[r.keyFor(f, h.light)] += trains(r, f) && !h.touchesBorder;
  std::map<FitKey, CutUse> use;
  for (const auto& [key, count] : whole) use[key] = count < kEnoughWhole ? few : CutUse::None;
  return use;
}

KnownPixels knownPixelsOf(const Inspection& r, const FitKey& key) {
  KnownPixels known;
  const auto fit = r.pixelFits.find(key);
  if (fit != r.pixelFits.end() && fit->second && takesAnyLobe(r.request.settings)) known.fit = *fit->second;
  if (const auto failed = r.unexplained.find(key); failed != r.unexplained.end()) known.unexplained = failed->second;
  return known;
}

std::optional<FrameEvidence> contouredAgain(const Inspection& lobes, const Scene& scene, const EvidenceInputs& in, int f,
                                            const FrameEvidence& detected, const std::shared_ptr<const Surface>& surface) {
  if (!wasDetected(detected) || !surface) return std::nullopt;
  const Frame& frame = scene.frames[static_cast<std::size_t>(f)];
  const Outcome<LinearPixels> pixels = pixelsOf(frame, in.source, in.detect, {}, detected.diffuse.get());
  if (!pixels) return std::nullopt;
  std::map<std::string, std::vector<std::size_t>> byLight;
  for (std::size_t h = 0; h < detected.highlights.size(); ++h) byLight[detected.highlights[h].light].push_back(h);
  std::map<std::string, std::vector<LampLight>> others;
  if (byLight.size() > 1) others = otherLampsIn(lobes, *pixels, detected, frame.camera, *surface);
  std::optional<FrameEvidence> again;
  for (const auto& [light, indices] : byLight) {
    const auto fit = lobes.pixelFits.find(lobes.keyFor(f, light));
    if (light.empty() || fit == lobes.pixelFits.end() || !fit->second) continue;
    const PixelFit& lobe = **fit->second;
    std::vector<Highlight> found;
    for (const std::size_t h : indices) found.push_back(detected.highlights[h]);
    Outcome<std::vector<Highlight>> traced = contourWithLobe(*pixels, frame.camera, *surface, f, found, ofOthers(detected, light),
                                                             lobeInScene(lobes, f, light, lobe.model), lobe.background,
                                                             detectOptionsFor(frame, in.source, in.detect), others[light]);
    if (!traced) continue;
    if (!again) again = detected;
    for (std::size_t k = 0; k < indices.size(); ++k) again->highlights[indices[k]] = std::move((*traced)[k]);
  }
  return again;
}

void contourAgain(Inspection& r, const SurfaceOfFrame& surfaceOf, const ProgressFn& progress) {
  if (r.inputs.evidence->detect.background != BackgroundUse::Lobe || r.pixelFits.empty()) return;
  r.detected.resize(r.evidence.size());
  std::vector<int> frames;
  for (int f = 0; f < static_cast<int>(r.evidence.size()); ++f)
    if (wasDetected(r.evidence[static_cast<std::size_t>(f)]) && r.detected[static_cast<std::size_t>(f)].frame < 0)
      frames.push_back(f);
  std::atomic<int> changed{0};
  parallelFor(
      static_cast<int>(frames.size()),
      [&](int n) {
        const int f = frames[static_cast<std::size_t>(n)];
        FrameEvidence& evidence = r.evidence[static_cast<std::size_t>(f)];
        r.detected[static_cast<std::size_t>(f)] = evidence;
        if (std::optional<FrameEvidence> again = contouredAgain(r, *r.scene, *r.inputs.evidence, f, evidence, surfaceOf(f))) {
          evidence = *std::move(again);
          ++changed;
        }
      },
      progress, "contour again");
  r.work.framesContouredAgain += changed;
}

void addDetectedLevels(const Inspection& r, const SurfaceOfFrame& surfaceOf, FrameEvidence& evidence) {
  constexpr double kSameLevel = 1e-6;  // levels are typed with a few digits
  if (r.request.settings.text("fit.evidence") != "levels" || !wasDetected(evidence)) return;
  const std::size_t f = static_cast<std::size_t>(evidence.frame);
  const bool withLobe = f < r.detected.size() && r.detected[f].frame >= 0;
  for (const double level : listedLevels(r.request.settings)) {
    if (!(level > 0 && level < 1) || std::abs(level - r.inputs.evidence->detect.level) < kSameLevel) continue;
    EvidenceInputs at = *r.inputs.evidence;
    at.detect = at.detect.at(level);
    std::optional<FrameEvidence> found;
    if (withLobe) found = contouredAgain(r, *r.scene, at, evidence.frame, r.detected[f], surfaceOf(evidence.frame));
    if (!found) found = evidenceFor(*r.scene, evidence.frame, at, evidence.diffuse);
    std::erase_if(found->highlights, [&](const Highlight& h) { return std::abs(h.level - level) > kSameLevel; });
    addOtherLevels(found->highlights, evidence.highlights);
  }
  for (std::size_t h = 0; h < evidence.highlights.size(); ++h)
    if (r.request.whatIf.highlights.count({evidence.frame, evidence.asFound(static_cast<int>(h))}))
      evidence.highlights[h].otherLevels.clear();
  for (Highlight& h : evidence.highlights)
    if (!h.byHand.empty()) h.otherLevels.clear();
}

namespace {
/// A cut highlight may be brightest on its own contour.
bool holdsPeak(const Highlight& h, const Pixel& peak) {
  constexpr double kBesidePx = 1;  // the contour over the lobe's background lies elsewhere by less
  return contains(h.contour, peak) || (h.touchesBorder && distance(h.contour, peak) < kBesidePx);
}
}  // namespace

void attachPixels(Inspection& r) {
  if (r.request.noisePx > 0) return;
  std::map<int, int> next;  // views come in the order of their frame's highlights
  for (TrainingView& v : r.views) {
    const FrameEvidence& evidence = r.evidence[static_cast<std::size_t>(v.frame)];
    const int index = evidence.asFound(next[v.frame]++);
    if (r.request.whatIf.highlights.count({v.frame, index}) || !v.highlight.byHand.empty()) continue;
    for (auto p = r.patches.lower_bound({v.frame, 0}); p != r.patches.end() && p->first.first == v.frame && !v.pixels; ++p)
      if (p->second->light == v.highlight.light && holdsPeak(v.highlight, p->second->peak)) v.pixels = p->second;
  }
}

namespace {

using Verdicts = std::map<int, std::vector<MotionVerdict>>;

bool waits(const std::vector<MotionVerdict>& verdicts) {
  return std::any_of(verdicts.begin(), verdicts.end(),
                     [](const MotionVerdict& v) { return v.kind == MotionVerdict::Kind::Waiting; });
}

/// Null if it cannot be read: its user reports that.
std::shared_ptr<const Surface> surfaceIfAny(const SurfaceOfFrame& surfaceOf, int frame) {
  try {
    return surfaceOf(frame);
  } catch (const InputError&) {
    return nullptr;
  }
}

}  // namespace

void rejectTextures(Inspection& r, std::vector<int> frames, const SurfaceOfFrame& surfaceOf,
                    const std::function<void(const std::vector<int>&)>& gather, const ProgressFn& progress) {
  if (motionUse(r.request.settings) != MotionUse::Reject || r.request.whatIf.synthesise) return;
  const std::vector<std::vector<int>> panels = motionPanels(*r.scene, *r.surfaces);
  std::erase_if(frames, [&](int f) { return panels[static_cast<std::size_t>(f)].empty(); });
  const PanelDepths depths(*r.scene, r.request.settings);
  Verdicts verdicts;
  while (!frames.empty()) {
    std::vector<std::vector<MotionVerdict>> judged(frames.size());
    parallelFor(
        static_cast<int>(frames.size()),
        [&](int n) {
          const int f = frames[static_cast<std::size_t>(n)];
          judged[static_cast<std::size_t>(n)] = judgedByMotion(
              *r.scene, f, panels[static_cast<std::size_t>(f)], r.evidence, [&] { return surfaceIfAny(surfaceOf, f); }, depths,
              r.request.settings);
        },
        progress, "motion");
    std::set<int> missing, again;
    for (std::size_t n = 0; n < frames.size(); ++n) {
      const int f = frames[n];
      if (waits(judged[n])) {
        again.insert(f);
        for (const int other : panels[static_cast<std::size_t>(f)])
          if (r.evidence[static_cast<std::size_t>(other)].frame < 0) missing.insert(other);
      }
      verdicts[f] = std::move(judged[n]);
    }
    if (!missing.empty()) gather({missing.begin(), missing.end()});
    again.insert(missing.begin(), missing.end());
    frames.assign(again.begin(), again.end());
  }
  // Textures go only now, because every frame was judged by the full evidence of the others.
  for (const auto& [f, said] : verdicts)
    if (!said.empty())
      withholdTextures(r.evidence[static_cast<std::size_t>(f)], said, r.scene->frames[static_cast<std::size_t>(f)].camera);
}

std::string textureRemark(const Inspection& r) {
  std::string names;
  std::size_t frames = 0, spots = 0;
  for (const int f : r.train.frames) {
    const std::size_t here = r.evidence[static_cast<std::size_t>(f)].textures.size();
    if (here == 0 || !r.isTraining(f)) continue;
    names += (frames++ == 0 ? "" : ", ") + r.scene->frames[static_cast<std::size_t>(f)].id;
    spots += here;
  }
  if (frames == 0) return "";
  return formatted(
             "%zu bright spot%s of %zu training frame%s %s on the surface while highlights move, and %s no evidence "
             "(texture, detect.motion): ",
             spots, spots == 1 ? "" : "s", frames, frames == 1 ? "" : "s", spots == 1 ? "stays" : "stay",
             spots == 1 ? "is" : "are") +
         names;
}

}  // namespace glint
