// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "core/base/number_text.h"
#include "core/scene/convention_report.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/core/surface/registration_fixture.h"

namespace glint::mesh_placement_tests {
namespace {
using namespace registration_tests;
using Eigen::Vector3d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kCameras = 24;
constexpr const char* kElsewhere = "the surface passes through 3 of the 200 sparse points that it should";

/// A capture whose mesh is in a frame and unit of its own: `truth` takes it to the cameras' world. The report has what was found
/// before.
struct Misplaced {
  testing_support::TemporaryFolder folder;
  TriangleMesh mesh;
  Similarity truth;
  Scene scene;
  ConventionReport report;

  Misplaced(TriangleMesh shape, const Similarity& worldFromMesh, const Cloud& cloud = {})
      : mesh(std::move(shape)), truth(worldFromMesh) {
    std::string obj;
    for (const Vector3d& v : mesh.vertices) obj += formatted("v %.17g %.17g %.17g\n", v.x(), v.y(), v.z());
    for (const Eigen::Vector3i& t : mesh.triangles) obj += formatted("f %d %d %d\n", t.x() + 1, t.y() + 1, t.z() + 1);
    scene.surfaces["body"] = MeshFile{{folder.write("mesh.obj", obj)}};
    Eigen::AlignedBox3d box;
    for (const Vector3d& v : mesh.vertices) box.extend(v);
    for (int i = 0; i < kCameras; ++i) {
      const double a = 2 * M_PI * i / kCameras;
      look(box.center() + 2.5 * box.sizes().norm() * Vector3d(std::cos(a), std::sin(a), 0.4), box.center());
    }
    report.tracks.emplace();
    report.tracks->sample = cloudOf(mesh, truth, cloud);
    report.tracks->findings = {kElsewhere};
    report.add(kElsewhere);
  }

  /// A camera in the world at the place and towards the point that these are of the mesh.
  void look(const Vector3d& from, const Vector3d& at) {
    const Vector3d eye = truth * from, z = (truth * at - eye).normalized(), x = z.unitOrthogonal();
    Frame frame;
    frame.id = std::to_string(scene.frames.size());
    frame.surface = "body";
    frame.camera.width = frame.camera.height = 400;
    frame.camera.pixelFromRay << 300, 0, 199.5, 0, 300, 199.5, 0, 0, 1;
    Eigen::Matrix3d axes;
    axes << x, z.cross(x), z;
    frame.camera.camFromWorld.linear() = axes.transpose();
    frame.camera.camFromWorld.translation() = -(axes.transpose() * eye);
    scene.frames.push_back(frame);
  }

  void place() { placeMesh(scene, {}, report); }

