// SPDX-License-Identifier: BSD-3-Clause
// Curves of cameras, measured by others.
#include <cmath>

#include "core/scene/camera_response.h"
#include "tests/fuzz/readers.h"

namespace glint::fuzz {

bool feedResponse(const std::string& bytes) {
  try {
    const CameraResponse response = CameraResponse::ofText(bytes, "fed.csv");
    for (int channel = 0; channel < 3; ++channel) {
      double last = 0;
      for (int i = 0; i <= 255; ++i) {
        const double light = response.lightOf(i / 255.0, channel);
        if (!(light >= last && light <= 1)) throw Finding{"light that falls, leaves 0 to 1 or is no number"};
        last = light;
        const double code = response.codeOf(light, channel);
        if (!(code >= 0 && code <= 1)) throw Finding{"a code outside of 0 to 1"};
      }
      if (last != 1) throw Finding{"the largest code is not the largest light"};
    }
    return true;
  } catch (const InputError& e) {
    checkRefusal(e, "fed.csv");
    return false;
  }
}

}  // namespace glint::fuzz
