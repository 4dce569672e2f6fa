// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/highlight/diffuse.h"
#include "core/pipeline/detect_settings.h"
#include "core/scene/scene.h"

namespace glint {

/// A bright spot of a view, with the places that its lobe reaches.
struct LobeSpot {
  Pixel centre{0, 0};                                     ///< ideal
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Identity();  ///< d^T inverse d = 1 on the contour at half of the peak
  double peak = 0;                                        ///< above what lies under it, linear values

  double squaredRadius(const Pixel& ideal) const { return (ideal - centre).dot(inverse * (ideal - centre)); }
};
/// Those of a frame's highlights that have an ellipse.
std::vector<LobeSpot> lobeSpots(const std::vector<Highlight>& highlights);

/// One photograph of a surface.
struct TextureView {
  int frame = -1;
  Camera camera;
  Image value;     ///< one channel, linear; not finite where it may not be used (mask, clipped)
  Image distance;  ///< from the camera to the surface at every `stride`-th pixel, not finite off the surface
  int stride = 4;
  std::vector<LobeSpot> spots;
};
/// FrameUnreadable; the pixel fails as readMasked().
Outcome<TextureView> textureView(const Scene& scene, int frame, FrameSource source, const DetectSettings& settings,
                                 const Surface& surface);

/// Views of one surface that tell what lies under the highlights of each other (method.md section 1, "Texture underneath").
/// Diffuse light is the same in all views of a surface point, as far as lamps rest beside the surface: D(X) = I_j(P_j X) in any
/// view j whose highlight is elsewhere. Where lobes have tails, I_j = D(X) + a G_j + b Q_j, with a Gaussian's tail G and GGX's
/// Q around the spots of view j; a and b are shared by all points and views, and D is eliminated.
class TexturePanel {
 public:
  /// What a view shows of a surface point.
  struct Sample {
    std::size_t view = 0;              ///< by index into views()
    Pixel at{0, 0};                    ///< measured
    double value = 0, radius2 = 0;     ///< of the nearest spot
    std::array<double, 2> tail{0, 0};  ///< Gaussian, GGX; in values
    SurfacePoint point{};              ///< of sightings() alone
  };

  TexturePanel(std::vector<TextureView> views, std::shared_ptr<const Surface> surface);

  /// What lies under a view's highlights: at every pixel on the surface, from the views of the panel without the view itself. Not
  /// finite where no other view sees the point.
  Image under(const TextureView& view) const;
  /// The same without regard to spots: the median of the other views.
  Image underByMedian(const TextureView& view) const;

  std::vector<TextureView>& views() { return views_; }
  const std::vector<TextureView>& views() const { return views_; }
  /// Fits the tails to the surroundings of all spots, once these are known.
  void fitTails();
  /// About so many surface points of each view, as all views show them that see them beside their spots.
  std::vector<std::vector<Sample>> sightings(int points) const;

 private:
  /// What the other views show of a surface point, each in the exposure of `gains`.
  void look(const SurfacePoint& at, int except, const std::vector<double>& gains, std::vector<Sample>& samples) const;
  /// Factor that brings each view of the panel to the exposure of this one: the median ratio over the surface.
  std::vector<double> gainsFor(const TextureView& view) const;
  /// What views show of points near spots, from two to six radii off.
  std::vector<std::vector<Sample>> pointsInTails() const;
  double withoutTails(const Sample& sample) const;
  template <class Take>
  void overSurface(const TextureView& view, int step, const Take& take) const;

  std::vector<TextureView> views_;
  std::shared_ptr<const Surface> surface_;
  std::array<double, 2> tails_{0, 0};  ///< a, b
};

}  // namespace glint
