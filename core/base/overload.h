// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// Functions as one, for std::visit: an alternative that none of them takes does not compile.
template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;  // clang 14 does not find it

}  // namespace glint