  /// px, largest distance of a vertex through a corrected camera from where the capture's camera shows it at its right place.
  double errorPx() const {
    const Scene moved = corrected(scene, report.tracks->correction->fix);
    double most = 0;
    for (std::size_t i = 0; i < scene.frames.size(); ++i)
      for (std::size_t v = 0; v < mesh.vertices.size(); v += 50)
        most = std::max(
            most, (*moved.frames[i].camera.project(mesh.vertices[v]) - *scene.frames[i].camera.project(truth * mesh.vertices[v]))
                      .norm());
    return most;
  }
};

TEST(PlaceMesh, FindsTurnShiftAndScale) {
  for (const double scale : {1.7, 1e-3, 1e3}) {
    Misplaced capture(body(lump), anySimilarity(5, scale));
    capture.place();
    ASSERT_TRUE(capture.report.tracks->correction) << capture.report.findings.front();
    EXPECT_LT(capture.errorPx(), 1e-3) << scale;
    EXPECT_THAT(capture.report.findings,
                ElementsAre(AllOf(HasSubstr(kElsewhere),
                                  HasSubstr(formatted("the mesh is %.4g times as large and 24 of 24 cameras see it", scale)))));
    EXPECT_EQ(capture.report.tracks->findings, capture.report.findings);
    ASSERT_EQ(capture.report.corrections.size(), 1u);
    EXPECT_EQ(capture.report.corrections[0].finding, 0u);
    EXPECT_EQ(capture.report.corrections[0].correction.fix, capture.report.tracks->correction->fix);
  }
}

TEST(PlaceMesh, FindsWhatIsOnlyTurnedShiftedOrScaled) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix(),
                        none = Eigen::Matrix3d::Identity();
  for (const Similarity& truth :
       {Similarity{1, turn, {0, 0, 0}}, Similarity{1, none, {0.4, -0.2, 0.1}}, Similarity{0.5, none, {0, 0, 0}}}) {
    Misplaced capture(body(lump), truth);
    capture.place();
    ASSERT_TRUE(capture.report.tracks->correction) << capture.report.findings.front();
    EXPECT_LT(capture.errorPx(), 1e-3);
  }
}

/// 200 points that scatter by 0.5 % of the size determine a corner to some 0.2 % of it: less than a pixel of images in which the
/// mesh is 120 px large. Points of a floor and walls do no harm.
TEST(PlaceMesh, NoiseAndOtherThingsInTheCloud) {
  TriangleMesh mesh = body(lump);
  const double size = 2.4;  // of the lump's box
  Misplaced capture(std::move(mesh), anySimilarity(9, 20), {200, 0.005 * size, 0.5, 300, 3});
  capture.place();
  ASSERT_TRUE(capture.report.tracks->correction) << capture.report.findings.front();
  EXPECT_LT(capture.errorPx(), 1);
  EXPECT_GT(capture.errorPx(), 1e-3);  // the noise was there
}

/// Where too many points lie on the surface by chance, another place is a finding only if it is another one.
TEST(PlaceMesh, WithoutAFindingOnlyAnotherPlaceIsOne) {
  Misplaced right(body(lump), {1, Eigen::Matrix3d::Identity(), {0, 0, 0}}, {200, 0.002, 0, 300, 1});
  Misplaced nearly(body(lump), {1, Eigen::Matrix3d::Identity(), {0.02, 0, 0}});  // 1 % of the size: noise of points moves as much
  Misplaced wrong(body(lump), {1.2, Eigen::Matrix3d::Identity(), {0, 0, 0}});
  for (Misplaced* capture : {&right, &nearly, &wrong}) {
    capture->report.findings.clear();
    capture->report.tracks->findings.clear();
    capture->place();
  }
  EXPECT_THAT(right.report.findings, IsEmpty());
  EXPECT_THAT(right.report.corrections, IsEmpty());
  EXPECT_THAT(nearly.report.findings, IsEmpty());
  EXPECT_THAT(wrong.report.findings, ElementsAre(HasSubstr("the mesh is 1.2 times as large")));
  EXPECT_LT(wrong.errorPx(), 1e-3);
}

TEST(PlaceMesh, SaysWhyItFindsNone) {
  Misplaced turns(body(ball), anySimilarity(2, 1));
  turns.place();
  EXPECT_THAT(turns.report.findings,
              ElementsAre(AllOf(HasSubstr(kElsewhere), HasSubstr("was not found"), HasSubstr("ambiguous"))));
  Misplaced few(body(lump), anySimilarity(2, 1), {19, 0, 0, 300, 1});
  few.place();
  EXPECT_THAT(few.report.findings, ElementsAre(HasSubstr("too few points")));
  Misplaced other(body(lump), anySimilarity(2, 1));
  other.report.tracks->sample =
      cloudOf(body([](const Vector3d& d) { return Vector3d(d / d.cwiseAbs().maxCoeff()); }), other.truth, {});
  other.place();  // a cube
  EXPECT_THAT(other.report.findings, ElementsAre(HasSubstr("was not found")));
  for (const Misplaced* capture : {&turns, &few, &other}) {
    EXPECT_FALSE(capture->report.tracks->correction);
    EXPECT_THAT(capture->report.corrections, IsEmpty());
  }
}

TEST(PlaceMesh, APlaceThatMostCamerasDoNotSeeIsNone) {
  Misplaced capture(body(lump), anySimilarity(4, 1));
  for (int i = 0; i < kCameras; ++i) capture.look({9, 0, 1}, {20, 0, double(i)});
  capture.look({9, 0, 1}, {20, 0, 9});
  capture.place();
  EXPECT_THAT(capture.report.findings, ElementsAre(HasSubstr("put the mesh where 24 of 49 cameras see it")));
  EXPECT_FALSE(capture.report.tracks->correction);
}

TEST(PlaceMesh, OtherCorrections) {
  Misplaced known(body(lump), anySimilarity(4, 1));
  known.report.add("the mesh is in millimetres", Correction{"mesh-mm", "Read the mesh in millimetres"});
  known.place();
  EXPECT_EQ(known.report.findings[0], kElsewhere);  // it is known what is wrong
  EXPECT_EQ(known.report.corrections.size(), 1u);
  Misplaced inverse(body(lump), anySimilarity(4, 1));
  inverse.report.add("4 of 24 cameras do not see their surface", Correction{"invert-poses", "Invert the poses"});
  inverse.report.add("the depth is in millimetres", Correction{"depth-mm", "Read depth in millimetres"});
  inverse.place();
  ASSERT_EQ(inverse.report.corrections.size(), 2u);
  EXPECT_THAT(inverse.report.corrections[0].correction.fix, HasSubstr("mesh-similarity="));
  EXPECT_EQ(inverse.report.corrections[1].correction.fix, "depth-mm");
}

}  // namespace
}  // namespace glint::mesh_placement_tests
