#include "isosyrk/split/linear_combination.h"

#include <algorithm>

namespace isosyrk {
namespace linear_combination {
namespace {

// Rows of both precisions consist of whole pieces of 128 bytes, since the real and the imaginary
// part are each padded to a multiple of 64 bytes.
template <class Real>
constexpr int piece_length = 128 / sizeof(Real);
template <class Real>
using Piece = Eigen::Array<Real, piece_length<Real>, 1>;

template <int length, class Real>
auto view(const Real* at) {
  return Eigen::Map<const Eigen::Array<Real, length, 1>>(at);
}

// A sum of `count` terms, with `count` a constant.  The terms are copied, so that the compiler
// knows that no store changes them and unrolls the sum.
template <std::size_t count, class Real>
struct Unrolled {
  explicit Unrolled(const LinearCombination<Real>& sum) {
    for (std::size_t t = 0; t < count; ++t) {
      weights[t] = sum.weight(t);
      numbers[t] = sum.term(t).entries().data();
    }
  }
  template <int length>
  Eigen::Array<Real, length, 1> at(Index i) const {
    Eigen::Array<Real, length, 1> sum = weights[0] * view<length>(numbers[0] + i);
#pragma GCC unroll 6
    for (std::size_t t = 1; t < count; ++t) sum += weights[t] * view<length>(numbers[t] + i);
    return sum;
  }

  std::array<Real, count> weights;
  std::array<const Real*, count> numbers;
};

// A sum of any number of terms, formed in a loop.
template <class Real>
struct Looped {
  explicit Looped(const LinearCombination<Real>& sum) : count(sum.count()) {
    for (std::size_t t = 0; t < count; ++t) {
      weights[t] = sum.weight(t);
      numbers[t] = sum.term(t).entries().data();
    }
  }
  template <int length>
  Eigen::Array<Real, length, 1> at(Index i) const {
    Eigen::Array<Real, length, 1> sum = weights[0] * view<length>(numbers[0] + i);
    for (std::size_t t = 1; t < count; ++t) sum += weights[t] * view<length>(numbers[t] + i);
    return sum;
  }

