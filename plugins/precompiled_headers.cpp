// SPDX-License-Identifier: MIT
// Empty source file for the precompiled headers of the shipped plugins.
