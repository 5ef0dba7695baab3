// Scoped control of how a thread treats denormal numbers.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace isosyrk {

/// Sets, for its lifetime, whether this thread treats denormal numbers as 0, read or written, or as
/// numbers.  The destructor restores the mode before.  Does nothing on processors other than x86.
///
/// Corrections in single precision decay away from the diagonal to below 1e-38.  Numbers that small
/// do not affect the result, but some processors take over a hundred cycles for each of them.
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

}  // namespace isosyrk
