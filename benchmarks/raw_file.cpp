#include "benchmarks/raw_file.h"

#include "benchmarks/conditions.h"

namespace isosyrk {

nlohmann::ordered_json context_json(const std::string& program, BackendChoice products,
                                    const std::vector<BackendRates>& rates,
                                    const SolverOptions& options) {
  nlohmann::ordered_json json;
  const auto add = [&json](const Conditions& conditions) {
    for (const auto& [key, value] : conditions) json[key] = value;
  };
  add(machine_conditions(program, products, rates));
  add(solver_conditions(options, HbarConvention::paper, default_modes()));
  return json;
}

nlohmann::ordered_json integrator_json(const IntegratorEntry& entry) {
  return {{"name", entry.name},
          {"stages", entry.stages},
          {"order", entry.order},
          {"isospectral", entry.keeps.isospectral},
          {"lie_poisson", entry.keeps.lie_poisson},
          {"symmetric", entry.keeps.symmetric},
          {"explicit", entry.keeps.is_explicit}};
}

}  // namespace isosyrk
