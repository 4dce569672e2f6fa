// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/pipeline/evidence.h"
#include "tests/core/highlight/highlight_images.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::test {

/// A frame of a lobe on coloured (or grey) paint under a soft shadow, seen through a lens: the truth is the lobe's contour in
/// ideal pixels.
struct Coloured {
  testing_support::TemporaryFolder folder;
  Scene scene;
  Blob blob;

  Coloured(bool grey, bool distorted) {
    blob.centre = {138, 92};
    blob.a = 20;
    blob.b = 14;
    blob.height = 1;
    Frame frame;
    frame.id = "0";
    frame.radiance = folder / "0.tiff";
    frame.camera.pixelFromRay << 300, 0, 120, 0, 300, 90, 0, 0, 1;
    frame.camera.width = 240;
    frame.camera.height = 180;
    if (distorted) frame.camera.lens.parameters = {-0.2, 0.05, 0, 0, 0};
    cv::Mat m(180, 240, CV_32FC3);
    for (int y = 0; y < 180; ++y)
      for (int x = 0; x < 240; ++x) {
        const Pixel p = frame.camera.undistorted(Pixel(x, y));
        const double shade = 0.2 + 0.5 / (1 + std::exp(-(p.x() - 146) / 5)), lobe = blob.at(p);
        const double r = 0.6 * shade + lobe, g = (grey ? 0.6 : 0.2) * shade + 0.95 * lobe, b = 0.1 * shade + 0.9 * lobe;
        m.at<cv::Vec3f>(y, x) = grey ? cv::Vec3f(float(r), float(r), float(r)) : cv::Vec3f(float(b), float(g), float(r));
      }
    EXPECT_TRUE(cv::imwrite(frame.radiance.string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
    scene.folder = folder.path();
    scene.frames.push_back(frame);
  }
  FrameEvidence detected() const { return gatherEvidence(scene, 0, FrameSource::Radiance, Settings{}); }
};

}  // namespace glint::test
