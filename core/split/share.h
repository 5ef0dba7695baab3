// A share of a piece of work.
#pragma once

#include <cstddef>

namespace isosyrk {

/// A share of the work on a matrix that two threads do: the whole, or a half from the top, `part` 0
/// or 1 of 2 `parts`.  Each entry is formed as in the whole, so that halves put together are the
/// whole bit for bit.
struct Share {
  std::ptrdiff_t part = 0;
  std::ptrdiff_t parts = 1;

  bool is_first() const { return part == 0; }
};

/// Calls half(share) for each half of the whole that a share is: one, or two of the whole itself.
/// For sums, which add up their halves whoever forms them.
template <class OfHalf>
void for_halves(Share share, OfHalf&& half) {
  if (share.parts == 2) return half(share);
  half(Share{0, 2});
  half(Share{1, 2});
}

}  // namespace isosyrk