  std::size_t count;
  std::array<Real, LinearCombination<Real>::most> weights;  // the first `count`
  std::array<const Real*, LinearCombination<Real>::most> numbers;
};

// Calls use(terms), unrolled for up to six terms: enough for three stages.
template <class Real, class Use>
auto with_terms(const LinearCombination<Real>& sum, Use&& use) {
  switch (sum.count()) {
    case 1:
      return use(Unrolled<1, Real>(sum));
    case 2:
      return use(Unrolled<2, Real>(sum));
    case 3:
      return use(Unrolled<3, Real>(sum));
    case 4:
      return use(Unrolled<4, Real>(sum));
    case 5:
      return use(Unrolled<5, Real>(sum));
    case 6:
      return use(Unrolled<6, Real>(sum));
    default:
      return use(Looped<Real>(sum));
  }
}

// Calls body(i, k) for each piece of eight consecutive numbers in the rows: at i in double, at k in
// single precision.  Rows of the two precisions are padded differently.
constexpr int mixed_length = 8;
template <class Body>
void for_mixed_pieces(Index n, parallel::Rows rows, Body&& body) {
  const Index row = split_row<double>(n);
  const Index single_row = split_row<float>(n);
  const Index columns = std::min(row, single_row);
  for (Index part = 2 * rows.begin; part < 2 * rows.end; ++part) {
    for (Index c = 0; c < columns; c += mixed_length) body(part * row + c, part * single_row + c);
  }
}

}  // namespace

template <class Real>
void assign_rows(const LinearCombination<Real>& sum, parallel::Rows rows,
                 SplitMatrixOf<Real>& out) {
  constexpr int length = piece_length<Real>;
  with_terms(sum, [&](const auto& terms) {
    Real* const to = out.entries().data();
    const Index end = out.stride() * rows.end;
    for (Index i = out.stride() * rows.begin; i < end; i += length) {
      Eigen::Map<Piece<Real>>(to + i) = terms.template at<length>(i);
    }
  });
  if (rows.begin == 0) out.set_band(sum.band());
}

template <class Real>
double change_rows(const LinearCombination<Real>& sum, parallel::Rows rows,
                   SplitMatrixOf<Real>& out) {
  constexpr int length = piece_length<Real>;
  const double squares = with_terms(sum, [&](const auto& terms) {
    Piece<Real> total = Piece<Real>::Zero();
    Real* const to = out.entries().data();
    const Index end = out.stride() * rows.end;
    for (Index i = out.stride() * rows.begin; i < end; i += length) {
      const Piece<Real> fresh = terms.template at<length>(i);
      total += (fresh - view<length>(to + i)).square();
      Eigen::Map<Piece<Real>>(to + i) = fresh;
    }
    return static_cast<double>(total.sum());
  });
  if (rows.begin == 0) out.set_band(sum.band());
  return squares;
}

double residual_rows(const LinearCombination<double>& sum, const SplitMatrix& X,
                     parallel::Rows rows, SingleMatrix& R) {
  if (rows.begin == 0) R.set_band(std::max(sum.band(), X.band()));
  return with_terms(sum, [&](const auto& terms) {
    using Doubles = Eigen::Array<double, mixed_length, 1>;
    Doubles total = Doubles::Zero();
    const double* const from = X.entries().data();
    float* const to = R.entries().data();
    for_mixed_pieces(X.size(), rows, [&](Index i, Index k) {
      const Doubles change = terms.template at<mixed_length>(i) - view<mixed_length>(from + i);
      total += change.square();
      Eigen::Map<Eigen::Array<float, mixed_length, 1>>(to + k) = change.template cast<float>();
    });
    return total.sum();
  });
}

template <class Real>
double squares_of_rows(const SplitMatrixOf<Real>& X, parallel::Rows rows) {
  const Index begin = X.stride() * rows.begin;
  return static_cast<double>(
      X.entries().segment(begin, X.stride() * rows.end - begin).squaredNorm());
}

void round_rows(const SplitMatrix& X, parallel::Rows rows, SingleMatrix& S) {
  for_mixed_pieces(X.size(), rows, [&](Index i, Index k) {
    Eigen::Map<Eigen::Array<float, mixed_length, 1>>(S.entries().data() + k) =
        view<mixed_length>(X.entries().data() + i).cast<float>();
  });
  if (rows.begin == 0) S.set_band(X.band());
}

void add_rows(const SingleMatrix& S, parallel::Rows rows, SplitMatrix& X) {
  for_mixed_pieces(X.size(), rows, [&](Index i, Index k) {
    Eigen::Map<Eigen::Array<double, mixed_length, 1>>(X.entries().data() + i) +=
        view<mixed_length>(S.entries().data() + k).cast<double>();
  });
  if (rows.begin == 0) X.set_band(std::max(X.band(), S.band()));
}

template void assign_rows(const LinearCombination<double>&, parallel::Rows, SplitMatrix&);
template void assign_rows(const LinearCombination<float>&, parallel::Rows, SingleMatrix&);
template double change_rows(const LinearCombination<double>&, parallel::Rows, SplitMatrix&);
template double change_rows(const LinearCombination<float>&, parallel::Rows, SingleMatrix&);
template double squares_of_rows(const SplitMatrix&, parallel::Rows);
template double squares_of_rows(const SingleMatrix&, parallel::Rows);

}  // namespace linear_combination

void round_to_single(const SplitStages& X, SingleStages& S) {
  if (X.empty()) return;
  parallel::for_each_block(X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows, Index) {
    linear_combination::round_rows(X[i], rows, S[i]);
  });
}

void add(const SingleStages& S, SplitStages& X) {
  if (X.empty()) return;
  parallel::for_each_block(X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows, Index) {
    linear_combination::add_rows(S[i], rows, X[i]);
  });
}

void add_identity(float scale, SingleStages& X) {
  for (SingleMatrix& each : X) {
    for (Index i = 0; i < each.size(); ++i) each.re()[i * each.stride() + i] += scale;
  }
}

}  // namespace isosyrk
