// SPDX-License-Identifier: Apache-2.0
// A shared library without an entry point.
int nothing_to_see();
int nothing_to_see() { return 0; }
