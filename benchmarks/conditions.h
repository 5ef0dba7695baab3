// The conditions of a measurement, recorded with every raw file.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "benchmarks/product_rate.h"
#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/iteration/iteration_options.h"
#include "isosyrk/scenes/modes.h"

namespace isosyrk {

/// Facts by their names.
using Conditions = std::map<std::string, std::string>;

/// What holds for any program: version, commit, compiler, processor, BLAS and the kernels it really
/// picked, the kernels of split products, environment, measured peak and the product rates given.
Conditions machine_conditions(const std::string& program, BackendChoice choice,
                              const std::vector<BackendRates>& rates);

/// How the equations were solved: tolerance, norm, start, order of updates, ħ, modes.
Conditions solver_conditions(const IterationOptions& options, HbarConvention convention,
                             const std::vector<Mode>& modes);

/// Which kernels round here, in one line: those that OpenBLAS really picked, those of split
/// products, and the vector unit that all other code is compiled for.
std::string kernel_sets();

/// Why the timings may not be what this machine can do (kernels below its vector units, an
/// inherited OPENBLAS_CORETYPE, an unoptimised build), or empty.
std::string notice();

}  // namespace isosyrk
