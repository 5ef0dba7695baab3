#include "isosyrk/fast/split_exponential.h"

#include <array>
#include <cmath>
#include <utility>

#include "isosyrk/split/congruence.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// A series of degree m in X is used for ‖Ω‖ up to `norm`: the first term left out is then 1e-18.
// A tail of 1e-16 would be a bias: the spectrum would err by 2e-13 after 8000 steps.
struct Series {
  double norm;
  int m;  // degree
  int q;  // block
};
constexpr std::array<Series, 8> all_series = {{{0.07, 4, 2},
                                               {0.31, 6, 3},
                                               {0.75, 8, 4},
                                               {1.35, 10, 5},
                                               {2.1, 12, 4},
                                               {3.5, 15, 5},
                                               {5.0, 18, 6},
                                               {6.7, 21, 7}}};
constexpr int most_powers = 7;

double factorial(int k) { return std::tgamma(static_cast<double>(k + 1)); }

// The coefficient of X^j in C (odd = 0) or S (odd = 1).
double coefficient(int j, int odd) { return 1.0 / factorial(2 * j + odd); }

void add_to_diagonal(SplitMatrix& X, double number) {
  for (Index i = 0; i < X.size(); ++i) X.re()[i * X.stride() + i] += number;
}

}  // namespace

SplitExponential::SplitExponential(Index n)
    : powers_(most_powers, SplitMatrix(n)),
      cosine_(n),
      sine_(n),
      Omega_sine_(n),
      adjoint_(n),
      scratch_(n) {}

// out = Σ_j c_j X^j, j = 0 ... m, by Horner in Y = X^q.
void SplitExponential::form_polynomial(SplitMatrix& out, int odd, int m, int q,
                                       SplitProducts& products) {
  const auto power = [&](int j) -> const SplitMatrix& {
    return powers_[static_cast<std::size_t>(j - 1)];
  };
  int block = m / q - 1;  // the top block also has the term of X^(block q + q)
  const auto add_block = [&](SplitMatrix& to, bool starts, int terms) {
    LinearCombination<double> sum_of_block;
    if (!starts) sum_of_block += to;
    for (int j = 1; j < terms; ++j) sum_of_block += coefficient(block * q + j, odd) * power(j);
    to = sum_of_block;
    add_to_diagonal(to, coefficient(block * q, odd));
  };
  add_block(out, true, m - block * q + 1);
  while (block-- > 0) {
    products.form(into(scratch_, out * power(q)).upper_triangle());
    mirror_all_hermitian(scratch_);
    std::swap(out, scratch_);
    add_block(out, false, q);
  }
}

bool SplitExponential::conjugate(SplitMatrix& W1, const SplitMatrix& Omega, const SplitMatrix& W0,
                                 SplitProducts& products) {
  const auto form_power = [&](std::size_t j, const SplitMatrix& A, const SplitMatrix& B) {
    products.form(into(powers_[j - 1], A * B).upper_triangle());
    mirror_all_hermitian(powers_[j - 1]);
  };
  form_power(1, Omega, Omega);
  form_power(2, powers_[0], powers_[0]);
  // ‖Ω‖₂ <= ‖Ω⁴‖_F^{1/4}.
  const double norm = std::sqrt(std::sqrt(std::sqrt(powers_[1].entries().squaredNorm())));
  const Series* series = all_series.begin();
  while (series != all_series.end() && !(norm <= series->norm)) ++series;  // NaN included
  if (series == all_series.end()) return false;
  for (int j = 3; j <= series->q; ++j) {
    const auto half = static_cast<std::size_t>(j / 2);
    const auto rest = static_cast<std::size_t>(j) - half;
    form_power(static_cast<std::size_t>(j), powers_[half - 1], powers_[rest - 1]);
  }
  form_polynomial(cosine_, 0, series->m, series->q, products);
  form_polynomial(sine_, 1, series->m, series->q, products);
  products.form(into(Omega_sine_, Omega * sine_).upper_triangle());
  mirror_all_skew(Omega_sine_);
  adjoint_ = cosine_ - Omega_sine_;
  congruence(W1, scratch_, products, adjoint_, W0);
  return true;
}

}  // namespace isosyrk
