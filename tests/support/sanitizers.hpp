// SPDX-License-Identifier: MIT
// What a test leaves out where a sanitizer makes it ten times slower, or replaces what it looks at.
#pragma once

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

}  // namespace palpate::test
