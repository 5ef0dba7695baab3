#include "isosyrk/fast/split_system.h"

#include <cmath>
#include <utility>

#include "isosyrk/solver/tuning.h"

namespace isosyrk {
namespace {

Unknowns unknowns_of(const std::vector<Index>& kinds, Index n) {
  Unknowns x;
  for (const Index count : kinds) x.push_back(split_stages(count, n));
  return x;
}

const Tableau& consistent(const Tableau& tableau) {
  require_consistent(tableau);
  return tableau;
}

}  // namespace

SplitSystem::SplitSystem(const Flow& flow, std::vector<Index> kinds, Index stages, int threads,
                         bool truncates, const CouplingBand& coupling_band)
    : products_(flow.size(), threads),
      single_products_(flow.size(), threads),
      generator_(flow),
      bands_(truncates, stages, flow.size()),
      kinds_(std::move(kinds)),
      least_coupling_band_(generator_.least_coupling_band(coupling_band)),
      correction_(unknowns_of(kinds_, flow.size())) {}

Unknowns SplitSystem::unknowns() const { return unknowns_of(kinds_, products_.size()); }

void SplitSystem::bind(const SplitMatrix& W0, double h, double tolerance, StepMemory&) {
  W0_ = &W0;
  h_ = h;
  left_out_ = tuning.left_out * tolerance;
}

RungeKuttaSystem::RungeKuttaSystem(const Flow& flow, const Tableau& tableau,
                                   std::vector<Index> kinds, int threads, bool truncates,
                                   const CouplingBand& coupling_band)
    : SplitSystem(flow, std::move(kinds), consistent(tableau).stages(), threads, truncates,
                  coupling_band),
      s_(tableau.stages()),
      tableau_(tableau) {}

}  // namespace isosyrk
