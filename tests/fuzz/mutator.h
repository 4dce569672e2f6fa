// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace glint::fuzz {

/// What a file is made of, so that damage reaches what lies behind the first check of its syntax.
enum class Form {
  Json,   ///< members, elements and values are damaged, and printed as JSON again
  Text,   ///< lines and words (PLY, OBJ, STL as text; settings; frame specifications)
  Bytes,  ///< bytes and numbers of 1 to 8 bytes (images, binary meshes)
};

/// Equal on every machine for one seed: the standard defines its numbers, and `below` uses no distribution of the library.
using Rng = std::mt19937_64;
std::size_t below(Rng& rng, std::size_t n);  ///< 0 .. n - 1; 0 for n = 0

/// The seed of one input of a series, so that the n-th can be made again without those before it.
Rng rngOf(std::uint64_t seed, std::uint64_t number);

/// One to six changes. Never longer than `most` bytes.
/// @param paths  texts that may stand where a file is named ("../x"), beside those that this file knows
std::string mutated(const std::string& input, Form form, Rng& rng, std::size_t most, const std::vector<std::string>& paths = {});

/// One change of bytes.
std::string mutatedBytes(std::string bytes, Rng& rng);

}  // namespace glint::fuzz
