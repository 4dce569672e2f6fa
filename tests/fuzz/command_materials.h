// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/fuzz/mutator.h"

namespace glint::fuzz {

/// One way to hand damage to the program: a file of a small input, or words of its command line.
struct Victim {
  std::string reader;  ///< row of the table: "scene", "PNG", "--train"
  std::string input;   ///< folder of the materials that is copied
  std::string file;    ///< in that folder; "" = a word of the command line is damaged instead
  Form form = Form::Bytes;
  std::vector<std::string> commands;  ///< "evaluate . --json out/e.json"; run in the copy. "{}" stands for the damaged word.
  std::string word;                   ///< what "{}" is before
  int weight = 1;
};

/// Makes the inputs with the program itself, in `folder`: scenes of 48 x 36 to 84 x 63 pixels with all kinds of files, a session,
/// meshes, contours, specifications. Throws std::runtime_error when the program does not work at all.
std::vector<Victim> makeMaterials(const std::filesystem::path& program, const std::filesystem::path& folder);

}  // namespace glint::fuzz
