# SPDX-License-Identifier: BSD-3-Clause
# Run by cpack on what it has installed for the packages: the loader knows the system's folders, so no file keeps a search path of its own;
# manual pages are compressed, as Debian has them, without a date; everybody may enter the folders, whatever the builder's umask is.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  set(ENV{SOURCE_DATE_EPOCH} 1767225600)  # 2026-01-01, that of the package's changelog: two builds give the same bytes
endif()
file(GLOB_RECURSE places LIST_DIRECTORIES true "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*")
foreach(place IN LISTS places)
  if(IS_DIRECTORY "${place}" AND NOT IS_SYMLINK "${place}")
    file(CHMOD "${place}" DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  endif()
endforeach()
file(GLOB_RECURSE files "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*")
foreach(file IN LISTS files)
  if(IS_SYMLINK "${file}")
    continue()
  endif()
  if(file MATCHES "/man1/[^/]+[.]1$")
    execute_process(COMMAND gzip -9n "${file}" COMMAND_ERROR_IS_FATAL ANY)
  elseif(file MATCHES "/bin/[^/]+$|[.]so[.0-9]*$")
    file(RPATH_REMOVE FILE "${file}")
  endif()
endforeach()
