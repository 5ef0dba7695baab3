// What the raw files of the studies have in common.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/product_rate.h"
#include "isosyrk/iteration/status.h"
#include "isosyrk/catalogue/integrator_list.h"

namespace isosyrk {

/// The conditions of measurement, default ħ and modes.
nlohmann::ordered_json context_json(const std::string& program, BackendChoice products,
                                    const std::vector<BackendRates>& rates,
                                    const SolverOptions& options);

/// What an integrator is.
nlohmann::ordered_json integrator_json(const IntegratorEntry& entry);

}  // namespace isosyrk
