// The floating point peak of one core, measured.
#pragma once

namespace isosyrk {

/// Floating point operations per second of one core in fused multiply-adds on doubles, held in
/// registers, as wide as the processor has them: the best of several short runs.
double measured_peak_flops();

/// The same in one run of some tenths of a millisecond: at the speed that the core has now.
double peak_flops_now();

/// What the program was compiled for: "AVX-512", "AVX2 with FMA" or "baseline".
const char* compiled_vector_units();

}  // namespace isosyrk
