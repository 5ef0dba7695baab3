#include "isosyrk/solver/predictor.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "isosyrk/split/split_sums.h"

namespace isosyrk {
namespace {

constexpr Index sampled_rows = 4;  // of each unknown; twice as many predict no better (measured)

Index rows_sampled_of(const PlanarMatrix& X) { return std::min(sampled_rows, X.size()); }

Index numbers_sampled_of(const Unknowns& unknowns) {
  Index numbers = 0;
  for (const auto& kind : unknowns) {
    for (const PlanarMatrix& X : kind) numbers += rows_sampled_of(X) * X.stride();
  }
  return numbers;
}

// With one term it would predict no better than the polynomial through one step more.
constexpr int fewest_terms = 2;

bool has_enough_to_fit(int steps) { return steps >= StartValues::differences + fewest_terms; }

int checked(int steps) {
  if (steps < 0 || steps > StartValues::most) {
    throw std::invalid_argument(
        fmt::format("start order {}: must be 0 to {}", steps, int{StartValues::most}));
  }
  return steps;
}

// (-1)^k C(p, k), k = 0 ... p: the weights of ∇^p.
using Binomials = std::array<double, StartValues::most + 1>;
Binomials alternating_binomials(int p) {
  Binomials c{1.0};
  for (int k = 1; k <= p; ++k) {
    const auto at = static_cast<std::size_t>(k);
    c[at] = -c[at - 1] * static_cast<double>(p - k + 1) / static_cast<double>(k);
  }
  return c;
}

}  // namespace

StartValues::StartValues(int steps, bool fitted, const Unknowns& unknowns)
    : past_(static_cast<std::size_t>(checked(steps)), unknowns),
      fitted_(fitted && has_enough_to_fit(steps)),
      of_differences_(numbers_sampled_of(unknowns), fitted_ ? steps - differences : 0) {}

bool StartValues::begin(double h) {
  if (known_ == 0 || h != h_) return false;
  const bool fits = of_differences_.terms() >= fewest_terms;
  const LinearPrediction::Weights c =
      fits ? of_differences_.weights() : LinearPrediction::Weights(0);
  const int order = fits ? differences : known_;
  const Binomials binomials = alternating_binomials(order);
  count_ = order + static_cast<int>(c.size());
  weights_.fill(0.0);
  for (int k = 1; k <= order; ++k) {
    weights_[static_cast<std::size_t>(k - 1)] = -binomials[static_cast<std::size_t>(k)];
  }
  for (Index j = 0; j < c.size(); ++j) {
    for (std::size_t k = 0; k <= static_cast<std::size_t>(order); ++k) {
      weights_[static_cast<std::size_t>(j) + k] += c(j) * binomials[k];
    }
  }
  return true;
}

void StartValues::predict(std::size_t kind, std::size_t unknown, PlanarMatrix& X,
                          Share share) const {
  Terms<double> terms;
  for (int k = 0; k < count_; ++k) {
    terms.add(weights_[static_cast<std::size_t>(k)], past(k)[kind][unknown]);
  }
  assign(X, share, terms);
}

void StartValues::accept(double h) {
  if (past_.empty()) return;
  if (h != h_) forget();
  h_ = h;
  newest_ = (newest_ + 1) % past_.size();
  known_ = std::min(known_ + 1, static_cast<int>(past_.size()));
}

void StartValues::keep(std::size_t kind, std::size_t unknown, const PlanarMatrix& X, Share share) {
  if (!past_.empty()) reals(past_[newest_][kind][unknown], share) = reals(X, share);
}

// ∇^p of the row that begins there.
void StartValues::difference(std::size_t kind, std::size_t unknown, Index begin, double* to) const {
  using Numbers = planar_sums::Assigned<double>;
  constexpr int length = Numbers::SizeAtCompileTime;
  const Binomials weights = alternating_binomials(differences);
  const Index end = begin + past(0)[kind][unknown].stride();
  for (Index at = begin; at < end; at += length, to += length) {
    const planar_sums::LoadAt<length, double> load{at};
    Numbers sum = Numbers::Zero();
    for (int k = 0; k <= differences; ++k) {
      sum += weights[static_cast<std::size_t>(k)] * load(past(k)[kind][unknown]);
    }
    Eigen::Map<Numbers>{to} = sum;
  }
}

void StartValues::learn() {
  if (!fitted_ || known_ <= differences) return;
  double* to = of_differences_.next().data();
  for (std::size_t kind = 0; kind < past(0).size(); ++kind) {
    for (std::size_t unknown = 0; unknown < past(0)[kind].size(); ++unknown) {
      const PlanarMatrix& X = past(0)[kind][unknown];
      const Index rows = rows_sampled_of(X);
      for (Index row = 0; row < rows; ++row, to += X.stride()) {
        const Index middle = (2 * row + 1) * X.size() / (2 * rows);
        difference(kind, unknown, middle * X.stride(), to);
      }
    }
  }
  of_differences_.add();
}

void StartValues::forget() {
  known_ = 0;
  of_differences_.forget();
}

}  // namespace isosyrk
