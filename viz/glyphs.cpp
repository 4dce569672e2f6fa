// SPDX-License-Identifier: BSD-3-Clause
#include "viz/glyphs.h"

#include <vtkAppendPolyData.h>
#include <vtkConeSource.h>
#include <vtkCylinderSource.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRegularPolygonSource.h>
#include <vtkSphereSource.h>
#include <vtkTransform.h>
#include <vtkTransformPolyDataFilter.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/draw/on_surface.h"

namespace glint::viz {
namespace {

vtkSmartPointer<vtkActor> actorOf(vtkPolyData* data, const Colour& colour) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  return actor;
}

vtkSmartPointer<vtkActor> unlitLines(vtkPolyData* data, const Colour& colour, double widthPx) {
  vtkSmartPointer<vtkActor> actor = actorOf(data, colour);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(static_cast<float>(widthPx));
  return actor;
}

/// Appends `data` moved by an affine transformation.
void append(vtkAppendPolyData* all, vtkPolyData* data, const Eigen::Affine3d& worldFromData) {
  vtkNew<vtkTransform> transform;
  transform->SetMatrix(toVtk(worldFromData.matrix()));
  vtkNew<vtkTransformPolyDataFilter> filter;
  filter->SetTransform(transform);
  filter->SetInputData(data);
  filter->Update();
  all->AddInputData(filter->GetOutput());
}

void soften(vtkActor* actor) {
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.7);
  actor->GetProperty()->SetSpecular(0.0);
}

}  // namespace

vtkSmartPointer<vtkActor> lineActor(const std::vector<Points>& chains, const Colour& colour, double widthPx) {
  return unlitLines(toPolyData(chains), colour, widthPx);
}

vtkSmartPointer<vtkActor> segmentActor(const std::vector<Segment>& segments, const Colour& colour, double widthPx) {
  return unlitLines(toPolyData(segments), colour, widthPx);
}

vtkSmartPointer<vtkActor> sphereActor(const Points& centres, double radius, const Colour& colour) {
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(1);
  sphere->SetThetaResolution(20);
  sphere->SetPhiResolution(12);
  sphere->Update();
  vtkNew<vtkAppendPolyData> all;
  for (const Eigen::Vector3d& c : centres) append(all, sphere->GetOutput(), Eigen::Translation3d(c) * Eigen::Scaling(radius));
  if (centres.empty()) return actorOf(vtkSmartPointer<vtkPolyData>::New(), colour);
  all->Update();
  vtkSmartPointer<vtkActor> actor = actorOf(all->GetOutput(), colour);
  soften(actor);
  return actor;
}

vtkSmartPointer<vtkActor> arrowActor(const std::vector<Segment>& arrows, double radius, const Colour& colour) {
  vtkNew<vtkAppendPolyData> all;
  bool any = false;
  for (const auto& [from, to] : arrows) {
    const Eigen::Vector3d axis = to - from;
    const double length = axis.norm();
    if (!(length > 1e-12 * radius)) continue;
    const double head = std::min(0.45 * length, 7 * radius);
    // Both sources are centred at the origin; the cylinder's axis is y, the cone's is x.
    vtkNew<vtkCylinderSource> shaft;
    shaft->SetResolution(12);
    shaft->SetRadius(radius);
    shaft->SetHeight(length - head);
    shaft->SetCenter(0, 0.5 * (length - head), 0);
    shaft->Update();
    vtkNew<vtkConeSource> tip;
    tip->SetResolution(16);
    tip->SetRadius(2.6 * radius);
    tip->SetHeight(head);
    tip->SetDirection(0, 1, 0);
    tip->SetCenter(0, length - 0.5 * head, 0);
    tip->Update();
    const Eigen::Affine3d place = Eigen::Translation3d(from) * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), axis);
    append(all, shaft->GetOutput(), place);
    append(all, tip->GetOutput(), place);
    any = true;
  }
  if (!any) return actorOf(vtkSmartPointer<vtkPolyData>::New(), colour);
  all->Update();
  vtkSmartPointer<vtkActor> actor = actorOf(all->GetOutput(), colour);
  soften(actor);
  return actor;
}

vtkSmartPointer<vtkActor> discActor(const Eigen::Vector3d& centre, const Eigen::Vector3d& unitNormal, double radius,
                                    const Colour& colour, double opacity) {
  vtkNew<vtkRegularPolygonSource> disc;
  disc->SetNumberOfSides(72);
  disc->SetRadius(radius);
  disc->SetCenter(centre.data());
  disc->SetNormal(unitNormal.data());
  disc->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  disc->GeneratePolylineOff();
  disc->Update();
  vtkSmartPointer<vtkActor> actor = actorOf(disc->GetOutput(), colour);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->LightingOff();
  return actor;
}

vtkSmartPointer<vtkActor> sheetActor(const TriangleMesh& mesh, const Colour& colour, double opacity) {
  vtkSmartPointer<vtkActor> actor = actorOf(toPolyData(mesh), colour);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->LightingOff();
  return actor;
}

vtkSmartPointer<vtkActor> ellipsoidActor(const Eigen::Affine3d& worldFromUnitSphere, const Colour& colour, double opacity) {
  vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(1);
  sphere->SetThetaResolution(64);
  sphere->SetPhiResolution(33);
  sphere->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  sphere->Update();
  vtkSmartPointer<vtkActor> actor = actorOf(sphere->GetOutput(), colour);
  actor->SetUserMatrix(toVtk(worldFromUnitSphere.matrix()));
  actor->GetProperty()->SetOpacity(opacity);
  soften(actor);
  return actor;
}

std::vector<Segment> dashed(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double dash) {
  const double length = (to - from).norm();
  if (!(length > 0) || !(dash > 0)) return {};
  const int pieces = static_cast<int>(std::clamp(std::round(length / dash), 1.0, 399.0)) | 1;  // odd: begins and ends with a dash
  std::vector<Segment> segments;
  for (int i = 0; i < pieces; i += 2) {
    segments.emplace_back(from + (to - from) * (static_cast<double>(i) / pieces),
                          from + (to - from) * (static_cast<double>(i + 1) / pieces));
  }
  return segments;
}

}  // namespace glint::viz
