// The kernel interface itself: a product formed in ranges of its parts.
#include "isosyrk/split/gemm_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <vector>

#include "isosyrk/split/bands.h"
#include "isosyrk/split/split_matrix.h"
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
      all.push_back({adjoint, upper, full, full, full});
      all.push_back({adjoint, upper, n / 3, n / 2, full});
      all.push_back({adjoint, upper, n / 4, full, n / 3});
      all.push_back({adjoint, upper, n / 6, full, full});
      all.push_back({adjoint, upper, full, n / 6, full});
    }
  }
  return all;
}

constexpr Share whole = {0, 1, 1};
constexpr std::array<Share, 3> ranges = {{{0, 1, 6}, {1, 3, 6}, {3, 6, 6}}};

template <class Real>
class Factors {
 public:
  Factors(Index n, const Shape& shape)
      : shape_(shape), A_(random_matrix(n, 1)), B_(random_matrix(n, 2)) {
    cut_to_band(shape.A_band, A_);
    cut_to_band(shape.B_band, B_);
  }

  // Forms this share of C = -0.3 A B or -0.3 A† B and leaves other rows of C as they were.
  void multiply(const GemmKernel& kernel, Share share, SplitMatrixOf<Real>& C) const {
    constexpr bool is_single = sizeof(Real) == sizeof(float);
    const Index n = A_.size();
    const PackingLimits limits = is_single ? kernel.single_limits : kernel.limits;
    const bool packs_B = n > limits.B;
    std::vector<Real> scratch(static_cast<std::size_t>(gemm_scratch(n, A_.stride(), packs_B)),
                              std::numeric_limits<Real>::quiet_NaN());
    SplitProduct<Real> product{};
    product.n = n;
    product.stride = A_.stride();
    product.A_re = A_.re();
    product.A_im = A_.im();
    product.adjoint = shape_.adjoint;
    product.B_re = B_.re();
    product.B_im = B_.im();
    product.scale = static_cast<Real>(-0.3);
    product.C_re = C.re();
    product.C_im = C.im();
    product.upper = shape_.upper;
    product.A_band = shape_.A_band;
    product.B_band = shape_.B_band;
    product.C_band = shape_.C_band;
    product.first_part = share.first;
    product.end_part = share.end;
    product.parts = share.parts;
    product.packs_B = packs_B;
    product.packs_adjoint_A = n > limits.adjoint_A;
    product.scratch = scratch.data();
    if constexpr (is_single) {
      kernel.multiply_singles(product);
    } else {
      kernel.multiply(product);
    }
  }

 private:
  Shape shape_;
  SplitMatrixOf<Real> A_;
  SplitMatrixOf<Real> B_;
};

// Not a number in every entry; the padding is 0.
template <class Real>
SplitMatrixOf<Real> unformed(Index n) {
  const double nan = std::nan("");
  return SplitMatrixOf<Real>(Matrix(Matrix::Constant(n, n, Complex(nan, nan))));
}

// Entries of C that are needed and differ from those of `expected` in any bit.
template <class Real>
Index different_entries(const Shape& shape, const SplitMatrixOf<Real>& C,
                        const SplitMatrixOf<Real>& expected) {
  Index different = 0;
  for (Index r = 0; r < C.size(); ++r) {
    for (Index c = 0; c < C.size(); ++c) {
      if (!shape.needs(r, c)) continue;
      const Index at = r * C.stride() + c;
      different += std::memcmp(C.re() + at, expected.re() + at, sizeof(Real)) != 0 ||
                   std::memcmp(C.im() + at, expected.im() + at, sizeof(Real)) != 0;
    }
  }
  return different;
}

// Every shape needs the diagonal.
template <class Real>
bool row_is_formed(const SplitMatrixOf<Real>& C, Index r) {
  return !std::isnan(C.re()[r * C.stride() + r]);
}

constexpr std::array<Index, 5> sizes = {17, 33, 49, 66, 129};

// Calls test(n, shape, factors) for every size and shape.
template <class Real, class Test>
void for_each_product(const Test& test) {
  for (const Index n : sizes) {
    for (const Shape& shape : shapes(n)) {
      SCOPED_TRACE(::testing::Message()
                   << "n = " << n << ", adjoint " << shape.adjoint << ", upper " << shape.upper
                   << ", bands " << shape.A_band << " " << shape.B_band << " " << shape.C_band);
      test(n, shape, Factors<Real>(n, shape));
    }
  }
}

template <class Real>
void expect_ranges_to_be_the_whole(const GemmKernel& kernel) {
  for_each_product<Real>([&](Index n, const Shape& shape, const Factors<Real>& factors) {
    auto expected = unformed<Real>(n), C = unformed<Real>(n);
    factors.multiply(kernel, whole, expected);
    for (const Share& share : ranges) {
      EXPECT_GT(different_entries(shape, C, expected), 0) << "before the last range";
      factors.multiply(kernel, share, C);
    }
    EXPECT_EQ(different_entries(shape, C, expected), 0);
  });
}

template <class Real>
void expect_rows_in_one_range_each(const GemmKernel& kernel) {
  for_each_product<Real>([&](Index n, const Shape& shape, const Factors<Real>& factors) {
    Index next = 0;
    for (const Share& share : ranges) {
      auto C = unformed<Real>(n);
      factors.multiply(kernel, share, C);
      const Index begin = next;
      while (next < n && row_is_formed(C, next)) ++next;
      for (Index r = 0; r < n; ++r) EXPECT_EQ(row_is_formed(C, r), begin <= r && r < next) << r;
      EXPECT_GT(next, begin);
      // Of an upper triangle or a band the lower half of all rows may take much longer than the
      // upper; tiles are formed whole: what of them is not wanted counts too.
      if (n == 129) {
        const auto above = static_cast<double>(shape.multiplications(n, next));
        EXPECT_NEAR(above / static_cast<double>(shape.multiplications(n, n)),
                    static_cast<double>(share.end) / static_cast<double>(share.parts), 0.1);
      }
      const bool rows_cost_the_same = !shape.upper && shape.A_band == n - 1;
      if (rows_cost_the_same) {
        const double of_all =
            static_cast<double>(share.end - share.first) / static_cast<double>(share.parts);
        EXPECT_NEAR(static_cast<double>(next - begin), of_all * static_cast<double>(n), 1.0);
      }
    }
    EXPECT_EQ(next, n);
  });
}

class EachKernel : public ::testing::TestWithParam<GemmKernel> {};

TEST_P(EachKernel, FormsRangesThatAreTheWholeBitForBit) {
  expect_ranges_to_be_the_whole<double>(GetParam());
  expect_ranges_to_be_the_whole<float>(GetParam());
}

TEST_P(EachKernel, FormsEachRowInOneRangeOfItsShareOfTheWork) {
  expect_rows_in_one_range_each<double>(GetParam());
  expect_rows_in_one_range_each<float>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Gemm, EachKernel, ::testing::ValuesIn(tested_kernels()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace isosyrk::testing
