/* SPDX-License-Identifier: BSD-3-Clause */
/* Loaded into a program with LD_PRELOAD: sets the locale of the environment before main, as Qt does for a whole process. Programs that are
   started with a locale of their own (CMake does so) keep it. The test suite_locale says whether the suite runs under the comma at all. */
#include <locale.h>
#include <stdlib.h>

__attribute__((constructor)) static void setLocaleOfTheEnvironment(void) {
  if (!getenv("LC_ALL")) setlocale(LC_ALL, "");
}
