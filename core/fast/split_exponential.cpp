#include "isosyrk/fast/split_exponential.h"

#include <algorithm>
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

// The coefficient of X^j in C (odd = 0) or S (odd = 1).
long double exact_coefficient(int j, int odd) {
  long double factorial = 1.0L;
  for (int k = 2; k <= 2 * j + odd; ++k) factorial *= static_cast<long double>(k);
  return 1.0L / factorial;
}
double coefficient(int j, int odd) { return static_cast<double>(exact_coefficient(j, odd)); }
// What is lost when it is rounded to double, and added by itself.  Otherwise each eigenvalue of Ω
// would be turned by a factor whose modulus is not 1 by the same 1e-17 in every step: the spectrum
// erred by 2e-13 after 4000 steps of h‖B‖ = 2.5 (smooth, n = 33), and errs by 2e-14.
double rest_of_coefficient(int j, int odd) {
  return static_cast<double>(exact_coefficient(j, odd) - coefficient(j, odd));
}

// Returns the shortest series for this ‖Ω‖, or the end if there is none, as for NaN.
const Series* series_for(double size) {
  const Series* series = all_series.begin();
  while (series != all_series.end() && !(size <= series->norm)) ++series;
  return series;
}

void add_to_diagonal(SplitMatrix& X, double number) {
  for (Index i = 0; i < X.size(); ++i) X.re()[i * X.stride() + i] += number;
}

// What a cut may change in e^Ω, and, times ‖W₀‖, in W₁.
constexpr double left_out = 1e-18;
// Largest term of a polynomial that is not added: of the coefficients' rests most are smaller.  At
// 0 steps take 3 to 5 % more time at n = 129, smooth, and the same spectrum.
constexpr double negligible = 1e-20;

}  // namespace

SplitExponential::SplitExponential(Index n, BandTruncation& bands)
    : bands_(bands),
      powers_(most_powers, SplitMatrix(n)),
      cosine_(n),
      sine_(n),
      cut_(n),
      Omega_sine_(n),
      adjoint_(n),
      scratch_(n) {}

const SplitMatrix& SplitExponential::cut_copy(SplitMatrix& copy, const SplitMatrix& X,
                                              double tail) {
  if (!bands_.enabled()) return X;
  copy = 1.0 * X;
  bands_.truncate_symmetric(copy, tail);
  return copy;
}

// X^j = A B, cut to what shows in its term X^j / (2j)!.
void SplitExponential::form_power(int j, const SplitMatrix& A, const SplitMatrix& B,
                                  SplitProducts& products) {
  SplitMatrix& result = powers_[static_cast<std::size_t>(j - 1)];
  products.form(into(result, A * B).upper_triangle());
  mirror_all_hermitian(result);
  bands_.truncate_symmetric(result, left_out / coefficient(j, 0));
}

// C = Σ_j X^j / (2j)! and S = Σ_j X^j / (2j+1)!, j = 0 ... m, by Horner in Y = X^q.
void SplitExponential::form_polynomials(int m, int q, double size, SplitProducts& products) {
  const auto add_block = [&](SplitMatrix& to, int odd, int block, int terms, bool is_top) {
    LinearCombination<double> sum_of_block;
    if (!is_top) sum_of_block += to;
    for (int j = 1; j < terms; ++j) {
      const int k = block * q + j;
      const double rest = rest_of_coefficient(k, odd);
      if (std::abs(rest) * std::pow(size, k) > negligible) sum_of_block += rest * power(j);
    }
    for (int j = 1; j < terms; ++j) sum_of_block += coefficient(block * q + j, odd) * power(j);
    to = sum_of_block;
    add_to_diagonal(to, coefficient(block * q, odd));
  };
  int block = m / q - 1;  // the top block also has the term of X^(block q + q)
  for (const int odd : {0, 1}) {
    add_block(odd == 0 ? cosine_ : sine_, odd, block, m - block * q + 1, true);
  }
  while (block-- > 0) {
    // The sum of the blocks so far, about 1/(2(block + 1)q)!, is multiplied by Y here, and the
    // result by Y^block later.
    const double allowed = left_out / std::pow(std::max(1.0, size), block * q);
    const SplitMatrix& Y = cut_copy(cut_, power(q), allowed / coefficient((block + 1) * q, 0));
    for (const int odd : {0, 1}) {
      SplitMatrix& sum_so_far = odd == 0 ? cosine_ : sine_;
      bands_.truncate_symmetric(sum_so_far, allowed / std::pow(std::max(1.0, size), q));
      products.form(into(scratch_, sum_so_far * Y).upper_triangle());
      mirror_all_hermitian(scratch_);
      std::swap(sum_so_far, scratch_);
      add_block(sum_so_far, odd, block, q, false);
    }
  }
}

bool SplitExponential::conjugate(SplitMatrix& W1, const SplitMatrix& Omega, const SplitMatrix& W0,
                                 SplitProducts& products) {
  form_power(1, Omega, Omega, products);
  form_power(2, power(1), power(1), products);
  // ‖Ω‖₂ <= ‖Ω⁴‖_F^{1/4}.
  double size = std::sqrt(std::sqrt(norm(power(2))));
  const Series* series = series_for(size);
  if (series == all_series.end()) return false;
  int formed = 2;
  const auto form_powers = [&](int last) {
    for (; formed < last; ++formed) {
      const int half = (formed + 1) / 2;
      form_power(formed + 1, power(half), power(formed + 1 - half), products);
    }
  };
  // The eighth root is nearer to ‖Ω‖₂, and may save a product or two.
  if (series->q >= 4) {
    form_powers(4);
    size = std::min(size, std::sqrt(std::sqrt(std::sqrt(norm(power(4))))));
    series = series_for(size);
  }
  form_powers(series->q);
  form_polynomials(series->m, series->q, size * size, products);
  bands_.truncate_symmetric(sine_, left_out / std::max(1.0, size));
  products.form(into(Omega_sine_, Omega * sine_).upper_triangle());
  mirror_all_skew(Omega_sine_);
  adjoint_ = cosine_ - Omega_sine_;
  bands_.truncate(adjoint_, left_out);
  congruence(W1, scratch_, products, adjoint_, cut_copy(cut_, W0, left_out * norm(W0)));
  return true;
}

}  // namespace isosyrk
