// SPDX-License-Identifier: BSD-3-Clause
// A plugin that adds one lobe, with the fault that its build names.
#include <stdexcept>

#include "core/app/plugin.h"
#include "plugins/example/flat_mirror.h"
#include "plugins/example/student_lobe.h"
#include "plugins/example/superellipsoid.h"

namespace {

class WrongDerivative : public glint::LobeProfile {
 public:
  std::string name() const override { return "wrong"; }
  glint::ProfileValue logDistribution(double m, double t) const override { return {-t / (m * m), 0, -2 / (m * m)}; }
};

class Rising : public glint::LobeProfile {
 public:
  std::string name() const override { return "rising"; }
  glint::ProfileValue logDistribution(double m, double t) const override {
    return {t / (m * m), -2 * t / (m * m * m), 1 / (m * m)};
  }
};

class WrongRange : public glint::ShapeKind {
 public:
  std::string name() const override { return "box"; }
  std::vector<glint::ShapeNumber> numbers() const override { return {{"a", 1, 2, 3.0}}; }
  std::unique_ptr<const glint::AnalyticShape> make(const std::map<std::string, double>&) const override { return nullptr; }
};

class Taken : public glint::CaptureReader {
 public:
  std::string name() const override { return "colmap"; }
  std::string describe() const override { return ""; }
  std::filesystem::path recognise(const std::filesystem::path&) const override { return {}; }
  glint::Capture read(const std::filesystem::path&, const glint::CaptureOptions&) const override { return {}; }
};

[[maybe_unused]] void add(glint::PluginRegistry& glint) {
  glint.add(std::make_unique<glint::example::StudentLobe>());  // what is right is not kept either where the rest is wrong
#ifdef FAULT_LOBE_DERIVATIVE
  glint.add(std::make_unique<WrongDerivative>());
#endif
#ifdef FAULT_LOBE_RISES
  glint.add(std::make_unique<Rising>());
#endif
#ifdef FAULT_MODEL_TWICE
  glint.add(std::make_unique<glint::example::FlatMirror>());
  glint.add(std::make_unique<glint::example::FlatMirror>());
#endif
#ifdef FAULT_SHAPE_RANGE
  glint.add(std::make_unique<WrongRange>());
#endif
#ifdef FAULT_READER_TAKEN
  glint.add(std::make_unique<Taken>());
#endif
#ifdef FAULT_THROWS
  throw std::runtime_error("no luck today");
#endif
}

#if defined(FAULT_INTERFACE)
[[maybe_unused]] constexpr int kInterface = GLINT_INTERFACE_VERSION - 1;
#elif defined(FAULT_LATER_INTERFACE)
[[maybe_unused]] constexpr int kInterface = GLINT_INTERFACE_VERSION + 1;
#else
[[maybe_unused]] constexpr int kInterface = GLINT_INTERFACE_VERSION;
#endif
#if defined(FAULT_HEADERS)
[[maybe_unused]] constexpr const char* kHeaders = "0.0.9";
#else
[[maybe_unused]] constexpr const char* kHeaders = GLINT_VERSION;
#endif
#if defined(FAULT_ALIGNMENT)
[[maybe_unused]] constexpr int kAlignment = 2 * EIGEN_MAX_ALIGN_BYTES;
#else
[[maybe_unused]] constexpr int kAlignment = EIGEN_MAX_ALIGN_BYTES;
#endif
#if defined(FAULT_NAMELESS)
[[maybe_unused]] constexpr const char* kName = "";
#else
[[maybe_unused]] constexpr const char* kName = "tried";
#endif

}  // namespace

#ifndef FAULT_NO_DECLARATION
extern "C" const glint::PluginDeclaration glint_plugin{glint::kPluginMagic, kInterface, kHeaders, kAlignment, kName, "1",
                                                       "For a test",        add,        nullptr};
#endif
