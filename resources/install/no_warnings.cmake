# SPDX-License-Identifier: BSD-3-Clause
# cmake -D FILE=<warnings> -P no_warnings.cmake: fails where the file is not empty, and shows it.
file(READ "${FILE}" text)
if(NOT text STREQUAL "")
  message(FATAL_ERROR "${text}")
endif()
