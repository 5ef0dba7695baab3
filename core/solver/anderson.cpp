#include "isosyrk/solver/anderson.h"

namespace isosyrk {
namespace {

constexpr int length = 8;  // divides the length of every row of a split matrix
using Singles8 = Eigen::Array<float, length, 1>;
using Doubles8 = Eigen::Array<double, length, 1>;

auto at(Eigen::VectorXf& values, Index i) { return Eigen::Map<Singles8>(values.data() + i); }
auto at(const RealVector& values, Index i) { return Eigen::Map<const Doubles8>(values.data() + i); }
auto at(RealVector& values, Index i) { return Eigen::Map<Doubles8>(values.data() + i); }

}  // namespace

Anderson::Anderson(const Unknowns& unknowns) {
  for (const auto& kind : unknowns) {
    for (const SplitMatrix& matrix : kind) {
      const Singles none = Singles::Zero(matrix.entries().size());
      unknowns_.push_back({matrix.entries(), none, none, {none, none}, {none, none}});
    }
  }
}

void Anderson::begin(const Unknowns& x) {
  sweeps_ = 0;
  auto unknown = unknowns_.begin();
  for (const auto& kind : x) {
    for (const SplitMatrix& matrix : kind) (unknown++)->x = matrix.entries();
  }
}

void Anderson::mix(Unknowns& x) {
  // Sweep k = 2, 3, ... and the sweep before form a pair.  The last two pairs are used.
  ++sweeps_;
  const int pairs = std::min(sweeps_ - 1, depth);
  const std::size_t slot = static_cast<std::size_t>(sweeps_) % depth;
  for (auto& row : dots_) row[0] = row[1] = 0.0;
  right_[0] = right_[1] = 0.0;
  auto unknown = unknowns_.begin();
  for (const auto& kind : x) {
    for (const SplitMatrix& g : kind) remember(g, *unknown++, slot, pairs > 0);
  }
  std::array<float, depth> gamma{};
  const std::size_t other = 1 - slot;
  const double a = dots_[slot][slot], b = dots_[slot][other], c = dots_[other][other];
  const double determinant = a * c - b * b;
  if (pairs == depth && determinant > 1e-10 * a * c) {
    gamma[slot] = static_cast<float>((c * right_[slot] - b * right_[other]) / determinant);
    gamma[other] = static_cast<float>((a * right_[other] - b * right_[slot]) / determinant);
  } else if (pairs > 0 && a > 0.0) {
    gamma[slot] = static_cast<float>(right_[slot] / a);
  }
  unknown = unknowns_.begin();
  for (auto& kind : x) {
    for (SplitMatrix& matrix : kind) {
      Unknown& u = *unknown++;
      for (Index i = 0; i < u.x.size(); i += length) {
        const Singles8 step = at(u.f, i) - gamma[0] * at(u.dg[0], i) - gamma[1] * at(u.dg[1], i);
        at(u.step, i) = step;
        at(u.x, i) += step.cast<double>();
        at(matrix.entries(), i) = at(u.x, i);
      }
    }
  }
}

// Stores f_k and the differences from f_{k-1}, and adds to the dot products for the weights.
void Anderson::remember(const SplitMatrix& g, Unknown& u, std::size_t slot, bool has_pair) {
  const std::size_t other = 1 - slot;
  if (!has_pair) {
    for (Index i = 0; i < u.x.size(); i += length) {
      at(u.f, i) = (at(g.entries(), i) - at(u.x, i)).cast<float>();
    }
    for (Singles* none : {&u.df[0], &u.df[1], &u.dg[0], &u.dg[1]}) none->setZero();
    return;
  }
  constexpr Index block = 64 * length;  // sums: in single precision in a block, then in double
  for (Index begin = 0; begin < u.x.size(); begin += block) {
    Singles8 newest = Singles8::Zero();    // (Δf_k)²
    Singles8 mixed = Singles8::Zero();     // Δf_k Δf_{k-1}
    Singles8 oldest = Singles8::Zero();    // (Δf_{k-1})²
    Singles8 f_newest = Singles8::Zero();  // f_k Δf_k
    Singles8 f_oldest = Singles8::Zero();  // f_k Δf_{k-1}
    for (Index i = begin; i < std::min(begin + block, u.x.size()); i += length) {
      const Singles8 f = (at(g.entries(), i) - at(u.x, i)).cast<float>();
      const Singles8 df = f - at(u.f, i);
      const Singles8 before = at(u.df[other], i);
      at(u.df[slot], i) = df;
      at(u.dg[slot], i) = at(u.step, i) + df;
      at(u.f, i) = f;
      newest += df * df;
      mixed += df * before;
      oldest += before * before;
      f_newest += f * df;
      f_oldest += f * before;
    }
    dots_[slot][slot] += static_cast<double>(newest.sum());
    dots_[slot][other] += static_cast<double>(mixed.sum());
    dots_[other][other] += static_cast<double>(oldest.sum());
    right_[slot] += static_cast<double>(f_newest.sum());
    right_[other] += static_cast<double>(f_oldest.sum());
  }
}

}  // namespace isosyrk
