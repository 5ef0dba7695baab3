#include "benchmarks/integrator_json.h"

namespace isosyrk {

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
