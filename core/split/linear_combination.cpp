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
  // The sum of `length` numbers from i on.  Each multiplication but the first is fused with its
  // addition, where the processor can do that, as written here: left to the compiler, w₀x₀ + w₁x₁
  // is rounded otherwise in one loop than in another, and a state would depend on which of them the
  // former band of its storage chose.  Hence Eigen's packets, and not its arrays.
  template <int length>
  Eigen::Array<Real, length, 1> at(Index i) const {
    using Packet = typename Eigen::internal::packet_traits<Real>::type;
    constexpr int numbers_of_packet = Eigen::internal::packet_traits<Real>::size;
    static_assert(length % numbers_of_packet == 0);
    Eigen::Array<Real, length, 1> sum;
    const std::size_t end = count();
#pragma GCC unroll 16
    for (int k = 0; k < length; k += numbers_of_packet) {
      const auto term = [&](std::size_t t) {
        return Eigen::internal::ploadu<Packet>(numbers[t] + i + k);
      };
      Packet of_packet = Eigen::internal::pmul(Eigen::internal::pset1<Packet>(weights[0]), term(0));
#pragma GCC unroll 6
      for (std::size_t t = 1; t < end; ++t) {
        of_packet =
            Eigen::internal::pmadd(Eigen::internal::pset1<Packet>(weights[t]), term(t), of_packet);
      }
      Eigen::internal::pstoreu(sum.data() + k, of_packet);
    }
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

// Numbers in 64 bytes, of which real and imaginary parts of rows hold a whole number.
template <class Real>
constexpr int line_length = 64 / sizeof(Real);

// Columns begin ... end - 1.
struct Columns {
  Index begin;
  Index end;
};
// Returns the columns of a row within a band, and those between them and whole multiples of
// `length`.
Columns columns_within(Index n, Index row, Index band, Index length) {
  return {std::max<Index>(0, row - band) / length * length,
          (std::min(n, row + band + 1) + length - 1) / length * length};
}

// Calls body(begin, end) for ranges of consecutive numbers that hold all entries of the rows within
// a band: one range for a full band, or two for each row, of whole lines.
template <class Real, class Body>
void for_ranges_within(Index n, Index band, parallel::Rows rows, Body&& body) {
  const Index part = split_row<Real>(n);
  if (band >= n - 1) return body(2 * part * rows.begin, 2 * part * rows.end);
  for (Index r = rows.begin; r < rows.end; ++r) {
    const Columns columns = columns_within(n, r, band, line_length<Real>);
    for (const Index at : {2 * part * r, 2 * part * r + part}) {
      body(at + columns.begin, at + columns.end);
    }
  }
}

// Calls body(i, k) for pieces of eight consecutive numbers that hold all entries of the rows within
// a band: at i in double, at k in single precision.  Rows of the two precisions are padded
// differently.
constexpr int mixed_length = 8;
using Singles = Eigen::Array<float, mixed_length, 1>;
using Doubles = Eigen::Array<double, mixed_length, 1>;
template <class Body>
void for_mixed_pieces(Index n, Index band, parallel::Rows rows, Body&& body) {
  const Index part = split_row<double>(n);
  const Index single_part = split_row<float>(n);
  if (band >= n - 1) {
    const Index columns = std::min(part, single_part);
    for (Index p = 2 * rows.begin; p < 2 * rows.end; ++p) {
      for (Index c = 0; c < columns; c += mixed_length) body(p * part + c, p * single_part + c);
    }
    return;
  }
  for (Index r = rows.begin; r < rows.end; ++r) {
    const Columns columns = columns_within(n, r, band, mixed_length);
    for (Index p = 2 * r; p < 2 * r + 2; ++p) {
      for (Index c = columns.begin; c < columns.end; c += mixed_length) {
        body(p * part + c, p * single_part + c);
      }
    }
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
void assign_rows_within(SplitMatrixOf<Real>& out, Index band, const LinearCombination<Real>& sum,
                        parallel::Rows rows) {
  constexpr int length = line_length<Real>;
  using Line = Eigen::Array<Real, length, 1>;
  with_terms(sum, [&](const auto& terms) {
    Real* const to = out.entries().data();
    for_ranges_within<Real>(out.size(), band, rows, [&](Index begin, Index end) {
      for (Index i = begin; i < end; i += length) {
        Line::Map(to + i) = terms.template at<length>(i);
      }
    });
  });
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
  const Index band = std::max(sum.band(), X.band());
  if (rows.begin == 0) R.set_band(band);
  if (band < R.size() - 1) {
    const Index stride = R.stride();
    R.entries().segment(stride * rows.begin, stride * (rows.end - rows.begin)).setZero();
  }
  return with_terms(sum, [&](const auto& terms) {
    Doubles total = Doubles::Zero();
    const double* const from = X.entries().data();
    float* const to = R.entries().data();
    for_mixed_pieces(X.size(), band, rows, [&](Index i, Index k) {
      const Doubles change = terms.template at<mixed_length>(i) - view<mixed_length>(from + i);
      total += change.square();
      Singles::Map(to + k) = change.cast<float>();
    });
    return total.sum();
  });
}

template <class Real>
double squares_of_rows(const SplitMatrixOf<Real>& X, parallel::Rows rows) {
  double squares = 0.0;
  for_ranges_within<Real>(X.size(), X.band(), rows, [&](Index begin, Index end) {
    squares += static_cast<double>(X.entries().segment(begin, end - begin).squaredNorm());
  });
  return squares;
}

template void assign_rows(SplitMatrix&, const LinearCombination<double>&, parallel::Rows);
template void assign_rows(SingleMatrix&, const LinearCombination<float>&, parallel::Rows);
template void assign_rows_within(SplitMatrix&, Index, const LinearCombination<double>&,
                                 parallel::Rows);
template void assign_rows_within(SingleMatrix&, Index, const LinearCombination<float>&,
                                 parallel::Rows);
template double change_rows(SplitMatrix&, const LinearCombination<double>&, parallel::Rows);
template double change_rows(SingleMatrix&, const LinearCombination<float>&, parallel::Rows);
template double squares_of_rows(const SplitMatrix&, parallel::Rows);
template double squares_of_rows(const SingleMatrix&, parallel::Rows);

}  // namespace linear_combination

namespace {

// S = X within a band.
void round_rows(SingleMatrix& S, Index band, const SplitMatrix& X, parallel::Rows rows) {
  for_mixed_pieces(X.size(), band, rows, [&](Index at, Index single_at) {
    Singles::Map(S.entries().data() + single_at) =
        view<mixed_length>(X.entries().data() + at).cast<float>();
  });
}

// X = S within a band.
void widen_rows(SplitMatrix& X, Index band, const SingleMatrix& S, parallel::Rows rows) {
  for_mixed_pieces(X.size(), band, rows, [&](Index at, Index single_at) {
    Doubles::Map(X.entries().data() + at) =
        view<mixed_length>(S.entries().data() + single_at).cast<double>();
  });
}

void add_rows(SplitMatrix& X, const SingleMatrix& S, double weight, parallel::Rows rows) {
  for_mixed_pieces(X.size(), S.band(), rows, [&](Index at, Index single_at) {
    Doubles::Map(X.entries().data() + at) +=
        weight * view<mixed_length>(S.entries().data() + single_at).cast<double>();
  });
  if (rows.begin == 0) X.set_band(std::max(X.band(), S.band()));
}

}  // namespace

void round_to_single(SingleStages& S, const SplitStages& X) {
  if (X.empty()) return;
  parallel::for_each_block(X.size(), X[0].size(), [&](std::size_t i, parallel::Rows rows, Index) {
    round_rows(S[i], X[i].size() - 1, X[i], rows);
    if (rows.begin == 0) S[i].set_band(X[i].band());
  });
}

void round_to_single(SingleMatrix& S, const SplitMatrix& X) {
  const Index band = std::max(S.band(), X.band());
  parallel::for_each_block(
      1, X.size(), [&](std::size_t, parallel::Rows rows, Index) { round_rows(S, band, X, rows); });
  S.set_band(X.band());
}

void widen(SplitMatrix& X, const SingleMatrix& S) {
  const Index band = std::max(X.band(), S.band());
  parallel::for_each_block(
      1, X.size(), [&](std::size_t, parallel::Rows rows, Index) { widen_rows(X, band, S, rows); });
  X.set_band(S.band());
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

namespace {

// add_upper in some rows, with `count` other sums.
template <std::size_t count, class Sum, class Term>
void add_upper_rows(Addition<double> first, std::span<const Addition<Sum>> others,
                    const SplitMatrixOf<Term>& term, parallel::Rows rows) {
  const Index n = term.size();
  std::array<Sum*, count> to;
  std::array<Sum, count> weights;
  for (std::size_t i = 0; i < count; ++i) {
    to[i] = others[i].sum->entries().data();
    weights[i] = static_cast<Sum>(others[i].weight);
  }
  using Sums = Eigen::Array<Sum, mixed_length, 1>;
  double* const to_first = first.sum->entries().data();
  for (Index r = rows.begin; r < rows.end; ++r) {
    const Index begin = r / mixed_length * mixed_length;
    const Index end = std::min(n, r + term.band() + 1);
    for (const Index part : {2 * r, 2 * r + 1}) {
      const Term* const from = term.entries().data() + part * split_row<Term>(n);
      for (Index c = begin; c < end; c += mixed_length) {
        const auto numbers = view<mixed_length>(from + c);
        Doubles::Map(to_first + part * split_row<double>(n) + c) +=
            first.weight * numbers.template cast<double>();
        const Sums converted = numbers.template cast<Sum>();
        for (std::size_t i = 0; i < count; ++i) {
          Sums::Map(to[i] + part * split_row<Sum>(n) + c) += weights[i] * converted;
        }
      }
    }
  }
}

}  // namespace

template <class Sum, class Term>
void add_upper(Addition<double> first, std::span<const Addition<Sum>> others,
               const SplitMatrixOf<Term>& term) {
  parallel::for_each_block(1, term.size(), [&](std::size_t, parallel::Rows rows, Index) {
    switch (others.size()) {
      case 0:
        return add_upper_rows<0>(first, others, term, rows);
      case 1:
        return add_upper_rows<1>(first, others, term, rows);
      case 2:
        return add_upper_rows<2>(first, others, term, rows);
      default:
        return add_upper_rows<3>(first, others, term, rows);
    }
  });
  first.sum->set_band(std::max(first.sum->band(), term.band()));
  for (const Addition<Sum>& each : others) {
    each.sum->set_band(std::max(each.sum->band(), term.band()));
  }
}

template void add_upper(Addition<double>, std::span<const Addition<float>>, const SplitMatrix&);
template void add_upper(Addition<double>, std::span<const Addition<float>>, const SingleMatrix&);
template void add_upper(Addition<double>, std::span<const Addition<double>>, const SplitMatrix&);

void add_identity(SingleStages& X, float scale) {
  for (SingleMatrix& each : X) {
    for (Index i = 0; i < each.size(); ++i) each.re()[i * each.stride() + i] += scale;
  }
}

}  // namespace isosyrk
