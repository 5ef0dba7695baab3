#include "isosyrk/split/linear_combination.h"

#include <algorithm>

namespace isosyrk {
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

// The terms of a sum, copied so that the compiler knows that no store changes them.  If their count
// is a constant, `fixed`, it unrolls the sum; if `fixed` is 0, it forms any sum in a loop.
template <std::size_t fixed, class Real>
struct Terms {
  explicit Terms(const LinearCombination<Real>& sum) : any_count(sum.count()) {
    for (std::size_t t = 0; t < count(); ++t) {
      weights[t] = sum.weight(t);
      numbers[t] = sum.term(t).entries().data();
    }
  }
  std::size_t count() const { return fixed > 0 ? fixed : any_count; }
  template <int length>
  Eigen::Array<Real, length, 1> at(Index i) const {
    Eigen::Array<Real, length, 1> sum = weights[0] * view<length>(numbers[0] + i);
    const std::size_t end = count();
#pragma GCC unroll 6
    for (std::size_t t = 1; t < end; ++t) sum += weights[t] * view<length>(numbers[t] + i);
    return sum;
  }

  static constexpr std::size_t most = fixed > 0 ? fixed : LinearCombination<Real>::most;
  std::size_t any_count;
  std::array<Real, most> weights;  // the first count()
  std::array<const Real*, most> numbers;
};

// Calls use(terms), unrolled for up to six terms: enough for three stages.
template <class Real, class Use>
auto with_terms(const LinearCombination<Real>& sum, Use&& use) {
  switch (sum.count()) {
    case 1:
      return use(Terms<1, Real>(sum));
    case 2:
      return use(Terms<2, Real>(sum));
    case 3:
      return use(Terms<3, Real>(sum));
    case 4:
      return use(Terms<4, Real>(sum));
    case 5:
      return use(Terms<5, Real>(sum));
    case 6:
      return use(Terms<6, Real>(sum));
    default:
      return use(Terms<0, Real>(sum));
  }
}

// Calls body(i, k) for each piece of eight consecutive numbers in the rows: at i in double, at k in
// single precision.  Rows of the two precisions are padded differently.
constexpr int mixed_length = 8;
using Singles = Eigen::Array<float, mixed_length, 1>;
using Doubles = Eigen::Array<double, mixed_length, 1>;
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

namespace linear_combination {

template <class Real>
void assign_rows(SplitMatrixOf<Real>& out, const LinearCombination<Real>& sum,
                 parallel::Rows rows) {
  constexpr int length = piece_length<Real>;
  with_terms(sum, [&](const auto& terms) {
    Real* const to = out.entries().data();
    const Index end = out.stride() * rows.end;
    for (Index i = out.stride() * rows.begin; i < end; i += length) {
      Piece<Real>::Map(to + i) = terms.template at<length>(i);
    }
  });
  if (rows.begin == 0) out.set_band(sum.band());
}

template <class Real>
double change_rows(SplitMatrixOf<Real>& out, const LinearCombination<Real>& sum,
                   parallel::Rows rows) {
  constexpr int length = piece_length<Real>;
  const double squares = with_terms(sum, [&](const auto& terms) {
    Piece<Real> total = Piece<Real>::Zero();
    Real* const to = out.entries().data();
    const Index end = out.stride() * rows.end;
    for (Index i = out.stride() * rows.begin; i < end; i += length) {
      const Piece<Real> fresh = terms.template at<length>(i);
      total += (fresh - view<length>(to + i)).square();
      Piece<Real>::Map(to + i) = fresh;
    }
    return static_cast<double>(total.sum());
  });
  if (rows.begin == 0) out.set_band(sum.band());
  return squares;
}

double residual_rows(SingleMatrix& R, const LinearCombination<double>& sum, const SplitMatrix& X,
                     parallel::Rows rows) {
  if (rows.begin == 0) R.set_band(std::max(sum.band(), X.band()));
  return with_terms(sum, [&](const auto& terms) {
    Doubles total = Doubles::Zero();
    const double* const from = X.entries().data();
    float* const to = R.entries().data();
    for_mixed_pieces(X.size(), rows, [&](Index i, Index k) {
      const Doubles change = terms.template at<mixed_length>(i) - view<mixed_length>(from + i);
      total += change.square();
      Singles::Map(to + k) = change.cast<float>();
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

template void assign_rows(SplitMatrix&, const LinearCombination<double>&, parallel::Rows);
template void assign_rows(SingleMatrix&, const LinearCombination<float>&, parallel::Rows);
template double change_rows(SplitMatrix&, const LinearCombination<double>&, parallel::Rows);
template double change_rows(SingleMatrix&, const LinearCombination<float>&, parallel::Rows);
template double squares_of_rows(const SplitMatrix&, parallel::Rows);
template double squares_of_rows(const SingleMatrix&, parallel::Rows);

}  // namespace linear_combination

namespace {

void round_rows(SingleMatrix& S, const SplitMatrix& X, parallel::Rows rows) {
  for_mixed_pieces(X.size(), rows, [&](Index at, Index single_at) {
    Singles::Map(S.entries().data() + single_at) =
        view<mixed_length>(X.entries().data() + at).cast<float>();
  });
  if (rows.begin == 0) S.set_band(X.band());
}

void add_rows(SplitMatrix& X, const SingleMatrix& S, double weight, parallel::Rows rows) {
  for_mixed_pieces(X.size(), rows, [&](Index at, Index single_at) {
    Doubles::Map(X.entries().data() + at) +=
        weight * view<mixed_length>(S.entries().data() + single_at).cast<double>();
  });
  if (rows.begin == 0) X.set_band(std::max(X.band(), S.band()));
}

}  // namespace

void round_to_single(SingleStages& S, const SplitStages& X) {
  if (X.empty()) return;
  parallel::for_each_block(X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows, Index) {
    round_rows(S[i], X[i], rows);
  });
}

void round_to_single(SingleMatrix& S, const SplitMatrix& X) {
  parallel::for_each_block(
      1, X.size(), [&](std::size_t, parallel::Rows rows, Index) { round_rows(S, X, rows); });
}

void widen(SplitMatrix& X, const SingleMatrix& S) {
  X.entries().setZero();
  X.set_band(0);
  add(X, S);
}

void add(SplitStages& X, const SingleStages& S) {
  if (X.empty()) return;
  parallel::for_each_block(X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows, Index) {
    add_rows(X[i], S[i], 1.0, rows);
  });
}

void add(SplitMatrix& X, const SingleMatrix& S, double weight) {
  parallel::for_each_block(
      1, X.size(), [&](std::size_t, parallel::Rows rows, Index) { add_rows(X, S, weight, rows); });
}

void add_identity(SingleStages& X, float scale) {
  for (SingleMatrix& each : X) {
    for (Index i = 0; i < each.size(); ++i) each.re()[i * each.stride() + i] += scale;
  }
}

}  // namespace isosyrk
