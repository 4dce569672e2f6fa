# SPDX-License-Identifier: BSD-3-Clause
# complain(FILE REASON): adds a line to `broken`, which a rule of the sources collects, with the file named from SRC.
set(broken "")
macro(complain file text)
  file(RELATIVE_PATH name "${SRC}" "${file}")
  string(APPEND broken "\n  ${name}: ${text}")
endmacro()
