// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer's entry for one reader of meshes. A finding is a crash, a sanitizer's report, an exception other than InputError, or
// a mesh that breaks its promises.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/base/outcome.h"
#include "io/mesh_reader.h"
#include "tests/io/mesh_texts.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
#if defined(GLINT_FUZZ_ply)
    const glint::MeshContent mesh = glint::parsePly(bytes, "m.ply");
#elif defined(GLINT_FUZZ_obj)
    const glint::MeshContent mesh = glint::parseObj(bytes, "m.obj");
#else
    const glint::MeshContent mesh = glint::parseMesh(bytes, "m.stl");
#endif
    if (!glint::testing_support::brokenPromise(mesh).empty()) std::abort();
  } catch (const glint::InputError&) {
  }
  return 0;
}
