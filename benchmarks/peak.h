// The floating point peak of one core, and whether two threads have two cores, measured.
#pragma once

namespace isosyrk {

/// Floating point operations per second of one core in fused multiply-adds on doubles, held in
/// registers, as wide as this program was compiled for: the best of several short runs.
double measured_peak_flops();

/// The same in one run of some tenths of a millisecond: at the speed that the core has now.
double peak_flops_now();

/// How many cores' worth of multiply-adds two threads do at once, by the time that passes: 2 where
/// each has a core of its own; 1 where they have one between them, be it that the host of a virtual
/// machine runs two of its processors on one core for the moment, which nothing else here tells.
/// The median of a few short runs against one thread before each, some milliseconds in all.
double cores_at_once();

/// What it was compiled for: "AVX-512", "AVX2 with FMA" or "baseline".
const char* compiled_vector_units();

}  // namespace isosyrk
