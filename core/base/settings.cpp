// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/settings.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "core/base/bounded_json.h"
#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "core/base/words.h"

namespace glint {

namespace {
std::vector<ParamSpec>& params() {
  static const std::vector<ParamSpec> others = {
      {.key = "detect.level",
       .title = "Contour level",
       .symbol = "q",
       .defaultValue = 0.5,
       .min = kLeastLevel,
       .max = kMostLevel,
       .step = 0.01,
       .help =
           "Fraction of (strongest peak - background) at which contours are taken. It is the same in all frames, because a limit "
           "angle is meaningful for one level only. Contour: I - B = q (I_peak - B), B the background.",
       .stage = "detect"},
      {.key = "detect.min_area",
       .title = "Minimum area",
       .symbol = "A_min",
       .unit = "px^2",
       .defaultValue = 12.0,
       .min = 1.0,
       .max = 5000.0,
       .step = 1.0,
       .help = "Smaller blobs do not constrain the five parameters of an ellipse. Kept: area A >= A_min.",
       .stage = "detect"},
      {.key = "detect.min_contrast",
       .title = "Minimum contrast",
       .symbol = "c",
       .defaultValue = 3.0,
       .min = 1.0,
       .max = 50.0,
       .step = 0.5,
       .help =
           "Ratio of peak height to background spread; a blob below this is noise or a diffuse bump. Kept: (I_peak - B) / σ_B >= "
           "c.",
       .stage = "detect"},
      {.key = "detect.peak_window",
       .title = "Peak window",
       .symbol = "w",
       .defaultValue = 0.9,
       .min = 0.5,
       .max = 0.99,
       .step = 0.01,
       .help = "Pixels above this fraction of the peak are used in the quadratic fit to log I, whose maximum is the peak. log I "
               "= log "
               "K - (α/m)² where I >= w I_peak.",
       .stage = "detect"},
      {.key = "detect.clip",
       .title = "Saturation value",
       .symbol = "I_max",
       .defaultValue = 0.0,
       .max = 1e9,
       .step = 0.01,
       .help =
           "Linear values at or above this are saturated; 0 = the largest code of 8- and 16-bit images, none for float images. "
           "Saturated: I >= I_max.",
       .stage = "detect"},
      {.key = "detect.background",
       .title = "Background",
       .symbol = "B",
       .defaultValue = std::string("lobe"),
       .choices = {"smooth", "lobe", "colours"},
       .help =
           "Smooth: a quadratic fitted to the pixels around a highlight; it absorbs the tail of a long-tailed lobe, which makes "
           "contours too small. Lobe: the lobe is fitted to the pixels of the training frames, and contours are found again over "
           "the background that remains. Colours: in each frame whose colours tell diffuse light from the lamp's, contours are "
           "found "
           "on "
           "the specular part alone; the others keep the smooth one and say why. I = K S + B.",
       .stage = "detect"},
      {.key = "detect.motion",
       .title = "Bright texture",
       .symbol = "ΔP",
       .defaultValue = std::string("reject"),
       .choices = {"reject", "flag", "off"},
       .help =
           "A bright spot that stays on its point of the surface in other views, where a highlight would have moved, is texture. "
           "Reject: it is "
           "no evidence. Flag: detect says so, and it stays evidence. Off: nothing is looked at. Given highlights are never "
           "doubted. "
           "Texture: ΔP = 0 on the surface.",
       .stage = "detect"},
      {.key = "detect.texture",
       .title = "Texture underneath",
       .symbol = "D",
       .defaultValue = std::string("auto"),
       .choices = {"auto", "off"},
       .help = "Auto: where the surface shows print or grain, the diffuse light under a highlight is taken from the other views, "
               "which see the same points without it, and contours and pixels are those of what remains. Off: every background "
               "is smooth. S = I - D.",
       .stage = "detect"},
      {.key = "surface.normals",
       .title = "Mesh normals",
       .symbol = "N",
       .defaultValue = std::string("interpolated"),
       .choices = {"facet", "interpolated", "curved"},
       .help = "Facet: flat triangles. Interpolated: flat positions, vertex normals. Curved: a smooth patch through the vertex "
               "normals "
               "(Phong tessellation). They give α = angle(N, H), H = (L + V)/|L + V|.",
       .stage = "surface"},
      {.key = "surface.rays",
       .title = "Ray precision",
       .symbol = "P = e + t d",
       .defaultValue = std::string("double"),
       .choices = {"double", "single"},
       .help = "Double: single precision finds the mesh triangle that a ray hits, double precision the point. Single: the ray "
               "tracer's "
               "own result, accurate to about 1e-7 of the mesh size.",
       .stage = "surface"},
      {.key = "light.solver",
       .title = "Light",
       .symbol = "L",
       .defaultValue = std::string("bundle"),
       .choices = {"triangulated", "bundle"},
       .help = "Triangulated: closest point to the reflected rays. Bundle: all contour points share one limit angle; least "
               "squares in "
               "pixels. Triangulated: min Σ |(I - r rᵀ)(L - P)|², r = v - 2 (v·N) N. Bundle: min Σ ((α(P_ij; L) - α_lim) / "
               "|∂α/∂pixel|)².",
       .stage = "light"},
      {.key = "light.frame",
       .title = "Light stands still in",
       .symbol = "F",
       .defaultValue = std::string("auto"),
       .choices = {"auto", "world", "camera"},
       .help =
           "World: lamps stand still. Camera: they move with the camera, as a flash does, or the object turned before a camera "
           "that stood still. Auto: the one in which the mirrored rays of the training highlights meet. x_F = x, or R x + t of "
           "each camera.",
       .stage = "light"},
      {.key = "light.bundle_points",
       .title = "Bundle points",
       .symbol = "j",
       .defaultValue = 72,
       .min = 8,
       .max = 720,
       .step = 1,
       .help = "Contour points per view in the bundle, equally spaced in arc length. P_ij, j = 1 to this.",
       .stage = "light"},
      {.key = "light.robust_px",
       .title = "Robust scale",
       .symbol = "s",
       .unit = "px",
       .defaultValue = 1.0,
       .min = 0.01,
       .max = 100.0,
       .step = 0.1,
       .help = "Residuals beyond this scale count less (Huber loss). ρ(e) = e² up to |e| = s, 2 s |e| - s² beyond.",
       .stage = "light"},
      {.key = "light.limit_orders",
       .title = "Directed limit angle",
       .symbol = "α_lim(φ)",
       .defaultValue = -1,
       .min = -1,
       .max = 1,
       .step = 1,
       .help = "0: one limit angle. 1: also the extent of a long or wide light (bundle only), six more parameters. -1: whichever "
               "predicts left-out training views better. α_lim(φ)² = det M / (pᵀ M p), M = α_lim² I + A E Aᵀ, E the extent.",
       .stage = "light"},
      {.key = "light.refine_poses",
       .title = "Refine poses",
       .symbol = "ω, t",
       .defaultValue = false,
       .help =
           "Bundle: correct small pose errors of the training cameras together with the light, constrained by a prior; the views "
           "themselves keep their poses. L, ω, t = arg min Σ ρ(e_ij(L, ω_i, t_i)) + prior.",
       .stage = "light"},
      {.key = "light.pose_sigma",
       .title = "Pose error",
       .symbol = "σ",
       .unit = "px",
       .defaultValue = 0.3,
       .min = 0.001,
       .max = 100.0,
       .step = 0.1,
       .help = "Refined poses: standard deviation of their error, as the pixels by which a rotation about each axis and a shift "
               "along "
               "it move the image. Prior: |ω|² / σ_ω² + |t|² / σ_t², σ_ω = σ / f, σ_t = σ Z / f.",
       .stage = "light"},
      {.key = "light.refine_depth",
       .title = "Refine depth",
       .symbol = "δ",
       .defaultValue = false,
       .help =
           "Bundle: correct a smooth depth-map error, the same in all frames, together with the light, constrained by a prior; "
           "predictions use the corrected surfaces. L, δ = arg min Σ ρ(e_ij(L, δ)) + prior.",
       .stage = "light"},
      {.key = "light.depth_sigma",
       .title = "Depth error",
       .symbol = "σ_δ",
       .defaultValue = 0.005,
       .min = 1e-6,
       .max = 0.1,
       .step = 0.001,
       .help =
           "Refined depth: standard deviation of its error near the image border, as a fraction of the depth. z becomes z (1 + Σ "
           "c_kl xᵏ yˡ), δ = Σ c_kl xᵏ yˡ.",
       .stage = "light"},
      {.key = "light.refine_normals",
       .title = "Refine normals",
       .symbol = "h",
       .defaultValue = false,
       .help = "Bundle: correct smooth bumps of a mesh that all views see, together with the light, constrained by a prior. The "
               "correction is kept if it improves left-out views; predictions then use the corrected mesh. L, h = arg min Σ "
               "ρ(e_ij(L, "
               "h)) + prior, N' ~ N - ∇h.",
       .stage = "light"},
      {.key = "light.normal_sigma",
       .title = "Normal error",
       .symbol = "σ_N",
       .unit = "rad",
       .defaultValue = 0.01,
       .min = 1e-6,
       .max = 0.5,
       .step = 0.001,
       .help = "Refined normals: standard deviation of the slopes of the bumps, in every direction. h is a Gaussian process, "
               "sd(∂h) = "
               "σ_N; left-out views choose its length and whether a quarter of this value is enough.",
       .stage = "light"},
      {.key = "light.smooth_mesh",
       .title = "Smooth meshes",
       .symbol = "R",
       .defaultValue = std::string("auto"),
       .choices = {"auto", "off"},
       .help =
           "Auto: where highlights contradict a mesh, vertices and normals come from quadrics that are fitted to the vertices "
           "within R; the highlights choose R. They must fit clearly better than on the mesh as given. Off: meshes are used as "
           "given. z = a + b x + c y + d x² + e xy + f y², N ~ (-b, -c, 1).",
       .stage = "light"},
      {.key = "fit.solver",
       .title = "Ellipsoid solver",
       .symbol = "Q*",
       .defaultValue = std::string("refined"),
       .choices = {"linear", "anchored", "refined"},
       .help =
           "Linear: smallest singular vector of s C* = P Q* P^T. Anchored: centre fixed at the light. Refined: contour distances "
           "with the light's covariance as prior. Q* = [c cᵀ - S, c; cᵀ, 1].",
       .stage = "fit"},
      {.key = "fit.prior_bias",
       .title = "Centre bias",
       .symbol = "b",
       .defaultValue = 0.0,
       .max = 10.0,
       .step = 0.01,
       .help =
           "Refined solver: how far the ellipsoid's centre may lie from the light, in addition to the light's own noise, as a "
           "fraction of the light's distance (standard deviation); 0 = one hundredth. The weight of contour points against this "
           "prior comes from their residuals. Prior of c: covariance Σ_L + (b |L - P|)² I.",
       .stage = "fit"},
      {.key = "fit.evidence",
       .title = "Evidence",
       .symbol = "I, C_q",
       .defaultValue = std::string("auto"),
       .choices = {"auto", "contours", "levels", "pixels"},
       .help = "Data that the reflectance model is fitted to. Contours: one contour per highlight. Levels: contours at several "
               "levels. "
               "Pixels: all unclipped pixels around the highlights. Auto: pixels if there are images that a lobe explains, else "
               "contours. L, m = arg min Σ ρ(w (I - K S(L, m) - B)).",
       .stage = "fit"},
      {.key = "fit.levels",
       .title = "Levels",
       .symbol = "q_j",
       .defaultValue = std::string("0.3,0.5,0.7"),
       .choices = {"0.3,0.5,0.7", "0.2,0.5", "0.2,0.35,0.5,0.65,0.8"},
       .help = "Contour levels that are used together if the evidence is levels. C_q: I = q I_peak.",
       .stage = "fit"},
      {.key = "fit.lobe",
       .title = "Lobe",
       .symbol = "log I",
       .defaultValue = std::string("auto"),
       .choices = {"auto", "torrance-sparrow", "ggx", "blinn-phong", "phong"},
       .help = "Specular lobe of the reflectance model; auto: the lobe whose fit leaves the smallest residual. Torrance-Sparrow: "
               "log I "
               "= -tan²θ/m² - 4 log cos θ - log(1 + Λ(L) + Λ(V)) - log cos θ_V - 2 log r, θ = α.",
       .stage = "fit"},
      {.key = "fit.light_size",
       .title = "Light size",
       .symbol = "R",
       .defaultValue = std::string("auto"),
       .choices = {"point", "auto", "sphere", "segment"},
       .help =
           "Reflectance model: shapes that the light may have besides a point. sphere: its radius R is estimated if this lowers "
           "the squared residuals by a fifth. segment: its two ends are estimated if this does the same and predicts left-out "
           "frames better. auto: both. Point: R = 0.",
       .stage = "fit"},
      {.key = "fit.most_residual",
       .title = "Poor above",
       .symbol = "e_max",
       .defaultValue = 0.1,
       .min = 0.01,
       .max = 10.0,
       .step = 0.01,
       .help =
           "A model is poor if its residual exceeds this fraction of the contours' radius in more than a third of the training "
           "views or, for ellipsoids, overall. It answers all the same; above one half (or this fraction, if larger) it fails. "
           "Good: "
           "e <= e_max r, e the residual without noise, r = √(A/π).",
       .stage = "fit"},
      {.key = "fit.directions",
       .title = "Directions",
       .symbol = "n",
       .defaultValue = 36,
       .min = 6,
       .max = 720,
       .step = 1,
       .help = "Number of walks that map a training view's contour to its tangent plane (the paper: 36). v_i = (cos 2πi/n, sin "
               "2πi/n) "
               "on T.",
       .stage = "fit"},
      {.key = "fit.walk_tolerance",
       .title = "Walk tolerance",
       .symbol = "ε",
       .unit = "rad",
       .defaultValue = 1e-10,
       .min = 1e-15,
       .max = 1e-3,
       .step = 1e-10,
       .help = "A walk from a training view ends when alpha is this close to the limit angle. |α - α_lim| < ε.",
       .stage = "fit"},
      {.key = "predict.directions",
       .title = "Directions",
       .symbol = "n",
       .defaultValue = 36,
       .min = 6,
       .max = 720,
       .step = 1,
       .help = "Number of walks that predict a contour (the paper: 36). v_i = (cos 2πi/n, sin 2πi/n) on T.",
       .stage = "predict"},
      {.key = "predict.query",
       .title = "Surface queries",
       .symbol = "k1, k2",
       .defaultValue = std::string("exact"),
       .choices = {"exact", "local-quadric"},
       .help = "Exact: every foot point is found on the surface. Local quadric: walks use the patch k1 x^2 + k2 y^2 + c z^2 + 2 "
               "z = 0 "
               "at the brightest point; no ray is cast, and variation of the curvature over the highlight is ignored.",
       .stage = "predict"},
      {.key = "predict.contour",
       .title = "Level-set contour",
       .symbol = "{α = α_lim}",
       .defaultValue = std::string("level-set"),
       .choices = {"level-set", "star"},
       .help =
           "Limit angle and reflectance only. Level set: the exact region of any shape, also split and merged. Star: one walk "
           "per "
           "direction from every brightest point; falls back to the level set if this does not describe the region. Region: α(P) "
           "<= α_lim on S, or I(P) >= q I(P_peak).",
       .stage = "predict"},
      {.key = "predict.search",
       .title = "Brightest-point search",
       .symbol = "P_B",
       .defaultValue = std::string("grid"),
       .choices = {"grid", "hints"},
       .help =
           "Grid: a grid of rays finds every brightest point. Hints: one search from the most promising brightest point of the "
           "training views; the grid if that fails or if training frames show several highlights. P_B: N × H = 0.",
       .stage = "predict"},
      {.key = "predict.seed_step",
       .title = "Seed spacing",
       .symbol = "h",
       .unit = "px",
       .defaultValue = 32.0,
       .min = 2.0,
       .max = 128.0,
       .step = 1.0,
       .help =
           "Spacing of the ray grid that starts the search for brightest points; smooth meshes do not need it. Rays at pixels (i "
           "h, j h), i, j = 0, 1, ...",
       .stage = "predict"},
      {.key = "predict.level_set_step",
       .title = "Level-set grid",
       .symbol = "h",
       .unit = "px",
       .defaultValue = 4.0,
       .min = 0.5,
       .max = 32.0,
       .step = 0.5,
       .help = "Spacing of the scan that finds the components of a level set; vertices are then refined. Field sampled at pixels "
               "(i h, "
               "j h), i, j = 0, 1, ...",
       .stage = "predict"},
      {.key = "predict.walk_tolerance",
       .title = "Walk tolerance",
       .symbol = "ε",
       .unit = "rad",
       .defaultValue = 1e-10,
       .min = 1e-15,
       .max = 1e-3,
       .step = 1e-10,
       .help = "A walk of a prediction ends when alpha is this close to the limit angle. |α - α_lim| < ε.",
       .stage = "predict"},
      {.key = "predict.band",
       .title = "Uncertainty band",
       .symbol = "σ",
       .defaultValue = false,
       .help =
           "Compute the standard deviation of every predicted contour point: from noise and whole-view errors in the training "
           "views, from other lobes that explain these views about as well, and from the stated tolerances. Takes a few fits. σ² "
           "= "
           "J Σ Jᵀ + Σ τ² + Σ w d² across the contour.",
       .stage = "predict"},
      {.key = "input.scale_tolerance",
       .title = "Scale tolerance",
       .symbol = "t_s",
       .defaultValue = 0.0,
       .max = 0.5,
       .step = 0.001,
       .help =
           "Added to the band: the surface may be larger or smaller than given by up to this fraction about the world origin, "
           "which contours do not show. The fit is repeated at both limits. Uniform: σ² = d²/3.",
       .stage = "predict"},
      {.key = "input.focal_tolerance",
       .title = "Focal tolerance",
       .symbol = "t_f",
       .defaultValue = 0.0,
       .max = 0.5,
       .step = 0.001,
       .help = "The same for the focal length of all cameras, as a fraction: f (1 ± t_f). Uniform: σ² = d²/3.",
       .stage = "predict"},
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

std::string settingText(const SettingValue& value) {
  if (const auto* s = std::get_if<std::string>(&value)) return *s;
  if (const auto* b = std::get_if<bool>(&value)) return *b ? "on" : "off";
  if (const auto* i = std::get_if<int>(&value)) return std::to_string(*i);
  return formatted("%.6g", std::get<double>(value));
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
