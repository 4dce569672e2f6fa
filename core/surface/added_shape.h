// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/surface/analytic_shape.h"

namespace glint {

/// A number that scene.json gives for an analytic surface.
struct ShapeNumber {
  std::string name;  ///< its key: "exponent"
  double least = 0, most = 0;
  std::optional<double> byDefault{};  ///< without one the file has to say it
};

/// A kind of analytic surface beyond those of AnalyticSpec: a zero set in a frame of its own.
class ShapeKind {
 public:
  virtual ~ShapeKind() = default;
  virtual std::string name() const = 0;                  ///< as `analytic.type` of scene.json: "superellipsoid"
  virtual std::vector<ShapeNumber> numbers() const = 0;  ///< none of them is named `type` or `world_from_surface`
  /// @param numbers  every one of numbers(), in its range.
  virtual std::unique_ptr<const AnalyticShape> make(const std::map<std::string, double>& numbers) const = 0;
};

/// std::invalid_argument for a name that is taken or empty, or a number without a name or with a wrong range.
void checkShapeKind(const ShapeKind& kind);
/// Adds a kind. Not thread-safe: call it before any scene is read. std::invalid_argument as checkShapeKind().
void addShapeKind(std::unique_ptr<const ShapeKind> kind);
/// Null where no plugin added one of this name.
const ShapeKind* addedShapeKind(const std::string& name);
/// The types that scene.json may name: "plane, sphere, ...".
std::string knownShapes();

}  // namespace glint
