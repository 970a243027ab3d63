// SPDX-License-Identifier: MIT
// The program for which the headers of all tests are compiled.
int main() { return 0; }
