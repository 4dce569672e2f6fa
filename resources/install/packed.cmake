# SPDX-License-Identifier: BSD-3-Clause
# Run by cpack on the packages that it has made.
find_program(PYTHON python3)
if(PYTHON)
  execute_process(COMMAND "${PYTHON}" -B "${CMAKE_CURRENT_LIST_DIR}/same_modes.py" ${CPACK_PACKAGE_FILES} COMMAND_ERROR_IS_FATAL ANY)
endif()
