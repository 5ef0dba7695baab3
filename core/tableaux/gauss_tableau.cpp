#include "isosyrk/tableaux/gauss_tableau.h"

#include <fmt/format.h>

#include <numbers>
#include <stdexcept>
#include <vector>

namespace isosyrk {
namespace {

// Coefficients are computed in extended precision and rounded to double once.
using Extended = long double;

struct LegendreValue {
  Extended value;
  Extended derivative;
};

// Returns P_s(x) and P_s'(x) for x in (-1, 1), by the three-term recurrence.
LegendreValue legendre(int s, Extended x) {
  Extended previous = 1;
  Extended current = x;
  for (int k = 2; k <= s; ++k) {
    const Extended next =
        (static_cast<Extended>(2 * k - 1) * x * current - static_cast<Extended>(k - 1) * previous) /
        static_cast<Extended>(k);
    previous = current;
    current = next;
  }
  const Extended order = static_cast<Extended>(s);
  return {current, order * (x * current - previous) / (x * x - 1)};
}

// Returns the zeros of P_s, ascending, by Newton's method from the classical cosine estimate.
std::vector<Extended> legendre_zeros(int s) {
  std::vector<Extended> zeros(static_cast<std::size_t>(s));
  for (int i = 0; i < s; ++i) {
    Extended x = -std::cos(std::numbers::pi_v<Extended> * (static_cast<Extended>(i) + 0.75L) /
                           (static_cast<Extended>(s) + 0.5L));
    for (int iteration = 0; iteration < 10; ++iteration) {
      const LegendreValue p = legendre(s, x);
      x -= p.value / p.derivative;
    }
    zeros[static_cast<std::size_t>(i)] = x;
  }
  if (s % 2 == 1) zeros[static_cast<std::size_t>(s / 2)] = 0;
  return zeros;
}

// Returns the value at x of the j-th Lagrange polynomial on the given nodes.
Extended lagrange(const std::vector<Extended>& nodes, std::size_t j, Extended x) {
  Extended product = 1;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (k != j) product *= (x - nodes[k]) / (nodes[j] - nodes[k]);
  }
  return product;
}

}  // namespace

Tableau gauss_tableau(int s) {
  if (s < 1 || s > max_stages) {
    throw std::invalid_argument(
        fmt::format("gauss_tableau: s = {}, must be 1 to {}", s, max_stages));
  }
  const std::vector<Extended> zeros = legendre_zeros(s);
  const auto size = static_cast<std::size_t>(s);
  std::vector<Extended> c(size);
  std::vector<Extended> b(size);
  for (std::size_t i = 0; i < size; ++i) {
    const Extended derivative = s == 1 ? 1 : legendre(s, zeros[i]).derivative;
    c[i] = (1 + zeros[i]) / 2;
    b[i] = 1 / ((1 - zeros[i] * zeros[i]) * derivative * derivative);
  }
  Tableau tableau{fmt::format("gauss{}", s), 2 * s, RealMatrix(s, s), RealVector(s), RealVector(s)};
  for (std::size_t i = 0; i < size; ++i) {
    const auto row = static_cast<Index>(i);
    tableau.b(row) = static_cast<double>(b[i]);
    tableau.c(row) = static_cast<double>(c[i]);
    for (std::size_t j = 0; j < size; ++j) {
      // The quadrature mapped to [0, c_i] is exact for the Lagrange polynomial of degree s - 1.
      Extended integral = 0;
      for (std::size_t k = 0; k < size; ++k) integral += b[k] * lagrange(c, j, c[i] * c[k]);
      tableau.a(row, static_cast<Index>(j)) = static_cast<double>(c[i] * integral);
    }
  }
  return tableau;
}

}  // namespace isosyrk
