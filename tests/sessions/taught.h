// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the lessons share: a lesson's session, computed once, and its numbers.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/advise/explain.h"
#include "core/app/session.h"

namespace glint::taught {

struct Taught {
  Session session;
  Inspection inspection;
};

inline OpenedSession openLesson(const std::string& id) {
  return openSession(std::string(GLINT_SOURCE_DIR "/sessions/lessons/") + id + "/" + id + ".glint");
}

inline const Taught& lesson(const std::string& id) {
  static std::map<std::string, Taught> all;
  if (const auto it = all.find(id); it != all.end()) return it->second;
  OpenedSession opened = openLesson(id);
  Inspection inspection = inspect(opened.scene, opened.session.request);
  return all.emplace(id, Taught{std::move(opened.session), std::move(inspection)}).first->second;
}

/// The lesson with something of its request changed, as its questions ask for.
template <class Change>
Inspection changed(const std::string& id, const Change& change) {
  OpenedSession opened = openLesson(id);
  change(opened.session.request);
  return inspect(opened.scene, opened.session.request);
}

inline const ExplainStep& stepOf(const Explanation& e, const std::string& id) {
  for (const ExplainStep& s : e.steps)
    if (s.id == id) return s;
  throw std::runtime_error("no step " + id);
}

inline double number(const ExplainStep& s, const std::string& name, std::size_t at = 0) {
  for (const ExplainNumber& n : s.numbers)
    if (n.name == name) return n.values.at(at);
  ADD_FAILURE() << s.id << " has no number \"" << name << "\"";
  return std::nan("");
}

/// From the world to the camera of a frame of the lesson moving-lamp: its specification's orbit, 0.8 m about the origin and 0.4 m
/// above it, from -2.2 to 0.2 rad in eight steps, with the origin in the middle and z upwards.
inline Eigen::Isometry3d movingLampCamera(int frame) {
  const double a = -2.2 + 0.3 * frame;
  const Eigen::Vector3d eye(0.8 * std::cos(a), 0.8 * std::sin(a), 0.4), ahead = -eye.normalized();
  const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << right.transpose(), ahead.cross(right).transpose(), ahead.transpose();
  pose.translation() = -(pose.linear() * eye);
  return pose;
}

/// Semi-axes of its ellipsoid, m, and its lamp, in the camera's coordinates.
inline const Eigen::Vector3d kMovingLampBody(0.4, 0.32, 0.26), kMovingLamp(0.08, -0.06, 0);

/// Contour errors of the held-out frames of a model, %, by frame; of several highlights the largest.
inline std::map<int, double> errorsByFrame(const Inspection& in, const std::string& model) {
  std::map<int, double> all;
  for (const FrameComparison& c : in.models.at(model).frames)
    for (const FrameComparison::Row& row : c.rows)
      if (in.isHeldOut(c.frame) && row.metrics) all[c.frame] = std::max(all[c.frame], row.metrics->contourErrorPct);
  return all;
}

}  // namespace glint::taught
