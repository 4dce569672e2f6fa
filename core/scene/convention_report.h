// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/correction.h"
#include "core/scene/scene.h"
#include "core/scene/track_check.h"

namespace glint {

/// The grid on which coordinates lie because of how they were written.
struct CoordinateGrid {
  double spacing = 0;            ///< units of the coordinates: the widest of the three axes
  bool singlePrecision = false;  ///< the spacing of floats there; else decimal places of a text
};
/// Whether all coordinates lie on the grid of single precision, or of a text with few digits, and use it: its last digit varies,
/// too, as it does where numbers were rounded and does not where a shape has round coordinates. Nothing for doubles written in
/// full, or for an axis along which nothing varies.
std::optional<CoordinateGrid> coordinateGrid(const std::vector<Eigen::Vector3d>& vertices);

/// What the highlights say about images and intrinsics that cannot be seen in a single frame: mirrored images, a principal point
/// that is half a pixel off (programs that put (0, 0) at a corner of the first pixel, not at its centre), a wrong focal length.
struct CameraCheck {
  /// The first hypothesis of known lamps, whose rmsPx are degrees (core/advise/known_lamp_check.h).
  static constexpr const char* kAsStated = "as stated";
  /// The light and lobe that explain the contours best if the images or cameras were changed so.
  struct Hypothesis {
    std::string change;           ///< "as given", "images mirrored left-right", ...
    std::optional<double> rmsPx;  ///< of the contours' residuals; nothing where no light explains them
  };
  int views = 0;
  std::vector<Hypothesis> hypotheses;  ///< the first one is "as given"; empty where the check did not run
  std::string whyNot;                  ///< why it did not run
  /// The angle by which mirrored rays of the highlights miss the lamp that they share best, in three quarters of the views.
  std::optional<double> missDeg;
  std::string lightFrame;             ///< where the lamp moves with the camera, in words; "" = it stands still, or nothing fits
  std::optional<double> focalPct;     ///< the change of the focal length that fits best, percent
  std::optional<double> shiftPx;      ///< the shift of the principal point, the same along x and y, that fits best
  std::vector<std::string> findings;  ///< what is clear, one line each; mostly empty
  std::optional<Correction> correction;  ///< that undoes the last finding
};

/// What a scene was understood to be, and tests of that understanding on its own data (docs/formats.md, "Conventions"): wrong
/// axes, a transposed pose, wrong units and swapped files show here before they show as bad results.
struct ConventionReport {
  struct SurfaceFacts {
    std::string id, kind;             ///< kind: "mesh", "analytic sphere", ...
    int vertices = 0, triangles = 0;  ///< of the mesh, or of the triangles that stand for the analytic surface
    bool hasNormals = false;
    Eigen::Vector3d lower{0, 0, 0}, upper{0, 0, 0};  ///< bounding box, m
    std::optional<CoordinateGrid> grid;              ///< of a mesh's vertices, where they were stored with few digits
    double side = 0;                                 ///< m, of a triangle: median of the longest ones
  };
  struct FrameFacts {
    int frame = -1;
    std::string id, surface;
    int vertices = 0;                      ///< of its surface; 0 when it has only depth
    int verticesInFront = 0;               ///< with positive depth
    int verticesInImage = 0;               ///< that project inside the image
    bool seesSurface = false;              ///< at least one vertex, a pixel that looks at a triangle, or a valid depth pixel
    double distance = 0;                   ///< m, camera to the centre of the surface's box; 0 without a surface
    int depthSamples = 0;                  ///< nearest vertices of 8-pixel cells compared with the depth map
    double depthMedian = 0, depthP95 = 0;  ///< m, |vertex depth - depth map|
    double depthRatio = 0;                 ///< median of depth map / vertex depth
    double depthRatioShare = 0;            ///< of the samples, those within 1 % of that median; others are of the far side
    long long pixels = 0, notFinite = 0, negative = 0;  ///< values of the linear image
    std::string source;                                 ///< "radiance" or "image", "" when the frame has neither
    std::string linear;                                 ///< how the values became linear, in words (readLinear)
    std::vector<std::string> problems;                  ///< files that cannot be read, one line each
  };
  std::string recognisedAs, name, file;
  std::vector<std::string> facts;  ///< what was recognised in a capture of another program and converted
  std::vector<std::string> warnings;
  std::vector<SurfaceFacts> surfaces;
  std::vector<FrameFacts> frames;
  int lights = 0;
  std::optional<TrackCheck> tracks;    ///< of a capture with sparse points
  std::optional<CameraCheck> cameras;  ///< by its highlights, where that check ran
  std::vector<std::string> findings;   ///< what looks wrong, one line each, with the likely cause; empty = nothing found
  struct Proposal {
    std::size_t finding = 0;  ///< index in `findings`
    Correction correction;
  };
  std::vector<Proposal> corrections;  ///< in the order of the findings; some findings have no correction

  void take(CameraCheck check);  ///< with its findings
  void add(std::string finding, std::optional<Correction> correction = {});
  /// What is said without a finding: no more than what was checked.
  std::string cleanBill() const;
  bool anyFrameSeesSurface() const;
  bool everyFrameSeesSurface() const;
};

/// Reads every surface and every image once. InputError when a mesh cannot be read; Stopped.
ConventionReport conventionReport(const Scene& scene, const ProgressFn& progress = {});

/// Where the sparse points put a mesh through which most of them do not pass: adds to their finding, or makes one where another
/// place explains them. Does nothing where a correction of the mesh's unit or place is known already. InputError, Stopped.
void placeMesh(const Scene& scene, const ProgressFn& progress, ConventionReport& report);

std::string toText(const ConventionReport& report);  ///< for a terminal, ends with a line break
std::string findingsText(
    const ConventionReport& report);  ///< a line for each, with the command that corrects it; empty without findings
std::string toJson(const ConventionReport& report);  ///< {"glint_info": 1, ...}, laid out, no NaN
/// Another document (an object in JSON) with `findings` and `fixes` of the report as toJson() writes them.
std::string withFindings(const std::string& json, const ConventionReport& report);

}  // namespace glint
