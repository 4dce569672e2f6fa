// SPDX-License-Identifier: BSD-3-Clause
// One folder of core and what it needs, loaded: nothing that draws may be among it. A module that brings libvtk along crashes in
// programs that have another one, such as ParaView's interpreter.
#include <link.h>

#include <cstdio>
#include <string>

int main() {
  std::string loaded;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* list) {
        *static_cast<std::string*>(list) += std::string(info->dlpi_name) + "\n";
        return 0;
      },
      &loaded);
  int drawing = 0;
  for (const char* const name : {"libvtk", "libQt", "libpcl_io", "libpcl_visualization"})
    if (loaded.find(name) != std::string::npos) {
      std::printf("%s is loaded\n", name);
      ++drawing;
    }
  if (loaded.find("libc.so") == std::string::npos) {
    std::printf("what is loaded cannot be told:\n%s", loaded.c_str());
    ++drawing;
  }
  return drawing;
}
