// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/outcome.h"
#include "core/surface/analytic.h"
#include "core/surface/surface.h"

namespace glint {

class JsonNode;     // core/base/json_text.h
struct PointCloud;  // core/surface/point_surface.h

/// What a file holds of a surface. In metres.
struct SurfaceTriangles {
  TriangleMesh mesh;                    ///< the points alone, without triangles, where no surface can be made of them
  std::string of = {};                  ///< what was found about the points, in words; "" = the triangles are the file's own
  std::optional<Failure> failure = {};  ///< why no surface can be made
  std::size_t leftOut = 0;              ///< facets of the file with a corner that has no place
};

/// A file from which a surface is read.
struct SurfaceFile {
  std::filesystem::path file;  ///< absolute
  std::string named = {};      ///< its path as the scene file writes it; "" = no scene file names it, or none can
  double metresPerUnit = 1;    ///< of its coordinates: 0.001 where it is in millimetres
};
struct MeshFile : SurfaceFile {
  static constexpr const char* kKind = "mesh";
  SurfaceTriangles triangles() const;
};
/// Points without triangles, from which the surface is made (surfaceOfPoints).
struct PointsFile : SurfaceFile {
  static constexpr const char* kKind = "points";
  SurfaceTriangles triangles() const;
};
/// The sparse points of a capture, whose file it is (`--surface points`).
struct CapturePoints : SurfaceFile {
  static constexpr const char* kKind = "points";
  std::shared_ptr<const PointCloud> points;  ///< not null
  SurfaceTriangles triangles() const;
};

/// Where a surface comes from. What depends on the alternative is declared here and defined in surface_source.cpp; callers ask
/// for one alternative only to edit it.
struct SurfaceSource : std::variant<AnalyticSpec, MeshFile, PointsFile, CapturePoints> {
  using variant::variant;
  const AnalyticSpec* analytic() const { return std::get_if<AnalyticSpec>(this); }  ///< null where it has no formula
  AnalyticSpec* analytic() { return std::get_if<AnalyticSpec>(this); }
  const SurfaceFile* file() const;  ///< null where it needs none
  SurfaceFile* file() { return const_cast<SurfaceFile*>(std::as_const(*this).file()); }
  /// Whether its triangles take seconds to read and have normals that may be off; else the surface is exact.
  bool hasTriangles() const { return !analytic(); }

  /// Reads its triangles, or makes them; fails for a formula. InputError when the file cannot be read.
  SurfaceTriangles triangles() const;
  /// The same as `triangles`, perhaps from memory.
  using Triangles = std::function<SurfaceTriangles(const SurfaceSource&)>;
  /// The surface that rays meet. The failure of its triangles; InputError as `read`, or for a mesh that cannot be used;
  /// std::invalid_argument for a formula that makes no surface.
  Outcome<std::shared_ptr<const Surface>> load(MeshPolicy policy, const Triangles& read = &SurfaceSource::triangles) const;
  /// Whether both have triangles, and the same ones (of a file that did not change).
  bool hasTrianglesOf(const SurfaceSource& other) const;

  std::string kind() const;                                                     ///< "mesh", "points", "analytic sphere"
  std::string shape() const { return analytic() ? analytic()->type : "mesh"; }  ///< what it is in the end
};

/// A surface of a document, and the keys that are known in its objects: "" is the surface itself.
struct ReadSurface {
  SurfaceSource source;
  std::map<std::string, std::set<std::string>> known;
};
/// {one of "mesh" | "points" | "analytic", "units"} (docs/formats.md, "Surfaces"). InputError with file, place and reason.
/// @param find  the file that a text names; throws for a missing file
/// @param keys  that the document reads
ReadSurface readSurfaceJson(const JsonNode& node, const std::function<std::filesystem::path(const JsonNode&)>& find,
                            const std::vector<std::string>& keys = {"mesh", "points", "analytic", "units"});

/// Reads a PLY, OBJ, STL or glTF mesh, recognised by content, in the precision of the file (io/mesh_reader.h says what is
/// understood). Polygons are split into triangles. Normals are the file's (brought to length 1) when every vertex of a triangle
/// has one, else empty.
/// @throw InputError (file, place) when the file is missing, empty, not one of the four formats, truncated or longer than its
///        header promises, has no triangle, a coordinate that is not finite, or a face with a vertex that does not exist.
TriangleMesh readMesh(const std::filesystem::path& file);
/// The same of a file's content; `file` is what messages name.
TriangleMesh meshOf(std::string_view bytes, const std::filesystem::path& file);
/// Whether a file holds points without triangles (PLY without faces, PCD), by its first bytes.
bool isCloudFile(const std::filesystem::path& file);

}  // namespace glint
