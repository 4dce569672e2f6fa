// SPDX-License-Identifier: BSD-3-Clause
// Nothing but what the folder needs that is linked with it.
int main() {}
