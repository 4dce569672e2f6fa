// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/other_lamps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/reflectance/radiance_field.h"

namespace glint {
namespace {

constexpr double kShows = 3e-4;     // of a patch's top: as much at a contour moves it by 0.02 % of its diameter
constexpr int kStrengthRounds = 4;  // lamps in turn; a fixed number that was not tuned

/// e^(log I) of a lamp's lobe, by cell; no shadow rays.
std::vector<double> lobeOn(const PixelPatch& patch, const RadianceField& field, double logStrength) {
  std::vector<double> light(patch.size(), 0);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (!patch.onSurface[i]) continue;
    const std::optional<double> log =
        field.at(SurfacePoint{patch.seen[i].position, patch.seen[i].axes.normal}, std::numeric_limits<double>::infinity());
    if (log && std::isfinite(*log)) light[i] = std::exp(*log + logStrength);
  }
  return light;
}

RadianceField fieldOf(const LobeModel& model, const Surface& surface, const Camera& camera) {
  return {surface, camera, model.lobe, model.roughness, model.lamp};
}

void addTo(std::vector<double>& sum, const std::vector<double>& light, double factor) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * light[i];
}

bool shows(const PixelPatch& patch, const std::vector<double>& light) {
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (patch.used[i] && light[i] > kShows * patch.top) return true;
  return false;
}

/// The lamps of a frame with what each adds to the pixels of each other one.
class LampsTogether {
 public:
  LampsTogether(const std::vector<LampPatches>& lamps, const Surface& surface, const Camera& camera)
      : lamps_(lamps), logScale_(lamps.size(), 0), strength_(lamps.size(), 0), reach_(lamps.size()) {
    std::vector<RadianceField> fields;
    for (const LampPatches& lamp : lamps) fields.push_back(fieldOf(lamp.model, surface, camera));
    for (std::size_t k = 0; k < lamps.size(); ++k) solve(k, &fields[k]);
    for (std::size_t k = 0; k < lamps.size(); ++k) {
      reach_[k].resize(lamps.size());
      for (std::size_t o = 0; o < lamps.size(); ++o)
        for (const PixelPatch* p : lamps[k].patches)
          if (o != k && strength_[o] > 0) reach_[k][o].push_back(lobeOn(*p, fields[o], logScale_[o]));
    }
    for (int round = 0; round < kStrengthRounds && anyShows(); ++round)
      for (std::size_t k = 0; k < lamps.size(); ++k) solve(k, nullptr);
  }

  bool showsIn(std::size_t k) const {
    for (std::size_t p = 0; p < lamps_[k].patches.size(); ++p)
      if (shows(*lamps_[k].patches[p], others(k, p))) return true;
    return false;
  }
  std::vector<LampLight> othersOf(std::size_t k) const {
    std::vector<LampLight> result;
    for (std::size_t o = 0; o < lamps_.size(); ++o)
      if (o != k && strength_[o] > 0) result.push_back({lamps_[o].model, logScale_[o] + std::log(strength_[o])});
    return result;
  }

 private:
  bool anyShows() const {
    for (std::size_t k = 0; k < lamps_.size(); ++k)
      if (showsIn(k)) return true;
    return false;
  }
  std::vector<double> others(std::size_t k, std::size_t patch) const {
    std::vector<double> sum(lamps_[k].patches[patch]->size(), 0);
    for (std::size_t o = 0; o < reach_[k].size(); ++o)
      if (!reach_[k][o].empty()) addTo(sum, reach_[k][o][patch], strength_[o]);
    return sum;
  }
  /// The strength of a lamp in what the others leave. @param field  sets its scale
  void solve(std::size_t k, const RadianceField* field) {
    std::vector<PixelPatch> left;
    std::vector<const PixelPatch*> pointers;
    for (std::size_t p = 0; p < lamps_[k].patches.size(); ++p) left.push_back(withoutLight(*lamps_[k].patches[p], others(k, p)));
    for (const PixelPatch& p : left) pointers.push_back(&p);
    const Outcome<std::vector<PatchSolution>> solved = solvePatches(pointers, lamps_[k].model, lamps_[k].background);
    if (!solved) return;
    const PatchSolution& first = solved->front();
    if (field) {
      const std::optional<double> top = field->at(first.topPoint, std::numeric_limits<double>::infinity());
      if (!top) return;
      logScale_[k] = -*top;
    }
    strength_[k] = first.strength;
  }

  const std::vector<LampPatches>& lamps_;
  std::vector<double> logScale_, strength_;
  std::vector<std::vector<std::vector<std::vector<double>>>> reach_;  ///< of lamp o (second) at patch p (third) of lamp k (first)
};

}  // namespace

std::vector<std::vector<LampLight>> lightOfOthers(const std::vector<LampPatches>& lamps, const Surface& surface,
                                                  const Camera& camera) {
  std::vector<std::vector<LampLight>> others(lamps.size());
  if (lamps.size() < 2) return others;
  const LampsTogether together(lamps, surface, camera);
  for (std::size_t k = 0; k < lamps.size(); ++k)
    if (together.showsIn(k)) others[k] = together.othersOf(k);
  return others;
}

std::vector<double> lightOn(const PixelPatch& patch, const std::vector<LampLight>& lamps, const Surface& surface,
                            const Camera& camera) {
  std::vector<double> sum(patch.size(), 0);
  for (const LampLight& lamp : lamps) addTo(sum, lobeOn(patch, fieldOf(lamp.model, surface, camera), lamp.logStrength), 1);
  return sum;
}

PixelPatch withoutLight(PixelPatch patch, const std::vector<double>& light) {
  for (std::size_t i = 0; i < patch.size(); ++i) patch.value[i] = static_cast<float>(patch.value[i] - light[i]);
  double top = 0;
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (patch.used[i]) top = std::max<double>(top, patch.value[i]);
  if (top > 0) patch.top = top;
  return patch;
}

}  // namespace glint
