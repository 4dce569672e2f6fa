/* SPDX-License-Identifier: BSD-3-Clause */
/* Loaded into a program with LD_PRELOAD: sets the locale of the environment before main, as Qt does for a whole process. */
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

__attribute__((constructor)) static void setLocaleOfTheEnvironment(void) {
  if (setlocale(LC_ALL, "") && strcmp(localeconv()->decimal_point, ",") == 0) return;
  fputs("comma_locale: the locale of the environment has no decimal comma\n", stderr);
  _Exit(99); /* a run that tests nothing must not pass */
}
