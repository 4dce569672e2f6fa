// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "core/base/added_choice.h"
#include "core/base/depth_settings.h"
#include "core/base/filter_settings.h"
#include "core/base/level_range.h"
#include "core/base/outcome.h"
#include "core/base/plugin_hint.h"
#include "core/base/similar_name.h"

namespace glint {

namespace {
std::vector<ParamSpec>& params() {
  static const std::vector<ParamSpec> others = {
      {"detect.level",
       "Contour level",
       "q",
       "",
       0.5,
       kLeastLevel,
       kMostLevel,
       0.01,
       {},
       "Fraction of (strongest peak - background) at which contours are taken. It is the same in all frames, because a limit "
       "angle is meaningful for one level only. Contour: I - B = q (I_peak - B), B the background.",
       "detect"},
      {"detect.min_area",
       "Minimum area",
       "A_min",
       "px^2",
       12.0,
       1.0,
       5000.0,
       1.0,
       {},
       "Smaller blobs do not constrain the five parameters of an ellipse. Kept: area A >= A_min.",
       "detect"},
      {"detect.min_contrast",
       "Minimum contrast",
       "c",
       "",
       3.0,
       1.0,
       50.0,
       0.5,
       {},
       "Ratio of peak height to background spread; a blob below this is noise or a diffuse bump. Kept: (I_peak - B) / σ_B >= "
       "c.",
       "detect"},
      {"detect.peak_window",
       "Peak window",
       "w",
       "",
       0.9,
       0.5,
       0.99,
       0.01,
       {},
       "Pixels above this fraction of the peak are used in the quadratic fit to log I, whose maximum is the peak. log I = log "
       "K - (α/m)² where I >= w I_peak.",
       "detect"},
      {"detect.clip",
       "Saturation value",
       "I_max",
       "",
       0.0,
       0.0,
       1e9,
       0.01,
       {},
       "Linear values at or above this are saturated; 0 = the largest code of 8- and 16-bit images, none for float images. "
       "Saturated: I >= I_max.",
       "detect"},
      {"detect.background",
       "Background",
       "B",
       "",
       std::string("lobe"),
       0,
       0,
       0,
       {"smooth", "lobe", "colours"},
       "Smooth: a quadratic fitted to the pixels around a highlight; it absorbs the tail of a long-tailed lobe, which makes "
       "contours too small. Lobe: the lobe is fitted to the pixels of the training frames, and contours are found again over "
       "the background that remains. Colours: in each frame whose colours tell diffuse light from the lamp's, contours are found "
       "on "
       "the specular part alone; the others keep the smooth one and say why. I = K S + B.",
       "detect"},
      {"detect.motion",
       "Bright texture",
       "ΔP",
       "",
       std::string("reject"),
       0,
       0,
       0,
       {"reject", "flag", "off"},
       "A bright spot that stays on its point of the surface in other views, where a highlight would have moved, is texture. "
       "Reject: it is "
       "no evidence. Flag: detect says so, and it stays evidence. Off: nothing is looked at. Given highlights are never doubted. "
       "Texture: ΔP = 0 on the surface.",
       "detect"},
      {"surface.normals",
       "Mesh normals",
       "N",
       "",
       std::string("interpolated"),
       0,
       0,
       0,
       {"facet", "interpolated", "curved"},
       "Facet: flat triangles. Interpolated: flat positions, vertex normals. Curved: a smooth patch through the vertex normals "
       "(Phong tessellation). They give α = angle(N, H), H = (L + V)/|L + V|.",
       "surface"},
      {"surface.rays",
       "Ray precision",
       "P = e + t d",
       "",
       std::string("double"),
       0,
       0,
       0,
       {"double", "single"},
       "Double: single precision finds the mesh triangle that a ray hits, double precision the point. Single: the ray tracer's "
       "own result, accurate to about 1e-7 of the mesh size.",
       "surface"},
      {"light.solver",
       "Light",
       "L",
       "",
       std::string("bundle"),
       0,
       0,
       0,
       {"triangulated", "bundle"},
       "Triangulated: closest point to the reflected rays. Bundle: all contour points share one limit angle; least squares in "
       "pixels. Triangulated: min Σ |(I - r rᵀ)(L - P)|², r = v - 2 (v·N) N. Bundle: min Σ ((α(P_ij; L) - α_lim) / "
       "|∂α/∂pixel|)².",
       "light"},
      {"light.bundle_points",
       "Bundle points",
       "j",
       "",
       72,
       8,
       720,
       1,
       {},
       "Contour points per view in the bundle, equally spaced in arc length. P_ij, j = 1 to this.",
       "light"},
      {"light.robust_px",
       "Robust scale",
       "s",
       "px",
       1.0,
       0.01,
       100.0,
       0.1,
       {},
       "Residuals beyond this scale count less (Huber loss). ρ(e) = e² up to |e| = s, 2 s |e| - s² beyond.",
       "light"},
      {"light.limit_orders",
       "Directed limit angle",
       "α_lim(φ)",
       "",
       -1,
       -1,
       1,
       1,
       {},
       "0: one limit angle. 1: also the extent of a long or wide light (bundle only), six more parameters. -1: whichever "
       "predicts left-out training views better. α_lim(φ)² = det M / (pᵀ M p), M = α_lim² I + A E Aᵀ, E the extent.",
       "light"},
      {"light.refine_poses",
       "Refine poses",
       "ω, t",
       "",
       false,
       0,
       0,
       0,
       {},
       "Bundle: correct small pose errors of the training cameras together with the light, constrained by a prior; the views "
       "themselves keep their poses. L, ω, t = arg min Σ ρ(e_ij(L, ω_i, t_i)) + prior.",
       "light"},
      {"light.pose_sigma",
       "Pose error",
       "σ",
       "px",
       0.3,
       0.001,
       100.0,
       0.1,
       {},
       "Refined poses: standard deviation of their error, as the pixels by which a rotation about each axis and a shift along "
       "it move the image. Prior: |ω|² / σ_ω² + |t|² / σ_t², σ_ω = σ / f, σ_t = σ Z / f.",
       "light"},
      {"light.refine_depth",
       "Refine depth",
       "δ",
       "",
       false,
       0,
       0,
       0,
       {},
       "Bundle: correct a smooth depth-map error, the same in all frames, together with the light, constrained by a prior; "
       "predictions use the corrected surfaces. L, δ = arg min Σ ρ(e_ij(L, δ)) + prior.",
       "light"},
      {"light.depth_sigma",
       "Depth error",
       "σ_δ",
       "",
       0.005,
       1e-6,
       0.1,
       0.001,
       {},
       "Refined depth: standard deviation of its error near the image border, as a fraction of the depth. z becomes z (1 + Σ "
       "c_kl xᵏ yˡ), δ = Σ c_kl xᵏ yˡ.",
       "light"},
      {"light.refine_normals",
       "Refine normals",
       "h",
       "",
       false,
       0,
       0,
       0,
       {},
       "Bundle: correct smooth bumps of a mesh that all views see, together with the light, constrained by a prior. The "
       "correction is kept if it improves left-out views; predictions then use the corrected mesh. L, h = arg min Σ ρ(e_ij(L, "
       "h)) + prior, N' ~ N - ∇h.",
       "light"},
      {"light.normal_sigma",
       "Normal error",
       "σ_N",
       "rad",
       0.01,
       1e-6,
       0.5,
       0.001,
       {},
       "Refined normals: standard deviation of the slopes of the bumps, in every direction. h is a Gaussian process, sd(∂h) = "
       "σ_N; left-out views choose its length and whether a quarter of this value is enough.",
       "light"},
      {"fit.solver",
       "Ellipsoid solver",
       "Q*",
       "",
       std::string("refined"),
       0,
       0,
       0,
       {"linear", "anchored", "refined"},
       "Linear: smallest singular vector of s C* = P Q* P^T. Anchored: centre fixed at the light. Refined: contour distances "
       "with the light's covariance as prior. Q* = [c cᵀ - S, c; cᵀ, 1].",
       "fit"},
      {"fit.prior_bias",
       "Centre bias",
       "b",
       "",
       0.0,
       0.0,
       10.0,
       0.01,
       {},
       "Refined solver: how far the ellipsoid's centre may lie from the light, in addition to the light's own noise, as a "
       "fraction of the light's distance (standard deviation); 0 = one hundredth. The weight of contour points against this "
       "prior comes from their residuals. Prior of c: covariance Σ_L + (b |L - P|)² I.",
       "fit"},
      {"fit.evidence",
       "Evidence",
       "I, C_q",
       "",
       std::string("auto"),
       0,
       0,
       0,
       {"auto", "contours", "levels", "pixels"},
       "Data that the reflectance model is fitted to. Contours: one contour per highlight. Levels: contours at several levels. "
       "Pixels: all unclipped pixels around the highlights. Auto: pixels if there are images that a lobe explains, else "
       "contours. L, m = arg min Σ ρ(w (I - K S(L, m) - B)).",
       "fit"},
      {"fit.levels",
       "Levels",
       "q_j",
       "",
       std::string("0.3,0.5,0.7"),
       0,
       0,
       0,
       {"0.3,0.5,0.7", "0.2,0.5", "0.2,0.35,0.5,0.65,0.8"},
       "Contour levels that are used together if the evidence is levels. C_q: I = q I_peak.",
       "fit"},
      {"fit.lobe",
       "Lobe",
       "log I",
       "",
       std::string("auto"),
       0,
       0,
       0,
       {"auto", "torrance-sparrow", "ggx", "blinn-phong", "phong"},
       "Specular lobe of the reflectance model; auto: the lobe whose fit leaves the smallest residual. Torrance-Sparrow: log I "
       "= -tan²θ/m² - 4 log cos θ - log(1 + Λ(L) + Λ(V)) - log cos θ_V - 2 log r, θ = α.",
       "fit"},
      {"fit.light_size",
       "Light size",
       "R",
       "",
       std::string("auto"),
       0,
       0,
       0,
       {"point", "auto", "sphere", "segment"},
       "Reflectance model: shapes that the light may have besides a point. sphere: its radius R is estimated if this lowers "
       "the squared residuals by a fifth. segment: its two ends are estimated if this does the same and predicts left-out "
       "frames better. auto: both. Point: R = 0.",
       "fit"},
      {"fit.most_residual",
       "Poor above",
       "e_max",
       "",
       0.1,
       0.01,
       10.0,
       0.01,
       {},
       "A model is poor if its residual exceeds this fraction of the contours' radius in more than a third of the training "
       "views or, for ellipsoids, overall. It answers all the same; above one half (or this fraction, if larger) it fails. Good: "
       "e <= e_max r, e the residual without noise, r = √(A/π).",
       "fit"},
      {"fit.directions",
       "Directions",
       "n",
       "",
       36,
       6,
       720,
       1,
       {},
       "Number of walks that map a training view's contour to its tangent plane (the paper: 36). v_i = (cos 2πi/n, sin 2πi/n) "
       "on T.",
       "fit"},
      {"fit.walk_tolerance",
       "Walk tolerance",
       "ε",
       "rad",
       1e-10,
       1e-15,
       1e-3,
       1e-10,
       {},
       "A walk from a training view ends when alpha is this close to the limit angle. |α - α_lim| < ε.",
       "fit"},
      {"predict.directions",
       "Directions",
       "n",
       "",
       36,
       6,
       720,
       1,
       {},
       "Number of walks that predict a contour (the paper: 36). v_i = (cos 2πi/n, sin 2πi/n) on T.",
       "predict"},
      {"predict.query",
       "Surface queries",
       "k1, k2",
       "",
       std::string("exact"),
       0,
       0,
       0,
       {"exact", "local-quadric"},
       "Exact: every foot point is found on the surface. Local quadric: walks use the patch k1 x^2 + k2 y^2 + c z^2 + 2 z = 0 "
       "at the brightest point; no ray is cast, and variation of the curvature over the highlight is ignored.",
       "predict"},
      {"predict.contour",
       "Level-set contour",
       "{α = α_lim}",
       "",
       std::string("level-set"),
       0,
       0,
       0,
       {"level-set", "star"},
       "Limit angle and reflectance only. Level set: the exact region of any shape, also split and merged. Star: one walk per "
       "direction from every brightest point; falls back to the level set if this does not describe the region. Region: α(P) "
       "<= α_lim on S, or I(P) >= q I(P_peak).",
       "predict"},
      {"predict.search",
       "Brightest-point search",
       "P_B",
       "",
       std::string("grid"),
       0,
       0,
       0,
       {"grid", "hints"},
       "Grid: a grid of rays finds every brightest point. Hints: one search from the most promising brightest point of the "
       "training views; the grid if that fails or if training frames show several highlights. P_B: N × H = 0.",
       "predict"},
      {"predict.seed_step",
       "Seed spacing",
       "h",
       "px",
       32.0,
       2.0,
       128.0,
       1.0,
       {},
       "Spacing of the ray grid that starts the search for brightest points; smooth meshes do not need it. Rays at pixels (i "
       "h, j h), i, j = 0, 1, ...",
       "predict"},
      {"predict.level_set_step",
       "Level-set grid",
       "h",
       "px",
       4.0,
       0.5,
       32.0,
       0.5,
       {},
       "Spacing of the scan that finds the components of a level set; vertices are then refined. Field sampled at pixels (i h, "
       "j h), i, j = 0, 1, ...",
       "predict"},
      {"predict.walk_tolerance",
       "Walk tolerance",
       "ε",
       "rad",
       1e-10,
       1e-15,
       1e-3,
       1e-10,
       {},
       "A walk of a prediction ends when alpha is this close to the limit angle. |α - α_lim| < ε.",
       "predict"},
      {"predict.band",
       "Uncertainty band",
       "σ",
       "",
       false,
       0,
       0,
       0,
       {},
       "Compute the standard deviation of every predicted contour point: from noise and whole-view errors in the training "
       "views, from other lobes that explain these views about as well, and from the stated tolerances. Takes a few fits. σ² = "
       "J Σ Jᵀ + Σ τ² + Σ w d² across the contour.",
       "predict"},
      {"input.scale_tolerance",
       "Scale tolerance",
       "t_s",
       "",
       0.0,
       0.0,
       0.5,
       0.001,
       {},
       "Added to the band: the surface may be larger or smaller than given by up to this fraction about the world origin, "
       "which contours do not show. The fit is repeated at both limits. Uniform: σ² = d²/3.",
       "predict"},
      {"input.focal_tolerance",
       "Focal tolerance",
       "t_f",
       "",
       0.0,
       0.0,
       0.5,
       0.001,
       {},
       "The same for the focal length of all cameras, as a fraction: f (1 ± t_f). Uniform: σ² = d²/3.",
       "predict"},
  };
  static std::vector<ParamSpec> all = withFilterParams(withDepthParams(others));
  return all;
}
}  // namespace

const std::vector<ParamSpec>& allParams() { return params(); }

void addChoice(const std::string& key, const std::string& choice) {
  const auto spec = std::find_if(params().begin(), params().end(), [&](const ParamSpec& p) { return p.key == key; });
  require(spec != params().end() && !spec->choices.empty(), "addChoice: '" + key + "' is no setting with a list of values");
  spec->choices.push_back(choice);
}

const ParamSpec& paramSpec(const std::string& key) {
  for (const ParamSpec& p : allParams())
    if (p.key == key) return p;
  std::vector<std::string> known;
  for (const ParamSpec& p : allParams()) known.push_back(p.key);
  throw InputError("", "--set " + key, "unknown setting" + didYouMean(key, known) + " (`glint settings` lists them)");
}

const SettingValue& Settings::value(const std::string& key) const {
  if (const auto it = values_.find(key); it != values_.end()) return it->second;
  for (const ParamSpec& p : allParams())
    if (p.key == key) return p.defaultValue;
  throw std::invalid_argument("Settings: no setting '" + key + "'");
}

namespace {

constexpr const char* kLobeSetting = "fit.lobe";  // plugins add to its values
template <class T>
const T& typed(const SettingValue& v, const std::string& key) {
  const T* t = std::get_if<T>(&v);
  require(t != nullptr, "Settings: '" + key + "' has another type");
  return *t;
}
std::string number(double v) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, v).ptr;
  return {buffer, end};
}
}  // namespace

