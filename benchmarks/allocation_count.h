// Counting allocations.  A program that links this has its malloc replaced by one that counts;
// where AddressSanitizer has replaced it already, its hooks count instead.
#pragma once

#include <functional>

namespace isosyrk {

/// Allocations made while `action` ran, by malloc and all that allocates like it.
long allocations_during(const std::function<void()>& action);

/// Bytes that this program has allocated and not freed.
long bytes_in_use();

}  // namespace isosyrk
