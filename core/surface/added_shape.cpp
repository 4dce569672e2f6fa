// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/added_shape.h"

#include <array>

#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr std::array kOwn{"plane", "sphere", "ellipsoid", "cylinder", "sheet", "torus", "quadric"};

std::vector<std::unique_ptr<const ShapeKind>>& added() {
  static std::vector<std::unique_ptr<const ShapeKind>> kinds;
  return kinds;
}

bool isTaken(const std::string& name) {
  for (const char* own : kOwn)
    if (name == own) return true;
  return addedShapeKind(name) != nullptr;
}

}  // namespace

void checkShapeKind(const ShapeKind& kind) {
  const std::string name = kind.name();
  require(!name.empty() && !isTaken(name), "surface: the name '" + name + "' is taken or empty");
  for (const ShapeNumber& n : kind.numbers()) {
    require(!n.name.empty() && n.name != "type" && n.name != "world_from_surface",
            "surface " + name + ": '" + n.name + "' is no name for a number");
    require(n.least <= n.most && (!n.byDefault || (*n.byDefault >= n.least && *n.byDefault <= n.most)),
            "surface " + name + ": the range or default of '" + n.name + "' is wrong");
  }
}

void addShapeKind(std::unique_ptr<const ShapeKind> kind) {
  require(kind != nullptr, "addShapeKind: no kind");
  checkShapeKind(*kind);
  added().push_back(std::move(kind));
}

const ShapeKind* addedShapeKind(const std::string& name) {
  for (const auto& kind : added())
    if (kind->name() == name) return kind.get();
  return nullptr;
}

std::string knownShapes() {
  std::string all;
  for (const char* own : kOwn) all += (all.empty() ? "" : ", ") + std::string(own);
  for (const auto& kind : added()) all += ", " + kind->name();
  return all;
}

}  // namespace glint
