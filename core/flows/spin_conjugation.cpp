#include "isosyrk/flows/spin_conjugation.h"

#include <fmt/format.h>
#include <lapacke.h>

#include <numbers>
#include <stdexcept>

#include "isosyrk/flows/spin.h"
#include "isosyrk/linalg/power_of_two.h"
#include "isosyrk/split/congruence.h"

namespace isosyrk {

SpinRotation SpinRotation::after(const SpinRotation& first) const {
  return {a * first.a - b * std::conj(first.b), a * first.b + b * std::conj(first.a)};
}

SpinRotation SpinRotation::normalized() const {
  const double norm = std::hypot(std::abs(a), std::abs(b));
  return {a / norm, b / norm};
}

namespace {

constexpr double root_half = 1.0 / std::numbers::sqrt2;

// Of a pair i < n-1-i the even combination is (x_i + x_{n-1-i}) / √2.  For odd n the middle is its
// own partner: the even combination is x_i = (x_i + x_i) / 2, and the odd one is 0.
bool is_middle(Index n, Index i) { return n - 1 - i == i; }
double weight_of_even(Index n, Index i) { return is_middle(n, i) ? 0.5 : root_half; }
// x_i and x_{n-1-i} are this times the sum and the difference of the even and the odd combination.
double weight_of_sum(Index n, Index i) { return is_middle(n, i) ? 1.0 : root_half; }

Complex entry(const SplitMatrix& X, Index r, Index c) {
  const Index at = r * X.stride() + c;
  return {X.re()[at], X.im()[at]};
}
void set_entry(SplitMatrix& X, Index r, Index c, Complex value) {
  const Index at = r * X.stride() + c;
  X.re()[at] = value.real();
  X.im()[at] = value.imag();
}

}  // namespace

SpinConjugation::SpinConjugation(Index n, int threads)
    : n_(n),
      half_((n + 1) / 2),
      threads_(threads),
      products_(half_, threads),
      even_(parity(n, true)),
      odd_(parity(n, false)),
      mixed_(half_),
      product_(half_),
      factor_(half_),
      phases_(n) {}

// S_x is tridiagonal, with half the ladder beside the diagonal, and symmetric under the reversal.
// Its last even and odd combinations are coupled through the middle.
SpinConjugation::Parity SpinConjugation::parity(Index n, bool even) {
  const Spin spin(n);
  const Index half = (n + 1) / 2;
  const Index count = even ? half : n - half;
  Parity result = {.eigenvectors = RealMatrix::Zero(half, half),
                   .eigenvalues = RealVector::Zero(half),
                   .rotation = SplitMatrix(half),
                   .block = SplitMatrix(half)};
  if (count == 0) return result;
  RealVector beside = RealVector::Zero(count);
  for (Index i = 0; i + 1 < count; ++i) {
    const double of_middle = is_middle(n, i + 1) ? std::numbers::sqrt2 : 1.0;
    beside(i) = 0.5 * spin.ladder(i) * of_middle;
  }
  if (n % 2 == 0) result.eigenvalues(count - 1) = (even ? 0.5 : -0.5) * spin.ladder(half - 1);
  const auto size = static_cast<lapack_int>(count);
  const lapack_int info =
      LAPACKE_dstevd(LAPACK_COL_MAJOR, 'V', size, result.eigenvalues.data(), beside.data(),
                     result.eigenvectors.data(), static_cast<lapack_int>(half));
  if (info != 0) throw std::runtime_error(fmt::format("eigenvectors of S_x: failed ({})", info));
  for (Index k = 0; k < count; ++k) {  // exactly
    result.eigenvalues(k) = std::round(result.eigenvalues(k) + spin.j) - spin.j;
  }
  return result;
}

// E e^{iβk} Eᵀ, as (e^{-iβk} Eᵀ)† Eᵀ: columns of E are rows of the factors.
void SpinConjugation::set_rotation(Parity& parity, double beta) {
  SplitMatrix& turned = product_;
  turned.set_band(half_ - 1);
  factor_.set_band(half_ - 1);
  parallel::for_each_block(1, half_, [&](std::size_t, parallel::Rows rows, Index) {
    for (Index k = rows.begin; k < rows.end; ++k) {
      const Complex phase = std::polar(1.0, -beta * parity.eigenvalues(k));
      const auto row = [&](double* part) {
        return RealVector::Map(part + k * factor_.stride(), half_);
      };
      row(factor_.re()) = parity.eigenvectors.col(k);
      row(factor_.im()).setZero();
      row(turned.re()) = phase.real() * parity.eigenvectors.col(k);
      row(turned.im()) = phase.imag() * parity.eigenvectors.col(k);
    }
  });
  products_.form(into(parity.rotation, adjoint(turned) * factor_));
}

// Sets the phases of e^{-i angle S_z}.
void SpinConjugation::set_phases(double angle) {
  const Spin spin(n_);
  for (Index i = 0; i < n_; ++i) phases_(i) = std::polar(1.0, -angle * spin.magnetic(i));
}

// Sets the blocks of V, turned around S_z by the phases.
void SpinConjugation::combine(const Matrix& V) {
  for (SplitMatrix* block : {&even_.block, &odd_.block, &mixed_}) block->set_band(half_ - 1);
  parallel::for_each_block(1, half_, [&](std::size_t, parallel::Rows rows, Index) {
    for (Index i = rows.begin; i < rows.end; ++i) {
      const Index i2 = n_ - 1 - i;
      const double of_row = weight_of_even(n_, i);
      for (Index k = 0; k < half_; ++k) {
        const Index k2 = n_ - 1 - k;
        const auto turned = [&](Index r, Index c) {
          return phases_(r) * std::conj(phases_(c)) * (V(r, c) / unit_);
        };
        const Complex straight = turned(i, k), reversed = turned(i2, k2);
        const Complex across = turned(i, k2), back = turned(i2, k);
        const double of_column = weight_of_even(n_, k);
        set_entry(even_.block, i, k,
                  of_row * of_column * ((straight + reversed) + (across + back)));
        set_entry(odd_.block, i, k, 0.5 * ((straight + reversed) - (across + back)));
        set_entry(mixed_, i, k, of_row * root_half * ((straight - reversed) - (across - back)));
      }
    }
  });
}

// Sets W from its blocks, turned around S_z by the phases.  Each entry is written with its mirror
// image.
void SpinConjugation::separate(MatrixView W) const {
  const auto put = [&](Index r, Index c, Complex value) {
    value *= unit_;
    W(r, c) = r == c ? Complex(0.0, value.imag()) : value;
    W(c, r) = -std::conj(W(r, c));
  };
  parallel::for_each_block(1, half_, [&](std::size_t, parallel::Rows rows, Index) {
    for (Index i = rows.begin; i < rows.end; ++i) {
      const Index i2 = n_ - 1 - i;
      const Complex of_i = phases_(i), of_i2 = phases_(i2);
      for (Index k = i; k < half_; ++k) {
        const Index k2 = n_ - 1 - k;
        const Complex of_k = std::conj(phases_(k)), of_k2 = std::conj(phases_(k2));
        const Complex same = entry(even_.block, i, k) + entry(odd_.block, i, k);
        const Complex unlike = entry(even_.block, i, k) - entry(odd_.block, i, k);
        const Complex of_even_row = entry(mixed_, i, k);
        const Complex of_odd_row = -std::conj(entry(mixed_, k, i));
        const double weight = weight_of_sum(n_, i) * weight_of_sum(n_, k);
        put(i, k, weight * (same + (of_even_row + of_odd_row)) * (of_i * of_k));
        put(i2, k2, weight * (same - (of_even_row + of_odd_row)) * (of_i2 * of_k2));
        put(i, k2, weight * (unlike - (of_even_row - of_odd_row)) * (of_i * of_k2));
        put(i2, k, weight * (unlike + (of_even_row - of_odd_row)) * (of_i2 * of_k));
      }
    }
  });
}

void SpinConjugation::conjugate(const SpinRotation& U, const Matrix& V, MatrixView W) {
  if (U.a == 1.0 && U.b == 0.0) {
    W = V;
    return;
  }
  // The angles, from those of spin 1/2.
  const double beta = 2.0 * std::atan2(std::abs(U.b), std::abs(U.a));
  const double sum = -std::arg(U.a);
  const double difference = -std::arg(-U.b);
  // b = 0 leaves the difference of the angles free.
  constexpr double quarter = 0.5 * std::numbers::pi;
  const double alpha = sum + difference + quarter;
  const double gamma = sum - difference - quarter;
  // Numbers near the least would be flushed to 0 on the way.
  unit_ = std::ldexp(1.0, exponent_of_largest(V));
  on_threads(threads_, [&] {
    set_phases(gamma);
    combine(V);
    for (Parity* parity : {&even_, &odd_}) {
      set_rotation(*parity, beta);
      congruence(parity->block, product_, products_, parity->rotation, parity->block);
    }
    products_.form(into(product_, mixed_ * odd_.rotation));
    products_.form(into(mixed_, adjoint(even_.rotation) * product_));
    set_phases(alpha);
    separate(W);
  });
}

}  // namespace isosyrk