bool Settings::flag(const std::string& key) const { return typed<bool>(value(key), key); }
int Settings::integer(const std::string& key) const { return typed<int>(value(key), key); }
double Settings::number(const std::string& key) const {
  const SettingValue& v = value(key);
  if (const int* i = std::get_if<int>(&v)) return *i;
  return typed<double>(v, key);
}
const std::string& Settings::text(const std::string& key) const { return typed<std::string>(value(key), key); }

void Settings::set(const std::string& key, const SettingValue& v) {
  const ParamSpec& spec = paramSpec(key);
  SettingValue checked = v;
  if (std::holds_alternative<double>(spec.defaultValue) && std::holds_alternative<int>(v)) checked = double(std::get<int>(v));
  if (checked.index() != spec.defaultValue.index()) throw InputError("", "--set " + key, "the value has the wrong type");
  const auto inRange = [&](double x) {
    if (!(x >= spec.min && x <= spec.max))
      throw InputError("", "--set " + key,
                       glint::number(x) + " is outside " + glint::number(spec.min) + " .. " + glint::number(spec.max));
  };
  if (const int* i = std::get_if<int>(&checked)) inRange(*i);
  if (const double* d = std::get_if<double>(&checked)) inRange(*d);
  if (const std::string* s = std::get_if<std::string>(&checked); s && !spec.choices.empty()) {
    if (std::find(spec.choices.begin(), spec.choices.end(), *s) == spec.choices.end()) {
      std::string all;
      for (const std::string& c : spec.choices) all += (all.empty() ? "" : ", ") + c;
      const std::string hint = key == kLobeSetting ? kPluginHint : "";
      throw InputError("", "--set " + key, "'" + *s + "' is not one of: " + all + hint);
    }
  }
  if (checked == spec.defaultValue)
    values_.erase(key);
  else
    values_[key] = checked;
}

void Settings::setFromText(const std::string& key, const std::string& text) {
  const ParamSpec& spec = paramSpec(key);
  const auto bad = [&](const char* what) -> InputError {
    return InputError("", "--set " + key, "'" + text + "' is not " + what);
  };
  if (std::holds_alternative<bool>(spec.defaultValue)) {
    if (text == "true" || text == "on" || text == "1") return set(key, true);
    if (text == "false" || text == "off" || text == "0") return set(key, false);
    throw bad("true or false");
  }
  if (std::holds_alternative<int>(spec.defaultValue)) {
    int i = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), i);
    if (error != std::errc() || end != text.data() + text.size()) throw bad("a whole number");
    return set(key, i);
  }
  if (std::holds_alternative<double>(spec.defaultValue)) {
    double d = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), d);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(d)) throw bad("a number");
    return set(key, d);
  }
  set(key, text);
}

}  // namespace glint
