// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/settings.h"

namespace glint {

namespace {

std::vector<ParamSpec> depthParams() {
  return {
      {.key = "surface.depth_smoothing",
       .title = "Depth smoothing",
       .symbol = "1/z",
       .defaultValue = std::string("none"),
       .choices = {"none", "bilateral", "fit"},
       .help = "How measured depth maps are smoothed. None: for depth without noise. Bilateral: mean of the inverse depths that "
               "are near "
               "in the image and alike. "
               "Fit: a quadratic in inverse depth through the neighbours, which gives the normal, too; for depth cameras. 1/z = "
               "Σ c_kl "
               "xᵏ yˡ, k + l <= 2.",
       .stage = "surface"},
      {.key = "surface.depth_normals",
       .title = "Depth normals",
       .symbol = "N",
       .defaultValue = std::string("plane"),
       .choices = {"plane", "integral"},
       .help = "Normals of depth maps. Plane: fitted to the neighbours within the radius. Integral: from integral images over a "
               "square "
               "of that size, which is faster. "
               "Smoothing by fit has normals of its own. C N = λ N with the smallest λ, C = Σ (P - P̄)(P - P̄)ᵀ.",
       .stage = "surface"},
      {.key = "surface.depth_radius",
       .title = "Depth radius",
       .symbol = "r",
       .unit = "m",
       .defaultValue = 0.0,
       .max = 10.0,
       .step = 0.005,
       .help = "Radius of the neighbourhood that gives a point of a depth map its normal and its smoothed depth. 0: 1.5 % of the "
               "median "
               "depth, which is the 3 cm "
               "of the paper at 2 m. Neighbours: |P_i - P| < r.",
       .stage = "surface"},
      {.key = "surface.depth_fill",
       .title = "Largest filled hole",
       .symbol = "A",
       .unit = "px^2",
       .defaultValue = 400,
       .max = 1000000,
       .step = 50,
       .help = "Holes of a depth map up to this many pixels are filled, unless they touch the image border. A peak on filled "
               "depth is "
               "refused. 0: none. Filled: A_hole <= "
               "A.",
       .stage = "surface"},
      {.key = "surface.depth_fuse",
       .title = "Fused frames",
       .symbol = "k",
       .defaultValue = 0,
       .max = 64,
       .step = 1,
       .help = "Depth maps of this many other frames, the nearest ones, are averaged into the depth of a frame. Only for objects "
               "that "
               "stand still in the world: frames "
               "whose depth disagrees are left out. 0: each frame on its own. z = Σ w_j z_j / Σ w_j.",
       .stage = "surface"},
      {.key = "surface.depth_noise",
       .title = "Depth noise for trials",
       .symbol = "η",
       .defaultValue = 0.0,
       .max = 100.0,
       .step = 0.5,
       .help = "Adds noise to depth maps, to see what a depth camera would cost. 1: the noise of a first Kinect, error ~ z², "
               "rounded, "
               "with "
               "holes at edges. 0: none. "
               "z' = a / ⌊a/z + ε + 1/2⌋, a = 351.3 m / η, σ_ε = 1/6.",
       .stage = "surface"},
      {.key = "surface.depth_seed",
       .title = "Seed of the depth noise",
       .symbol = "s",
       .defaultValue = 1,
       .max = 1000000,
       .step = 1,
       .help = "Another number gives other depth noise. Frames have their own: z' = z'(seed, frame).",
       .stage = "surface"},
  };
}

}  // namespace

std::vector<ParamSpec> withDepthParams(std::vector<ParamSpec> others) {
  const auto light = std::find_if(others.begin(), others.end(), [](const ParamSpec& p) { return p.stage == "light"; });
  const std::vector<ParamSpec> depth = depthParams();
  others.insert(light, depth.begin(), depth.end());
  return others;
}

}  // namespace glint
