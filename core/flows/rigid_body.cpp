#include "isosyrk/flows/rigid_body.h"

namespace isosyrk {

MatrixOf<double> manakov_inertia(const RealVector& d) {
  const Index n = d.size();
  return (d.replicate(1, n) + d.transpose().replicate(n, 1)).cwiseInverse();
}

}  // namespace isosyrk
