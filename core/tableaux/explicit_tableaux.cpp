#include "isosyrk/tableaux/explicit_tableaux.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace isosyrk {
namespace {

// A coefficient of stage j, counted from 0.
struct Entry {
  Index j;
  double value;
};
using Row = std::vector<Entry>;

// The coefficients that are not 0: a_ij for i = 1 ... s - 1, and b_j.
struct Coefficients {
  std::vector<Row> a;
  Row b;
};

Tableau tableau_of(const char* name, int order, const Coefficients& given) {
  const Index s = static_cast<Index>(given.a.size()) + 1;
  Tableau tableau{
      .name = name, .order = order, .a = RealMatrix::Zero(s, s), .b = RealVector::Zero(s), .c = {}};
  for (Index i = 1; i < s; ++i) {
    for (const Entry& entry : given.a[static_cast<std::size_t>(i - 1)])
      tableau.a(i, entry.j) = entry.value;
  }
  for (const Entry& entry : given.b) tableau.b(entry.j) = entry.value;
  tableau.c = tableau.a.rowwise().sum();
  return tableau;
}

}  // namespace

const ExplicitScheme& classical_runge_kutta4() {
  static const ExplicitScheme scheme{
      tableau_of("rk4", 4,
                 {{
                      {{0, 1.0 / 2.0}},
                      {{1, 1.0 / 2.0}},
                      {{2, 1.0}},
                  },
                  {{0, 1.0 / 6.0}, {1, 1.0 / 3.0}, {2, 1.0 / 3.0}, {3, 1.0 / 6.0}}}),
      2.0 * std::sqrt(2.0)};
  return scheme;
}

Complex stability_function(const Tableau& tableau, double y) {
  const Complex z(0.0, y);
  Eigen::VectorXcd k(tableau.stages());  // of w' = iy w, times h, with w = 1
  Complex step = 1.0;
  for (Index i = 0; i < tableau.b.size(); ++i) {
    Complex w = 1.0;
    for (Index j = 0; j < i; ++j) w += tableau.a(i, j) * k(j);
    k(i) = z * w;
    step += tableau.b(i) * k(i);
  }
  return step;
}

void require_explicit(const Tableau& tableau) {
  require_consistent(tableau);
  for (Index i = 0; i < tableau.b.size(); ++i) {
    for (Index j = i; j < tableau.b.size(); ++j) {
      if (tableau.a(i, j) != 0.0) {
        throw std::invalid_argument(fmt::format(
            "tableau {}: a({}, {}) must be 0 in an explicit method", tableau.name, i + 1, j + 1));
      }
    }
  }
}

MuntheKaasScheme munthe_kaas4() {
  return {.tableau = classical_runge_kutta4().tableau,
          .commutators = {{.stage = 2, .left = 0, .right = 1, .weight = -1.0 / 8.0},
                          {.stage = 4, .left = 0, .right = 3, .weight = -1.0 / 12.0}}};
}

}  // namespace isosyrk
