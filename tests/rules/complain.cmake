# SPDX-License-Identifier: BSD-3-Clause
# What a rule of the sources collects in `broken`: a line with the file, named from SRC.
set(broken "")
macro(complain file text)
  file(RELATIVE_PATH name "${SRC}" "${file}")
  string(APPEND broken "\n  ${name}: ${text}")
endmacro()
