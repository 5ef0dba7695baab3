#include "benchmarks/npy_file.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support.h"

namespace isosyrk::testing {
namespace {

using NpyFile = WithFolder;

TEST_F(NpyFile, HoldsTheMatrixByRows) {
  Matrix W(2, 2);
  W << Complex(1, 2), Complex(3, 4), Complex(5, 6), Complex(7, 8);
  const std::string bytes = npy(W);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const auto header = static_cast<std::size_t>(static_cast<unsigned char>(bytes[8])) +
                      256U * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + header) % 64, 0U);
  EXPECT_EQ(bytes.size(), 10 + header + 4 * sizeof(Complex));
  EXPECT_NE(bytes.find("'descr': '<c16', 'fortran_order': False, 'shape': (2, 2)"),
            std::string::npos);
  double second_row_first = 0.0;
  std::memcpy(&second_row_first, bytes.data() + 10 + header + 2 * sizeof(Complex), sizeof(double));
  EXPECT_EQ(second_row_first, 5.0);

  // What is refused is tested from outside; see tests/scripts/test_integrate.py.
  EXPECT_EQ(read_npy(write("W.npy", bytes).string(), 2), W);
}

}  // namespace
}  // namespace isosyrk::testing
