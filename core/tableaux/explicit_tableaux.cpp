#include "isosyrk/tableaux/explicit_tableaux.h"

namespace isosyrk {

Tableau classical_runge_kutta4() {
  Tableau tableau;
  tableau.name = "rk4";
  tableau.order = 4;
  tableau.a = RealMatrix::Zero(4, 4);
  tableau.a(1, 0) = 1.0 / 2.0;
  tableau.a(2, 1) = 1.0 / 2.0;
  tableau.a(3, 2) = 1.0;
  tableau.b = RealVector(4);
  tableau.b << 1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0;
  tableau.c = tableau.a.rowwise().sum();
  return tableau;
}

MuntheKaasScheme munthe_kaas4() {
  return {.tableau = classical_runge_kutta4(),
          .commutators = {{.stage = 2, .left = 0, .right = 1, .weight = -1.0 / 8.0},
                          {.stage = 4, .left = 0, .right = 3, .weight = -1.0 / 12.0}}};
}

}  // namespace isosyrk
