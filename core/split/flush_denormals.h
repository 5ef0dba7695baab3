// Denormal numbers as 0 for a while.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace isosyrk {

/// While one lives, this thread treats denormal numbers as 0, or as numbers; then as it did before.
/// Only x86 is told; on others this does nothing.
class DenormalMode {
 public:
  DenormalMode(const DenormalMode&) = delete;
  DenormalMode& operator=(const DenormalMode&) = delete;

#if defined(__SSE2__)
  explicit DenormalMode(bool flush) : before_(_mm_getcsr() & both) { set(flush ? both : 0); }
  ~DenormalMode() { set(before_); }

 private:
  static constexpr unsigned both = 0x8040;  // "flush to zero" and "denormals are zero"
  static void set(unsigned bits) { _mm_setcsr((_mm_getcsr() & ~both) | bits); }

  unsigned before_;
#else
  explicit DenormalMode(bool) {}
  ~DenormalMode() {}
#endif
};

/// While one lives, this thread reads denormal numbers as 0 and writes 0 for them.
///
/// Corrections in single precision fall off away from the diagonal, past 1e-38 and so to nothing
/// that counts, but some processors take over a hundred cycles for each such number: a step at
/// n = 129 then takes three to five times as long.
class FlushDenormals : DenormalMode {
 public:
  FlushDenormals() : DenormalMode(true) {}
};

}  // namespace isosyrk
