// Denormal numbers as 0 for a while.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace isosyrk {

/// While one lives, this thread reads denormal numbers as 0 and writes 0 for them; then it does
/// what it did before.
///
/// Corrections in single precision fall off away from the diagonal, past 1e-38 and so to nothing
/// that counts, but some processors take over a hundred cycles for each such number: a step at
/// n = 129 then takes three to five times as long (measured).  Only x86 is told; on others this does
/// nothing.
class FlushDenormals {
 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

#if defined(__SSE2__)
  FlushDenormals() : before_(_mm_getcsr() & both) { _mm_setcsr(_mm_getcsr() | both); }
  ~FlushDenormals() { _mm_setcsr((_mm_getcsr() & ~both) | before_); }

 private:
  static constexpr unsigned both = 0x8040;  // "flush to zero" and "denormals are zero"
  unsigned before_;
#else
  FlushDenormals() {}
  ~FlushDenormals() {}
#endif
};

}  // namespace isosyrk
