// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/memory_rules.h"

#include <cstddef>

#include "core/base/memory.h"
#include "core/scene/scene.h"

namespace glint::gui {

void applyMemoryRules() {
  constexpr std::size_t kDecodedImages = 256'000'000;  // bytes: 280 colour photographs of 640 x 480, 40 of 1920 x 1080
  keepFreedMemory();
  reserveTaskMemory();
  keepDecodedImages(kDecodedImages);
}

}  // namespace glint::gui
