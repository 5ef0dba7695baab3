#include "isosyrk/fast/exponential_coupling.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "isosyrk/fast/term_growth.h"

namespace isosyrk {
namespace {

// K contracts by about this factor.
constexpr double contraction_of_K = 0.1;
// K contracts by at least about this multiple of h ‖W₀‖_F / √n: by 0.1 to 0.4 of it for an error
// that is spread over all l, in smooth, rough and steady states, n = 5 to 129.
constexpr double contraction_of_size = 0.1;
// The error that two nodes make is this part of δ, times the least contraction and the fourth power
// of ‖Ω‖_F / √n: 1 / 14400 for each (ad_Ω)⁴ / 5 that the quadrature leaves out, beside a weight of
// 1/2; about 9 such powers for a δ that is spread over all l, as the rounding of a start is; and
// about 1.5 of the least contraction.  It shows in large steps of small n alone, which else err by
// up to 100 tolerances (7500 runs of 1 to 5 steps near symmetries, n = 5 to 12, h‖B‖ up to 1.5).
constexpr double error_of_two_nodes = 4e-4;

}  // namespace

ExponentialCoupling::ExponentialCoupling(SplitOperations& operations, const ExponentialStep& step,
                                         bool is_graded)
    : lie_(operations.single_lie),
      step_(step),
      is_graded_(is_graded),
      Omega_(operations.size()),
      states_{Omega_, Omega_},
      sums_(states_),
      c_(Omega_),
      next_c_(Omega_),
      D_(Omega_),
      BD_(Omega_),
      sum_of_D_(Omega_) {}

double ExponentialCoupling::least_contraction() const {
  return contraction_of_size * std::abs(step_.h) * step_.size_of_W0 /
         std::sqrt(static_cast<double>(step_.W0->size()));
}

void ExponentialCoupling::linearize(const SplitMatrix& Omega, double part) {
  round_to_single(Omega_, Omega);
  lie_.cut_to_part(Omega_, part);
  for (SingleMatrix& state : states_) lie_.cut_to_part(state, part);
}

void ExponentialCoupling::couple(Corrections& coupled, const Corrections& delta, double accuracy) {
  const SingleMatrix& t = delta[0][0];
  const double size = norm(t);
  lie_.neglect(std::max(accuracy / size, tuning.single_roundoff));
  sum_series(t, size, accuracy);
  integrate();
  lie_.generate(BD_, D_);
  coupled[0][0] = step_.h * BD_;
  if (sums_D_) add_to_sum_of_D();
}

// Sums Σ_j s^j c_j at the nodes, with an error of K δ of this accuracy.
void ExponentialCoupling::sum_series(const SingleMatrix& delta, double size, double accuracy) {
  constexpr int most_terms = 60;
  const double end = is_graded_ ? accuracy : std::min(accuracy, tuning.single_roundoff * size);
  constexpr double largest_node = coupling_nodes.back().s;
  c_ = 1.0 * delta;
  lie_.cut(c_);
  for (SingleMatrix& sum : sums_) sum = 1.0 * c_;
  TermGrowth growth;
  growth.begin(size);
  for (int j = 1; j < most_terms; ++j) {
    const double factor = 1.0 / static_cast<double>(j + 1);
    lie_.bracket(next_c_, Omega_, c_, factor);
    std::swap(c_, next_c_);
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      sums_[i] = sums_[i] + std::pow(coupling_nodes[i].s, j) * c_;
    }
    // c_j and c_{j+1} in K δ
    const double size_of_c = norm(c_);
    growth.record(size_of_c, factor);
    const double next = largest_node * growth.next(1.0 / static_cast<double>(j + 2));
    const double weight = contraction_of_K * std::pow(largest_node, j);
    if (!(weight * std::min(size_of_c, next) > end)) break;  // NaN included
  }
}

// D = Σ_i weight_i [Σ_j s_i^j c_j, e^{s_i ad_Ω} W₀].
void ExponentialCoupling::integrate() {
  lie_.bracket(D_, sums_[0], states_[0], coupling_nodes[0].weight);
  lie_.add_bracket(D_, sums_[1], states_[1], coupling_nodes[1].weight);
}

double ExponentialCoupling::error_of_quadrature(double size, double size_of_Omega) const {
  const double mean_square = size_of_Omega * size_of_Omega / static_cast<double>(Omega_.size());
  return error_of_two_nodes * mean_square * mean_square * least_contraction() * size;
}

void ExponentialCoupling::add_to_sum_of_D() {
  if (has_sum_of_D_) {
    sum_of_D_ = sum_of_D_ + D_;
  } else {
    std::swap(sum_of_D_, D_);
  }
  has_sum_of_D_ = true;
}

void ExponentialCoupling::sum_D(bool is_wanted) {
  sums_D_ = is_wanted;
  has_sum_of_D_ = false;
}

}  // namespace isosyrk
