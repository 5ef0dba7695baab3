// Time that the host of a virtual machine gave to others while a processor here had work.
#pragma once

#include <istream>

namespace isosyrk {

/// Seconds stolen since the machine started, summed over all its processors; 0 where /proc/stat
/// does not tell.  Counted in ticks of 10 ms.  Source: proc(5), "steal".
double stolen_seconds();

/// The same from the text of /proc/stat, which counts `ticks` in a second.
double stolen_seconds(std::istream& stat, double ticks);

}  // namespace isosyrk
