// SPDX-License-Identifier: MIT
// What a test leaves out where a sanitizer makes it ten times slower, or replaces what it looks at; and where a person
// waits for it.
#pragma once

#include <cstdlib>

namespace palpate::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

#if defined(__SANITIZE_THREAD__)
constexpr bool kThreadSanitized = true;
#else
constexpr bool kThreadSanitized = false;
#endif

/// Whether a few cases stand for the many that show a law: with a sanitizer, which sees in a few what it would see in
/// all, and with PALPATE_BRIEF, which `./check` sets and `./check --all` does not.
inline bool brief() { return kSanitized || std::getenv("PALPATE_BRIEF") != nullptr; }

}  // namespace palpate::test
