#include "isosyrk/split/split_sums.h"

namespace isosyrk {

template void update_unknowns(const PlanarMatrix&, double, const RealMatrix&,
                              const std::vector<PlanarMatrix>&, std::vector<PlanarMatrix>&, double*,
                              Index, Index);
template void update_unknowns(const std::vector<SingleMatrix>&, double, const RealMatrix&,
                              const std::vector<SingleMatrix>&, std::vector<SingleMatrix>&, double*,
                              Index, Index);
template double update_unknown(const PlanarMatrix&, double, const RealMatrix&, Index,
                               const std::vector<PlanarMatrix>&, PlanarMatrix&, Share);
template double update_unknown(const std::vector<SingleMatrix>&, double, const RealMatrix&, Index,
                               const std::vector<SingleMatrix>&, SingleMatrix&, Share);

}  // namespace isosyrk
