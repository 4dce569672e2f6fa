// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/document_kind.h"

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"

namespace glint {

std::string documentKind(const std::filesystem::path& file) {
  try {
    const json_dom::Json root = json_dom::parse(readFile(file, Limit::JsonMegabytes), file.string());
    if (!root.is_object()) return "";
    for (const auto& [key, value] : root.items())
      if (key.rfind("glint_", 0) == 0 && value.is_number_integer()) return key;
  } catch (const std::exception&) {
    // Whatever it is, it is no document of ours.
  }
  return "";
}

}  // namespace glint
