#include "isosyrk/solver/predictor.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "isosyrk/split/linear_combination.h"

namespace isosyrk {
namespace {

// Order p of the difference ∇^p that fitted weights predict.  4 to 12 give about the same error.
constexpr int differences = 6;
// Rows of each unknown to which the weights are fitted.  Twice as many predict no better.
constexpr Index sampled_rows = 4;
// Smallest number of fitted weights.  One weight predicts no better than the polynomial through
// one more step.
constexpr int fewest_weights = 2;

Index rows_sampled_of(const SplitMatrix& X) { return std::min(sampled_rows, X.size()); }

Index numbers_sampled_of(const Unknowns& unknowns) {
  Index numbers = 0;
  for (const SplitStages& kind : unknowns) {
    for (const SplitMatrix& X : kind) numbers += rows_sampled_of(X) * X.stride();
  }
  return numbers;
}

int checked(int past_steps) {
  if (past_steps < 0 || past_steps > Predictor::most) {
    throw std::invalid_argument(fmt::format("start values from {} past steps: must be 0 to {}",
                                            past_steps, int{Predictor::most}));
  }
  return past_steps;
}

// Returns the coefficients (-1)^k C(order, k) of ∇^order, the newest value first.
using Binomials = std::array<double, Predictor::most + 1>;
Binomials alternating_binomials(int order) {
  Binomials c{};
  c[0] = 1.0;
  for (int k = 1; k <= order; ++k) {
    c[static_cast<std::size_t>(k)] = -c[static_cast<std::size_t>(k - 1)] *
                                     static_cast<double>(order - k + 1) / static_cast<double>(k);
  }
  return c;
}

}  // namespace

Predictor::Predictor(int past_steps, const Unknowns& like)
    : past_(static_cast<std::size_t>(checked(past_steps)), like),
      of_differences_(numbers_sampled_of(like), std::max(0, past_steps - differences)) {}

// Sets weights_ from the past steps and returns their number.  With the fitted c_j,
//     x_{m+1} = Σ_j c_j ∇^p x_{m+1-j} - (∇^p x_{m+1} - x_{m+1}),
// where the bracket has past steps only.  Without a fit ∇^K x_{m+1} is taken as 0 for all K steps.
int Predictor::weigh() {
  const bool fits = of_differences_.terms() >= fewest_weights;
  const LinearPrediction::Weights c =
      fits ? of_differences_.weights() : LinearPrediction::Weights(0);
  const int order = fits ? differences : known_;
  const Binomials binomials = alternating_binomials(order);
  weights_.fill(0.0);
  for (int k = 1; k <= order; ++k) {
    weights_[static_cast<std::size_t>(k - 1)] = -binomials[static_cast<std::size_t>(k)];
  }
  for (Index j = 0; j < c.size(); ++j) {
    for (std::size_t k = 0; k <= static_cast<std::size_t>(order); ++k) {
      weights_[static_cast<std::size_t>(j) + k] += c(j) * binomials[k];
    }
  }
  return order + static_cast<int>(c.size());
}

bool Predictor::predict(double h, Unknowns& x) {
  if (known_ == 0 || h != h_) return false;
  const int count = weigh();
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    assign(x[kind], [&](std::size_t i) {
      LinearCombination<double> predicted;
      for (int k = 0; k < count; ++k) {
        predicted += weights_[static_cast<std::size_t>(k)] * past(k)[kind][i];
      }
      return predicted;
    });
  }
  return true;
}

void Predictor::accept(double h, const Unknowns& x) {
  if (past_.empty()) return;
  if (h != h_) forget();
  h_ = h;
  newest_ = (newest_ + 1) % past_.size();
  known_ = std::min(known_ + 1, static_cast<int>(past_.size()));
  for (std::size_t kind = 0; kind < x.size(); ++kind) {
    copy(past_[newest_][kind], x[kind]);
  }
  learn();
}

// Appends ∇^p of the sampled rows to the sequence for the fitted weights.
void Predictor::learn() {
  if (known_ <= differences) return;
  const Binomials weights = alternating_binomials(differences);
  double* to = of_differences_.next().data();
  for (std::size_t kind = 0; kind < past(0).size(); ++kind) {
    for (std::size_t i = 0; i < past(0)[kind].size(); ++i) {
      const SplitMatrix& X = past(0)[kind][i];
      const Index rows = rows_sampled_of(X);
      for (Index row = 0; row < rows; ++row, to += X.stride()) {
        const Index begin = (2 * row + 1) * X.size() / (2 * rows) * X.stride();
        Eigen::Map<RealVector> difference(to, X.stride());
        difference = past(0)[kind][i].entries().segment(begin, X.stride());
        for (int k = 1; k <= differences; ++k) {
          difference += weights[static_cast<std::size_t>(k)] *
                        past(k)[kind][i].entries().segment(begin, X.stride());
        }
      }
    }
  }
  of_differences_.add();
}

void Predictor::forget() {
  known_ = 0;
  of_differences_.forget();
}

void Predictor::archive(StateArchive& state) {
  state.pass(known_, newest_, h_);
  const auto most_known = static_cast<int>(past_.size());
  if (known_ < 0 || known_ > most_known || (known_ > 0 && newest_ >= past_.size())) {
    throw std::invalid_argument("state: is of another number of past steps");
  }
  for (int k = 0; k < known_; ++k) state.pass(past_[place(k)]);
  state.pass(of_differences_);
}

}  // namespace isosyrk
