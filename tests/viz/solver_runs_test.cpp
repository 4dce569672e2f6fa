// SPDX-License-Identifier: BSD-3-Clause
// Runs of solvers in the 3D view: each from its start to its end, those of the selected model alone.
#include "viz/solver_runs.h"

#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>

#include "tests/viz/small_inspection.h"
#include "viz/layers.h"

namespace glint::viz {
namespace solver_runs_tests {

constexpr double kDrawn = 1e-5;  // single precision, relative

SolverRun run(const Eigen::Vector4d& start, const Eigen::Vector4d& end, bool answer) {
  SolverRun r;
  r.what = "light";
  r.unit = "px^2";
  r.rounds = {{9, 1}};
  r.ending = "converged";
  r.answer = answer;
  r.start = start;
  r.end = end;
  return r;
}

struct Scene {
  test::TemporaryFolder folder;
  std::shared_ptr<Inspection> inspection = test::smallInspection(folder.path());
  SceneScale scale;
  LayerContent layer(const std::vector<DrawnRuns>& runs, const std::string& selected, std::vector<std::string> models) {
    LayerInput input;
    input.inspection = inspection.get();
    input.surface = *inspection->surfaces->surfaceOf(0, {});
    input.scale = scale = sceneScale(*inspection, input.surface.get(), {0, 1, 2, 3}, 1);
    input.selection.model = selected;
    input.models = std::move(models);
    input.runs = std::make_shared<const std::vector<DrawnRuns>>(runs);
    return solverRunsLayer(input);
  }
};

/// Ends of the segment that is drawn; the layer draws one of two points for each run.
std::vector<Segment> segmentsOf(const LayerContent& content) {
  std::vector<Segment> segments;
  for (const Drawn& d : content.drawn) {
    vtkPolyData* data = vtkPolyDataMapper::SafeDownCast(vtkActor::SafeDownCast(d.prop)->GetMapper())->GetInput();
    if (data->GetNumberOfLines() == 1 && data->GetNumberOfPoints() == 2)
      segments.emplace_back(toEigen(data->GetPoint(0)), toEigen(data->GetPoint(1)));
  }
  return segments;
}

TEST(SolverRuns, GoFromTheStartToTheEnd) {
  Scene scene;
  const LayerContent content =
      scene.layer({{"dual", "lamp", {run({0.2, 0, 0.4, 1}, {0.3, 0.3, 1.2, 2}, true)}}}, "dual", {"dual"});
  const std::vector<Segment> segments = segmentsOf(content);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_NEAR((segments[0].first - Eigen::Vector3d(0.2, 0, 0.4)).norm(), 0, kDrawn);
  EXPECT_NEAR((segments[0].second - Eigen::Vector3d(0.15, 0.15, 0.6)).norm(), 0, kDrawn) << "homogeneous: over w";
  ASSERT_EQ(content.labels.size(), 2U) << "of the run that was taken: start and end";
  EXPECT_EQ(content.labels[1].text, "end of light lamp");
  EXPECT_NE(content.drawn.front().info.text.find("9 -> 1 px^2"), std::string::npos);
}

TEST(SolverRuns, OfTheSelectedModelAlone) {
  Scene scene;
  const SolverRun one = run({0.2, 0, 0.4, 1}, {0.3, 0, 0.4, 1}, false);
  const std::vector<DrawnRuns> runs{{"dual", "lamp", {one}}, {"primal", "lamp", {one, one}}};
  EXPECT_EQ(segmentsOf(scene.layer(runs, "dual", {"primal", "dual"})).size(), 1U);
  EXPECT_EQ(segmentsOf(scene.layer(runs, "", {"primal", "dual"})).size(), 3U);
  EXPECT_EQ(segmentsOf(scene.layer(runs, "", {"primal"})).size(), 2U);
  EXPECT_TRUE(scene.layer(runs, "", {"primal"}).labels.empty()) << "none of these was taken";
}

TEST(SolverRuns, AnEndAtInfinityIsDrawnBesideTheScene) {
  Scene scene;
  const LayerContent content = scene.layer({{"dual", "lamp", {run({0.2, 0, 0.4, 1}, {0.6, 0, 0.8, 0}, true)}}}, "dual", {"dual"});
  const std::vector<Segment> segments = segmentsOf(content);
  ASSERT_EQ(segments.size(), 1U);
  const Eigen::Vector3d from = scene.scale.sceneBox.center(), to = segments[0].second;
  EXPECT_NEAR((to - from).norm(), scene.scale.sceneSize, 1e-4 * scene.scale.sceneSize);
  EXPECT_NEAR((to - from).normalized().dot(Eigen::Vector3d(0.6, 0, 0.8)), 1, 1e-6);
  EXPECT_EQ(content.labels.back().text, "end of light lamp (far away)");
}

TEST(SolverRuns, WithoutAPlaceNothingIsDrawn) {
  Scene scene;
  SolverRun none = run({0, 0, 1, 1}, {0, 0, 1, 1}, true);
  none.end = std::nullopt;
  EXPECT_TRUE(scene.layer({{"dual", "lamp", {none}}}, "", {"dual"}).drawn.empty());
  EXPECT_TRUE(scene.layer({}, "", {"dual"}).drawn.empty());
}

}  // namespace solver_runs_tests
}  // namespace glint::viz
