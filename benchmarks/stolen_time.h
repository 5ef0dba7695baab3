// Time that the host of a virtual machine gave to others while a processor here had work.
#pragma once

#include <istream>
#include <vector>

namespace isosyrk {

/// What a processor did since the machine started, in seconds, counted in ticks of 10 ms.
struct ProcessorTime {
  double worked = 0;  ///< for whatever program, or for the system
  double stolen = 0;  ///< had work, but the host let others run
};

/// The times of each processor, in order; empty where /proc/stat does not tell.  Source: proc(5).
std::vector<ProcessorTime> processor_times();

/// The same from the text of /proc/stat, which counts `ticks` in a second.
std::vector<ProcessorTime> processor_times(std::istream& stat, double ticks);

/// Seconds stolen between two readings from the `count` processors that worked most in between; 0
/// where there are none.  Others count for nothing: a processor that sleeps is woken now and then,
/// and most of what such a moment takes on a busy host is waiting for the host.
double stolen_seconds(const std::vector<ProcessorTime>& before,
                      const std::vector<ProcessorTime>& after, int count);

}  // namespace isosyrk
