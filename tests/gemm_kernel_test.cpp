// The kernel interface itself: products of banded factors, in ranges of their parts, against those
// of the whole, bit for bit.
#include "isosyrk/split/gemm_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "isosyrk/split/bands.h"
#include "tests/support.h"

namespace isosyrk::testing {
namespace {

// Which entries are nonzero or needed.
struct Shape {
  bool adjoint;
  bool upper;
  Index A_band;
  Index B_band;
  Index C_band;

  bool needs(Index r, Index c) const { return std::abs(r - c) <= C_band && !(upper && r > c); }

  // Of the rows before `end` of n.
  Index multiplications(Index n, Index end) const {
    Index sum = 0;
    for (Index r = 0; r < end; ++r) {
      for (Index c = 0; c < n; ++c) {
        if (!needs(r, c)) continue;
        const Index first = std::max({Index{0}, r - A_band, c - B_band});
        const Index last = std::min({n - 1, r + A_band, c + B_band});
        sum += std::max(Index{0}, last + 1 - first);
      }
    }
    return sum;
  }
};

std::vector<Shape> shapes(Index n) {
  const Index full = n - 1;
  std::vector<Shape> all;
  for (const bool adjoint : {false, true}) {
    for (const bool upper : {false, true}) {
      for (const auto& [A, B, C] : std::vector<std::array<Index, 3>>{{full, full, full},
                                                                     {n / 3, n / 2, full},
                                                                     {n / 4, full, n / 3},
                                                                     {n / 6, full, full},
                                                                     {full, n / 6, full},
                                                                     {0, 0, full},
                                                                     {0, full, n / 4},
                                                                     {full, 2, full},
                                                                     {4, 7, n / 4},
                                                                     {n - 2, 1, full}}) {
        all.push_back({adjoint, upper, A, B, C});
      }
    }
  }
  return all;
}

constexpr Share whole = {0, 1, 1};
constexpr std::array<Share, 3> ranges = {{{0, 1, 6}, {1, 3, 6}, {3, 6, 6}}};

// Forms this share of C = -0.3 A B or -0.3 A† B in this shape.
template <class Real>
void multiply(const GemmKernel& kernel, const Shape& shape, Share share,
              const SplitMatrixOf<Real>& A, const SplitMatrixOf<Real>& B, SplitMatrixOf<Real>& C) {
  constexpr bool is_single = sizeof(Real) == sizeof(float);
  const Index n = A.size();
  const PackingLimits limits = is_single ? kernel.single_limits : kernel.limits;
  const bool packs_B = n > limits.B;
  std::vector<Real> scratch(static_cast<std::size_t>(gemm_scratch(n, A.stride(), packs_B)),
                            std::numeric_limits<Real>::quiet_NaN());
  const SplitProduct<Real> product = {.n = n,
                                      .stride = A.stride(),
                                      .A_re = A.re(),
                                      .A_im = A.im(),
                                      .adjoint = shape.adjoint,
                                      .B_re = B.re(),
                                      .B_im = B.im(),
                                      .scale = static_cast<Real>(-0.3),
                                      .C_re = C.re(),
                                      .C_im = C.im(),
                                      .upper = shape.upper,
                                      .A_band = shape.A_band,
                                      .B_band = shape.B_band,
                                      .C_band = shape.C_band,
                                      .first_part = share.first,
                                      .end_part = share.end,
                                      .parts = share.parts,
                                      .packs_B = packs_B,
                                      .packs_adjoint_A = n > limits.adjoint_A,
                                      .scratch = scratch.data()};
  if constexpr (is_single) {
    kernel.multiply_singles(product);
  } else {
    kernel.multiply(product);
  }
}

// Not a number in every entry; the padding is 0.
template <class Real>
SplitMatrixOf<Real> unformed(Index n) {
  const double nan = std::nan("");
  return SplitMatrixOf<Real>(Matrix(Matrix::Constant(n, n, Complex(nan, nan))));
}

// The rows next ... end - 1 that a range forms are its share of the work.  Tiles are formed whole,
// and what of them is not wanted takes time too: it is little of wide bands of a large matrix.
void expect_share_of_the_work(const Shape& shape, const Share& share, Index n, Index begin,
                              Index end) {
  const auto part = [&](Index count) {
    return static_cast<double>(count) / static_cast<double>(share.parts);
  };
  const Index narrowest = std::min({shape.A_band, shape.B_band, shape.C_band});
  if (n == 129 && narrowest >= n / 6) {
    const auto above = static_cast<double>(shape.multiplications(n, end));
    EXPECT_NEAR(above / static_cast<double>(shape.multiplications(n, n)), part(share.end), 0.1);
  }
  const bool rows_cost_the_same = !shape.upper && shape.A_band == n - 1;
  if (n > 16 && rows_cost_the_same) {
    EXPECT_NEAR(static_cast<double>(end - begin),
                part(share.end - share.first) * static_cast<double>(n), 1.0);
  }
}

template <class Real>
void expect_ranges_of_the_whole(const GemmKernel& kernel, Index n, const Shape& shape) {
  SplitMatrixOf<Real> A(random_matrix(n, 1)), B(random_matrix(n, 2));
  cut_to_band(shape.A_band, A);
  cut_to_band(shape.B_band, B);
  const Shape all = {shape.adjoint, false, n - 1, n - 1, n - 1};
  auto expected = unformed<Real>(n);
  multiply(kernel, all, whole, A, B, expected);
  const auto is_needed = [&](Index r, Index c) { return shape.needs(r, c); };
  const Matrix wanted = entries_of(expected.interleaved(), is_needed);
  Index begin = 0;
  for (const Share& share : ranges) {
    auto C = unformed<Real>(n);
    multiply(kernel, shape, share, A, B, C);
    const Matrix found = entries_of(C.interleaved(), is_needed);
    // Every shape needs the diagonal.
    const auto is_formed = [&](Index r) { return !std::isnan(found(r, r).real()); };
    Index end = begin;
    while (end < n && is_formed(end)) ++end;
    for (Index r = 0; r < n; ++r) {
      EXPECT_EQ(is_formed(r), begin <= r && r < end) << r;
      EXPECT_EQ(found.row(r) == wanted.row(r), is_formed(r)) << r;
    }
    expect_share_of_the_work(shape, share, n, begin, end);
    begin = end;
  }
  EXPECT_EQ(begin, n);
}

class EachKernel : public ::testing::TestWithParam<GemmKernel> {};

// What bands leave out is 0 times something.
TEST_P(EachKernel, FormsEachRowInOneRangeOfItsShareOfTheWorkAsInTheWholeProduct) {
  for (const Index n : {4, 17, 20, 33, 49, 65, 66, 73, 107, 129}) {
    for (const Shape& shape : shapes(n)) {
      SCOPED_TRACE(::testing::Message()
                   << "n = " << n << ", adjoint " << shape.adjoint << ", upper " << shape.upper
                   << ", bands " << shape.A_band << " " << shape.B_band << " " << shape.C_band);
      expect_ranges_of_the_whole<double>(GetParam(), n, shape);
      expect_ranges_of_the_whole<float>(GetParam(), n, shape);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Gemm, EachKernel, ::testing::ValuesIn(tested_kernels()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
