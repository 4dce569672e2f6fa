// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/version.h"
#include "core/model/model.h"
#include "core/reflectance/added_lobe.h"
#include "core/scene/capture.h"
#include "core/surface/added_shape.h"

/// For plugins: shared libraries that add to Glint while it starts. One file says
///
///   GLINT_PLUGIN("flat-mirror", "1.0", "Predicts on the tangent plane alone", [](glint::PluginRegistry& glint) {
///     glint.add(std::make_unique<FlatMirror>());
///   })
///
/// and links Glint::core. Programs load it by --plugin FILE, or from GLINT_PLUGIN_PATH's folders. It is part of the program: it
/// can do what the user can do, and a fault in it ends the program. docs/cpp.md is the walkthrough, plugins/example an example.
namespace glint {

namespace viz {
class LayerRegistry;  // viz/added_layer.h
}

/// Takes what a plugin adds. Nothing is kept unless all of it can be.
class PluginRegistry {
 public:
  virtual ~PluginRegistry() = default;
  virtual void add(std::unique_ptr<HighlightModel> model) = 0;
  virtual void add(std::unique_ptr<const LobeProfile> lobe) = 0;
  virtual void add(std::unique_ptr<const ShapeKind> surface) = 0;
  virtual void add(std::unique_ptr<const CaptureReader> reader) = 0;
};

/// What a plugin exports as the C symbol `glint_plugin`: data, so that it is checked before any function of the plugin is called
/// (but for its constructors of global objects, which the loader runs).
struct PluginDeclaration {
  std::uint32_t magic;     ///< kPluginMagic
  std::int32_t interface;  ///< GLINT_INTERFACE_VERSION of the headers that it was compiled with; checked before the rest is read
  const char* headers;     ///< GLINT_VERSION of them
  std::int32_t alignment;  ///< of Eigen's vectors there: -march=native on one side alone makes objects of another shape
  const char* name;        ///< "flat-mirror"
  const char* version;     ///< its own
  const char* about;       ///< one line for a person
  void (*add)(PluginRegistry&);
  void (*addLayers)(viz::LayerRegistry&);  ///< null if it draws nothing; a program without pictures does not call it
};

inline constexpr std::uint32_t kPluginMagic = 0x676c6e74;  // "glnt"

}  // namespace glint

/// The declaration of a plugin that adds to the core and to the layers of the 3D view.
#define GLINT_PLUGIN_WITH_LAYERS(NAME, VERSION, ABOUT, ADD, ADD_LAYERS)                                                  \
  extern "C"                                                                                                             \
      __attribute__((visibility("default"))) const glint::PluginDeclaration glint_plugin{                                \
          glint::kPluginMagic, GLINT_INTERFACE_VERSION, GLINT_VERSION, EIGEN_MAX_ALIGN_BYTES, NAME, VERSION, ABOUT, ADD, \
          ADD_LAYERS};
/// The declaration of a plugin that adds to the core alone.
#define GLINT_PLUGIN(NAME, VERSION, ABOUT, ADD) GLINT_PLUGIN_WITH_LAYERS(NAME, VERSION, ABOUT, ADD, nullptr)
