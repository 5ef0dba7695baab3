#include "isosyrk/fast/stage_system.h"

namespace isosyrk {

std::vector<Attempt> StageSystem::attempts(bool newton) const {
  if (newton) {
    return {{Start::predicted, Iteration::newton},
            {Start::cold, Iteration::newton},
            {Start::cold, Iteration::frozen_picard},
            {Start::cold, Iteration::anderson}};
  }
  return {{Start::predicted, Iteration::picard},
          {Start::cold, Iteration::picard},
          {Start::cold, Iteration::anderson}};
}

}  // namespace isosyrk
