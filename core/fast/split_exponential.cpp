#include "isosyrk/fast/split_exponential.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "isosyrk/split/congruence.h"
#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// A series of degree m in X, in blocks of q.
struct Series {
  int m;
  int q;
};
constexpr std::array<Series, 8> all_series = {
    {{4, 2}, {6, 3}, {8, 4}, {10, 5}, {12, 4}, {15, 5}, {18, 6}, {21, 7}}};
// At this ‖Ω‖₂ the first term that the longest series leaves out is 1e-18.
constexpr double largest_norm = 6.7;
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

// Returns the shortest series of which the first term left out is at most `tail` at this ‖Ω‖₂, or
// `none`, as for NaN.
const Series* const none = all_series.data() + all_series.size();
const Series* series_for(double size, double tail) {
  if (!(size <= largest_norm)) return none;
  const auto suffices = [&](const Series& series) {
    return std::pow(size, 2 * series.m + 2) * coefficient(series.m + 1, 0) <= tail;
  };
  const Series* last = none - 1;  // suffices at largest_norm
  return std::find_if(all_series.data(), last, suffices);
}

void add_to_diagonal(SplitMatrix& X, double number) {
  for (Index i = 0; i < X.size(); ++i) X.re()[i * X.stride() + i] += number;
}

// What a cut may change in e^Ω, and, times ‖W₀‖, in W₁, to rounding.  A tail of 1e-16 would be a
// bias: the spectrum would err by 2e-13 after 8000 steps.
constexpr double exact_left_out = 1e-18;
// The same where U is made unitary, as a part of the error: there are about ten cuts.
constexpr double part_left_out = 0.1;
// Largest error of A: E² is then a few 1e-18.
constexpr double largest_error = 3e-9;
// Where U is made unitary: from this error on, and up to this band of Ω, as a part of n.  At 0.2 to
// 0.4 (n = 129, smooth, 1e-8) steps of elp4 and elp6 take about 5 % less time, at 0.5 to 0.7 (n =
// 65) about 3 %.  Of a full Ω it counts as many products as e^Ω to rounding.
constexpr double smallest_error = 1e-12;
constexpr double widest_band = 0.75;
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
      scratch_(n),
      defect_(n),
      V_(n),
      EV_(n),
      repair_(n),
      adjoint_single_(n) {}

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
  bands_.truncate_symmetric(result, left_out_ / coefficient(j, 0));
  mirror_all_hermitian(result);
}

// C = Σ_j X^j / (2j)! and S = Σ_j X^j / (2j+1)!, j = 0 ... m, by Horner in Y = X^q.
void SplitExponential::form_polynomials(int m, int q, double size, SplitProducts& products) {
  const double least = std::max(negligible, 0.01 * left_out_);
  const auto add_block = [&](SplitMatrix& to, int odd, int block, int terms, bool is_top) {
    LinearCombination<double> sum_of_block;
    if (!is_top) sum_of_block += to;
    for (int j = 1; j < terms; ++j) {
      const int k = block * q + j;
      const double rest = rest_of_coefficient(k, odd);
      if (std::abs(rest) * std::pow(size, k) > least) sum_of_block += rest * power(j);
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
    const double allowed = left_out_ / std::pow(std::max(1.0, size), block * q);
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

// Sets A to e^(-Ω) = C - ΩS.  Returns false if Ω is too large.
bool SplitExponential::form_adjoint(SplitMatrix& A, const SplitMatrix& Omega,
                                    SplitProducts& products) {
  form_power(1, Omega, Omega, products);
  form_power(2, power(1), power(1), products);
  // ‖Ω‖₂ <= ‖Ω⁴‖_F^{1/4}.
  const double size = std::sqrt(std::sqrt(norm(power(2))));
  // Allowed in each eigenvalue of e^Ω.  An allowed error is a Frobenius norm, of n of them.
  const double tail = left_out_ > exact_left_out
                          ? left_out_ / std::sqrt(static_cast<double>(Omega.size()))
                          : exact_left_out;
  const Series* series = series_for(size, tail);
  if (series == none) return false;
  for (int formed = 2; formed < series->q; ++formed) {
    const int half = (formed + 1) / 2;
    form_power(formed + 1, power(half), power(formed + 1 - half), products);
  }
  form_polynomials(series->m, series->q, size * size, products);
  bands_.truncate_symmetric(sine_, left_out_ / std::max(1.0, size));
  products.form(into(Omega_sine_, Omega * sine_).upper_triangle());
  mirror_all_skew(Omega_sine_);
  A = cosine_ - Omega_sine_;
  bands_.truncate(A, left_out_);
  return true;
}

// W1 = V - (EV + VE) / 2, where W1 holds V.
void SplitExponential::make_unitary(SplitMatrix& W1, const SplitMatrix& A, SplitProducts& products,
                                    SingleProducts& single_products) {
  products.form(into(scratch_, adjoint(A) * A).upper_triangle());
  add_to_diagonal(scratch_, -1.0);
  round_to_single(defect_, scratch_);
  mirror_all_hermitian(defect_);
  round_to_single(V_, W1);
  single_products.form(into(EV_, defect_ * V_));
  skew_part(repair_, EV_, -0.5);
  add(W1, repair_);
}

bool SplitExponential::conjugate(SplitMatrix& W1, SplitMatrix& adjoint, const SplitMatrix& Omega,
                                 const SplitMatrix& W0, double error, SplitProducts& products,
                                 SingleProducts& single_products) {
  const auto band = static_cast<double>(Omega.band());
  const bool is_made_unitary =
      error >= smallest_error && band <= widest_band * static_cast<double>(Omega.size());
  left_out_ = is_made_unitary ? part_left_out * std::min(error, largest_error) : exact_left_out;
  if (!form_adjoint(adjoint, Omega, products)) return false;
  congruence(W1, scratch_, products, adjoint, cut_copy(cut_, W0, exact_left_out * norm(W0)));
  if (is_made_unitary) make_unitary(W1, adjoint, products, single_products);
  return true;
}

void SplitExponential::transport(SingleMatrix& out, const SplitMatrix& adjoint,
                                 const SingleMatrix& X, SingleProducts& single_products) {
  round_to_single(adjoint_single_, adjoint);
  congruence(out, EV_, single_products, adjoint_single_, X);
}

}  // namespace isosyrk
