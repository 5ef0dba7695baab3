#include "isosyrk/tableaux/tableau.h"

#include <fmt/format.h>

#include <stdexcept>

namespace isosyrk {

double symplecticity_defect(const Tableau& tableau) {
  const RealMatrix ba = tableau.b.asDiagonal() * tableau.a;
  return (ba + ba.transpose() - tableau.b * tableau.b.transpose()).cwiseAbs().maxCoeff();
}

void require_consistent(const Tableau& tableau) {
  const Index s = tableau.b.size();
  if (s < 1 || s > max_stages || tableau.a.rows() != s || tableau.a.cols() != s ||
      tableau.c.size() != s) {
    throw std::invalid_argument(fmt::format(
        "tableau {}: a is {} x {}, b has {} and c {} entries; must be s x s, s and s "
        "with s = 1..{}",
        tableau.name, tableau.a.rows(), tableau.a.cols(), s, tableau.c.size(), max_stages));
  }
  if (!tableau.a.allFinite() || !tableau.b.allFinite() || !tableau.c.allFinite()) {
    throw std::invalid_argument(
        fmt::format("tableau {}: every coefficient must be finite", tableau.name));
  }
}

}  // namespace isosyrk
