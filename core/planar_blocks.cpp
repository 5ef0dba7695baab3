#include "core/planar_blocks.h"

namespace isosyrk {
namespace {

// Calls block(upper, lower) with the places of the blocks of four rows at (r, c) and (c, r), r < c,
// and pair(upper, lower) with those of single entries of what is left, the diagonal's blocks and
// the last rows that are less than four; and on_diagonal(place).
template <class OnBlock, class OnPair, class OnDiagonal>
void for_pairs(const PlanarMatrix& C, OnBlock&& block, OnPair&& pair, OnDiagonal&& on_diagonal) {
  const Index n = C.size();
  const Index stride = C.stride();
  const Index whole = n / 4 * 4;
  for (Index c = 0; c < whole; c += 4) {
    for (Index r = 0; r < c; r += 4) block(r * stride + c, c * stride + r);
    for (Index i = c; i < c + 4; ++i) {
      for (Index k = i + 1; k < c + 4; ++k) pair(i * stride + k, k * stride + i);
    }
  }
  for (Index c = whole; c < n; ++c) {
    for (Index r = 0; r < c; ++r) pair(r * stride + c, c * stride + r);
  }
  for (Index i = 0; i < n; ++i) on_diagonal(i * stride + i);
}

}  // namespace

void mirror_skew(PlanarMatrix& C) {
  const Index stride = C.stride();
  double* re = C.re();
  double* im = C.im();
  for_pairs(
      C,
      [=](Index upper, Index lower) {
        Block block;
        block.load(re + upper, stride);
        for (Four& row : block.row) row = -row;
        block.transpose();
        block.store(re + lower, stride);
        block.load(im + upper, stride);
        block.transpose();
        block.store(im + lower, stride);
      },
      [=](Index upper, Index lower) {
        re[lower] = -re[upper];
        im[lower] = im[upper];
      },
      [=](Index at) { re[at] = 0.0; });
}

void skew_part(const PlanarMatrix& C, double scale, PlanarMatrix& out) {
  const Index stride = C.stride();
  const double* re = C.re();
  const double* im = C.im();
  double* out_re = out.re();
  double* out_im = out.im();
  for_pairs(
      C,
      [=](Index upper, Index lower) {
        Block sum, other;
        sum.load(re + upper, stride);
        other.load(re + lower, stride);
        other.transpose();
        for (int r = 0; r < 4; ++r) sum.row[r] = scale * (sum.row[r] - other.row[r]);
        sum.store(out_re + upper, stride);
        for (Four& row : sum.row) row = -row;
        sum.transpose();
        sum.store(out_re + lower, stride);
        sum.load(im + upper, stride);
        other.load(im + lower, stride);
        other.transpose();
        for (int r = 0; r < 4; ++r) sum.row[r] = scale * (sum.row[r] + other.row[r]);
        sum.store(out_im + upper, stride);
        sum.transpose();
        sum.store(out_im + lower, stride);
      },
      [=](Index upper, Index lower) {
        const double real = scale * (re[upper] - re[lower]);
        const double imaginary = scale * (im[upper] + im[lower]);
        out_re[upper] = real;
        out_re[lower] = -real;
        out_im[upper] = out_im[lower] = imaginary;
      },
      [=](Index at) {
        out_re[at] = 0.0;
        out_im[at] = 2.0 * scale * im[at];
      });
}

void minus_adjoint(const PlanarMatrix& C, PlanarMatrix& out) {
  const Index stride = C.stride();
  const double* re = C.re();
  const double* im = C.im();
  double* out_re = out.re();
  double* out_im = out.im();
  const auto turn = [stride](const double* from, double* to, bool negative) {
    Block block;
    block.load(from, stride);
    if (negative) {
      for (Four& row : block.row) row = -row;
    }
    block.transpose();
    block.store(to, stride);
  };
  for_pairs(
      C,
      [=](Index upper, Index lower) {
        turn(re + lower, out_re + upper, true);
        turn(re + upper, out_re + lower, true);
        turn(im + lower, out_im + upper, false);
        turn(im + upper, out_im + lower, false);
      },
      [=](Index upper, Index lower) {
        out_re[upper] = -re[lower];
        out_re[lower] = -re[upper];
        out_im[upper] = im[lower];
        out_im[lower] = im[upper];
      },
      [=](Index at) {
        out_re[at] = -re[at];
        out_im[at] = im[at];
      });
}

}  // namespace isosyrk
