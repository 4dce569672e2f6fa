// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/depth_settings.h"

#include <algorithm>

namespace glint {

namespace {

std::vector<ParamSpec> depthParams() {
  return {
      {"surface.depth_smoothing",
       "Depth smoothing",
       "1/z",
       "",
       std::string("none"),
       0,
       0,
       0,
       {"none", "bilateral", "fit"},
       "How measured depth maps are smoothed. None: for depth without noise. Bilateral: mean of the inverse depths that are near "
       "in the image and alike. "
       "Fit: a quadratic in inverse depth through the neighbours, which gives the normal, too; for depth cameras. 1/z = Σ c_kl "
       "xᵏ yˡ, k + l <= 2.",
       "surface"},
      {"surface.depth_normals",
       "Depth normals",
       "N",
       "",
       std::string("plane"),
       0,
       0,
       0,
       {"plane", "integral"},
       "Normals of depth maps. Plane: fitted to the neighbours within the radius. Integral: from integral images over a square "
       "of that size, which is faster. "
       "Smoothing by fit has normals of its own. C N = λ N with the smallest λ, C = Σ (P - P̄)(P - P̄)ᵀ.",
       "surface"},
      {"surface.depth_radius",
       "Depth radius",
       "r",
       "m",
       0.0,
       0.0,
       10.0,
       0.005,
       {},
       "Radius of the neighbourhood that gives a point of a depth map its normal and its smoothed depth. 0: 1.5 % of the median "
       "depth, which is the 3 cm "
       "of the paper at 2 m. Neighbours: |P_i - P| < r.",
       "surface"},
      {"surface.depth_fill",
       "Largest filled hole",
       "A",
       "px^2",
       400,
       0,
       1000000,
       50,
       {},
       "Holes of a depth map up to this many pixels are filled, unless they touch the image border. A peak on filled depth is "
       "refused. 0: none. Filled: A_hole <= "
       "A.",
       "surface"},
      {"surface.depth_fuse",
       "Fused frames",
       "k",
       "",
       0,
       0,
       64,
       1,
       {},
       "Depth maps of this many other frames, the nearest ones, are averaged into the depth of a frame. Only for objects that "
       "stand still in the world: frames "
       "whose depth disagrees are left out. 0: each frame on its own. z = Σ w_j z_j / Σ w_j.",
       "surface"},
      {"surface.depth_noise",
       "Depth noise for trials",
       "η",
       "",
       0.0,
       0.0,
       100.0,
       0.5,
       {},
       "Adds noise to depth maps, to see what a depth camera would cost. 1: the noise of a first Kinect, error ~ z², rounded, "
       "with "
       "holes at edges. 0: none. "
       "z' = a / ⌊a/z + ε + 1/2⌋, a = 351.3 m / η, σ_ε = 1/6.",
       "surface"},
      {"surface.depth_seed",
       "Seed of the depth noise",
       "s",
       "",
       1,
       0,
       1000000,
       1,
       {},
       "Another number gives other depth noise. Frames have their own: z' = z'(seed, frame).",
       "surface"},
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
