// SPDX-License-Identifier: BSD-3-Clause
#include "viz/lit_parts.h"

#include <vtkActor.h>
#include <vtkCellPicker.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkMapper.h>
#include <vtkPropCollection.h>

#include <algorithm>

#include "viz/glyphs.h"

namespace glint::viz {

namespace {
constexpr float kThicker = 2.2F, kThinnest = 3.0F;  // of lines, px: seen beside a line of the same kind that is not lit
constexpr double kLeastOpacity = 0.45;              // a sheet that is hardly there is seen then, and what lies behind it as well
constexpr double kBeyond = 1.35;                    // a touching plane goes on behind the place of touch
constexpr double kPlaneOpacity = 0.35;              // what it touches shines through
constexpr double kPickTolerance = 0.006;            // of the picture's diagonal: arrows are thin

vtkInformationStringKey* partKey() {
  static vtkInformationStringKey* const key = vtkInformationStringKey::MakeKey("PART", "glint");
  return key;
}

std::string nameOf(vtkProp* prop) {
  vtkInformation* const keys = prop->GetPropertyKeys();
  const char* const name = keys ? keys->Get(partKey()) : nullptr;
  return name ? name : "";
}

void setName(vtkProp* prop, const std::string& name) {
  vtkNew<vtkInformation> keys;
  if (prop->GetPropertyKeys()) keys->Copy(prop->GetPropertyKeys());
  keys->Set(partKey(), name.c_str());
  prop->SetPropertyKeys(keys);
}

std::string layerOf(const std::string& name) { return name.substr(0, name.find('/')); }

/// Calls with every actor of the picture.
template <typename Run>
void forActors(vtkRenderer* renderer, const Run& run) {
  vtkPropCollection* const props = renderer->GetViewProps();
  vtkCollectionSimpleIterator it = nullptr;
  props->InitTraversal(it);
  while (vtkProp* const prop = props->GetNextProp(it))
    if (vtkActor* const actor = vtkActor::SafeDownCast(prop)) run(actor);
}
}  // namespace

vtkSmartPointer<vtkActor> named(vtkSmartPointer<vtkActor> thing, const std::string& part) {
  setName(thing, "/" + part);
  return thing;
}

void nameLayer(vtkProp* thing, const std::string& layer) {
  const std::string name = nameOf(thing);
  setName(thing, layer + (name.empty() || name.front() != '/' ? "" : name));
}

LitParts::LitParts(vtkRenderer* renderer) : renderer_(renderer) {
  onFrame_->SetClientData(this);
  onFrame_->SetCallback([](vtkObject*, unsigned long, void* self, void*) { static_cast<LitParts*>(self)->apply(); });
  renderer_->AddObserver(vtkCommand::StartEvent, onFrame_, -1);  // after what rebuilds stale parts
}

LitParts::~LitParts() {
  renderer_->RemoveObserver(onFrame_);
  clearPlane();
  putBack();
}

bool LitParts::wanted(const std::string& name) const {
  return !name.empty() && (names_.count(name) > 0 || names_.count(layerOf(name)) > 0);
}

void LitParts::light(const std::set<std::string>& names, const Colour& colour) {
  if (names == names_ && colour == colour_) return;
  putBack();
  names_ = names;
  colour_ = colour;
}

void LitParts::apply() {
  if (names_.empty()) return;
  forActors(renderer_, [this](vtkActor* actor) {
    if (lit_.count(actor) > 0 || !wanted(nameOf(actor))) return;
    Before& before = lit_[actor];
    before.actor = actor;
    before.property->DeepCopy(actor->GetProperty());
    if (vtkMapper* const mapper = actor->GetMapper()) {
      before.scalars = mapper->GetScalarVisibility() != 0;
      mapper->ScalarVisibilityOff();
    }
    vtkProperty* const now = actor->GetProperty();
    now->SetColor(colour_[0], colour_[1], colour_[2]);
    now->SetLineWidth(std::max(kThicker * now->GetLineWidth(), kThinnest));
    now->SetOpacity(std::max(now->GetOpacity(), kLeastOpacity));
  });
}

void LitParts::putBack() {
  for (auto& [prop, before] : lit_) {
    before.actor->GetProperty()->DeepCopy(before.property);
    if (vtkMapper* const mapper = before.actor->GetMapper()) mapper->SetScalarVisibility(before.scalars);
  }
  lit_.clear();
}

void LitParts::clearPlane() {
  for (vtkSmartPointer<vtkActor>* actor : {&sheet_, &line_}) {
    if (*actor) renderer_->RemoveViewProp(*actor);
    *actor = nullptr;
  }
}

void LitParts::lightPlane(const Eigen::Vector3d& apex, const Eigen::Vector3d& touch, const Eigen::Vector3d& normal,
                          double halfWidth, const Colour& colour) {
  clearPlane();
  const Eigen::Vector3d along = kBeyond * (touch - apex);
  const Eigen::Vector3d across = normal.cross(touch - apex);
  if (!(across.norm() > 0) || !(halfWidth > 0)) return;
  const Eigen::Vector3d side = kBeyond * halfWidth / across.norm() * across;
  TriangleMesh strip;
  strip.vertices = {apex, apex + along - side, apex + along + side};
  strip.triangles = {{0, 1, 2}};
  sheet_ = sheetActor(strip, colour, kPlaneOpacity);
  line_ = segmentActor({{apex, touch}}, colour, kThinnest);
  for (const auto& actor : {sheet_, line_}) {
    actor->PickableOff();
    renderer_->AddViewProp(actor);
  }
}

std::string LitParts::nameAt(int xDisplay, int yDisplay) const {
  vtkNew<vtkCellPicker> picker;
  picker->SetTolerance(kPickTolerance);
  picker->PickFromListOn();
  bool any = false;
  forActors(renderer_, [&](vtkActor* actor) {
    const std::string name = nameOf(actor);
    if (name.empty() || layerOf(name) == "surface" || !actor->GetVisibility()) return;
    picker->AddPickList(actor);
    any = true;
  });
  if (!any || !picker->Pick(xDisplay, yDisplay, 0, renderer_) || !picker->GetActor()) return {};
  return nameOf(picker->GetActor());
}

}  // namespace glint::viz
