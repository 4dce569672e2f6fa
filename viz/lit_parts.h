// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <map>
#include <set>
#include <string>

#include "viz/convert.h"
#include "viz/style.h"

class vtkActor;
class vtkProp;

namespace glint::viz {

/// Says what of its layer a thing shows: "normal". Gives the thing back.
vtkSmartPointer<vtkActor> named(vtkSmartPointer<vtkActor> thing, const std::string& part);
/// Says which layer a thing is of, once it is known. What has a part is "layer/part" from then on.
void nameLayer(vtkProp* thing, const std::string& layer);

/// Lights up what is drawn in a renderer, by the names that nameLayer() left: in another colour, with thick lines, until told
/// otherwise, including what is rebuilt meanwhile. Knows neither scene nor layers.
class LitParts {
 public:
  explicit LitParts(vtkRenderer* renderer);
  ~LitParts();
  LitParts(const LitParts&) = delete;
  LitParts& operator=(const LitParts&) = delete;
  /// Names are "layer" (all of it) or "layer/part"; none = nothing is lit.
  void light(const std::set<std::string>& names, const Colour& colour);
  /// A plane that touches something, seen from `apex`: a strip from there over the place of touch, and the line between. The
  /// normal is of unit length; `halfWidth` (m) is that of the strip at the place of touch.
  void lightPlane(const Eigen::Vector3d& apex, const Eigen::Vector3d& touch, const Eigen::Vector3d& normal, double halfWidth,
                  const Colour& colour);
  void clearPlane();
  int litCount() const { return static_cast<int>(lit_.size()); }
  bool planeShown() const { return sheet_ != nullptr; }
  /// What is drawn at a display pixel, "layer/part" or "layer"; the surface is left out, "" = nothing.
  std::string nameAt(int xDisplay, int yDisplay) const;

 private:
  struct Before {
    vtkSmartPointer<vtkActor> actor;
    vtkNew<vtkProperty> property;
    bool scalars = false;
  };
  void apply();
  void putBack();
  bool wanted(const std::string& name) const;

  vtkSmartPointer<vtkRenderer> renderer_;  ///< kept: the owner of the view may go first
  vtkNew<vtkCallbackCommand> onFrame_;
  std::set<std::string> names_;
  Colour colour_{};
  std::map<vtkProp*, Before> lit_;  ///< as it was
  vtkSmartPointer<vtkActor> sheet_, line_;
};

}  // namespace glint::viz
