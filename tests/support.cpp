#include "tests/support.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <fstream>
#include <limits>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "isosyrk/catalogue/fast_forms.h"
#include "isosyrk/flows/euler_zeitlin.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/flows/spin.h"

namespace isosyrk::testing {
namespace {

// In how many of two ways denormal numbers are kept: half the least normal number, formed here and
// now, and the least denormal one, read and scaled up.
template <class Real>
int ways_to_keep_denormals() {
  volatile Real least = std::numeric_limits<Real>::min();
  volatile Real denormal = std::numeric_limits<Real>::denorm_min();
  return (least * Real{0.5} != 0) + (denormal * (1 / std::numeric_limits<Real>::epsilon()) != 0);
}

// A basis of g, orthonormal in the Frobenius norm: the parts in g of all elementary matrices.
std::vector<Matrix> basis_of(const QuadraticAlgebra& algebra, bool real) {
  const Index n = algebra.size();
  std::vector<Matrix> basis;
  for (Index k = 0; k < (real ? 1 : 2) * n * n; ++k) {
    Matrix E = Matrix::Zero(n, n);
    E(k % (n * n) / n, k % n) = k < n * n ? Complex(1.0) : Complex(0.0, 1.0);
    Matrix mirrored(n, n);
    algebra.involution(E, mirrored);
    E -= mirrored;
    for (const Matrix& other : basis) {
      E -= other.conjugate().cwiseProduct(E).sum().real() * other;
    }
    if (E.norm() > 1e-6) basis.push_back(E.normalized());
  }
  return basis;
}

// M + sign J⁻¹ M† J of a random M, of Frobenius norm 1.
Matrix random_part(const QuadraticAlgebra& algebra, double sign, unsigned seed) {
  const Matrix M = random_matrix(algebra.size(), seed);
  Matrix mirrored(algebra.size(), algebra.size());
  algebra.involution(M, mirrored);
  return (M + sign * mirrored).normalized();
}

}  // namespace

double largest_difference(const Matrix& A, const Matrix& B) {
  return (A - B).cwiseAbs().maxCoeff();
}

Matrix random_matrix(Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix X(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      const double re = uniform(generator);
      X(i, j) = Complex(re, uniform(generator));
    }
  }
  return X;
}

Matrix random_skew_hermitian(Index n, unsigned seed) {
  const Matrix X = random_matrix(n, seed);
  const Matrix W = X - X.adjoint();
  return W / spectral_norm(W);
}

Matrix exponential(const Matrix& A) { return A.exp(); }

Matrix inverse(const Matrix& A) { return A.inverse(); }

Matrix product(std::initializer_list<Matrix> factors) {
  Matrix result = *factors.begin();
  for (auto factor = factors.begin() + 1; factor != factors.end(); ++factor) result *= *factor;
  return result;
}

Matrix exact_product(const Matrix& A, const Matrix& B) {
  using Extended = std::complex<long double>;
  return A.cast<Extended>().lazyProduct(B.cast<Extended>()).cast<Complex>();
}

Matrix commutator(const Matrix& A, const Matrix& B) { return product({A, B}) - product({B, A}); }

Matrix read_reference(const std::string& file, Index n) {
  std::ifstream input(ISOSYRK_TEST_DATA "/" + file);
  std::string line;
  std::getline(input, line);
  EXPECT_EQ(line, "i,j,re,im") << file;
  Matrix W = Matrix::Zero(n, n);
  Index entries = 0;
  char comma = 0;
  double re = 0.0, im = 0.0;
  for (Index i = 0, j = 0; input >> i >> comma >> j >> comma >> re >> comma >> im; ++entries) {
    W(i, j) = Complex(re, im);
  }
  EXPECT_TRUE(input.eof() && entries == n * n) << file;
  return W;
}

Matrix integrated(Integrator& integrator, const Matrix& W0, double h, long steps) {
  Matrix W = W0;
  const RunReport report = run(integrator, W, h, steps);
  EXPECT_TRUE(report.converged()) << name(report.status) << " at step " << report.failed_step;
  return W;
}

StepReport continued(Integrator& integrator, Matrix& W, double h) {
  integrator.set_state(W);
  const StepReport report = integrator.step(h);
  integrator.state(W);
  return report;
}

SharedFlow lent(const Flow& flow) { return {SharedFlow(), &flow}; }

ProductBackend products_of_tests(Index n) {
  return n < 33 ? ProductBackend::openblas : ProductBackend::eigen;
}

std::unique_ptr<Integrator> made(const IntegratorEntry& entry, const Flow& flow,
                                 const IterationOptions& options) {
  return entry.make(lent(flow), options, products_of_tests(flow.size()));
}

std::vector<std::string> recorded_integrators() {
  std::vector<std::string> names = {"yoshida4", "suzuki4", "kahan_li6", "rkmk4", "rk4"};
  for (const Formulation formulation : formulations()) {
    for (int s = 1; s <= (formulation == Formulation::group ? 8 : 3); ++s) {
      names.push_back(fmt::format("{}{}", name(formulation), s));
    }
  }
  for (std::size_t k = names.size(); k > 0; --k) names.push_back(names[k - 1] + "_frame");
  for (int s = 1; s <= 3; ++s) names.push_back(fmt::format("direct{}", s));
  return names;
}

std::vector<IntegratorEntry> forms_of(const IntegratorEntry& entry) {
  if (!entry.has_fast_form()) return {entry};
  return {entry, fast_entry(entry)};
}

bool takes(const IntegratorEntry& entry, const Flow& flow) {
  if (entry.co_rotating && dynamic_cast<const EulerZeitlin*>(&flow) == nullptr) return false;
  const bool solves_for_Omega = entry.family == Family::exponential_lie_poisson ||
                                entry.family == Family::bogfjellmo_marthinsen ||
                                entry.family == Family::crouch_grossman ||
                                entry.family == Family::explicit_magnus;
  if (!solves_for_Omega && !entry.projected) return true;
  const bool needs_H = entry.family == Family::exponential_lie_poisson && entry.order > 2;
  return flow.algebra().is_skew_hermitian() && (!needs_H || flow.has_self_adjoint_generator());
}

std::vector<IntegratorEntry> fast_integrators() {
  std::vector<IntegratorEntry> found;
  for (const IntegratorEntry& entry : integrators()) {
    if (entry.has_fast_form()) found.push_back(entry);
  }
  return found;
}

std::unique_ptr<Integrator> gauss(Formulation formulation, const Flow& flow, int s,
                                  double tolerance) {
  return made(gauss_entry(formulation, s), flow, {.tolerance = tolerance});
}

void PrintTo(const SceneCase& scene, std::ostream* out) { *out << scene.name; }

const std::vector<SceneCase>& tested_scenes() {
  static const std::vector<SceneCase> scenes = {{"smooth", {9}},
                                                {"rough", {9}},
                                                {"euler_top", {3}},
                                                {"rigid_body", {7}},
                                                {"spin_chain", {10}},
                                                {"symplectic", {6}},
                                                {"pseudo_unitary", {5, {}, {{3, 2}}}}};
  return scenes;
}

void PrintTo(const Method& method, std::ostream* out) {
  *out << name(method.formulation) << method.s;
}

std::vector<Method> methods(int most_stages) {
  std::vector<Method> all;
  for (const Formulation formulation : formulations()) {
    for (int s = 1; s <= most_stages; ++s) all.push_back({formulation, s});
  }
  return all;
}

double observed_order(double time, const std::vector<long>& counts,
                      const std::function<double(double h, long count)>& error,
                      const std::function<double(long count)>& plateau, std::size_t least) {
  std::vector<double> h, errors;
  for (const long count : counts) {
    const double step = time / static_cast<double>(count), found = error(step, count);
    if (found < plateau(count)) break;
    h.push_back(step);
    errors.push_back(found);
  }
  EXPECT_GE(errors.size(), least);
  if (errors.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const auto logarithms_about_their_mean = [](const std::vector<double>& values) {
    const Eigen::Map<const Eigen::ArrayXd> all(values.data(), static_cast<Index>(values.size()));
    const Eigen::ArrayXd logarithms = all.tail(std::min<Index>(5, all.size())).log();
    return RealVector(logarithms - logarithms.mean());
  };
  const RealVector x = logarithms_about_their_mean(h);
  return x.dot(logarithms_about_their_mean(errors)) / x.squaredNorm();
}

Tableau radau_iia() {
  Tableau tableau{"radau_iia2", 3, RealMatrix(2, 2), RealVector(2), RealVector(2)};
  tableau.a << 5.0 / 12.0, -1.0 / 12.0, 3.0 / 4.0, 1.0 / 4.0;
  tableau.b << 3.0 / 4.0, 1.0 / 4.0;
  tableau.c << 1.0 / 3.0, 1.0;
  return tableau;
}

std::array<Matrix, 3> spin_matrices(Index n) {
  const Spin spin(n);
  Matrix up = Matrix::Zero(n, n);
  Matrix Sz = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    Sz(i, i) = spin.magnetic(i);
    if (i + 1 < n) up(i, i + 1) = spin.ladder(i);
  }
  return {0.5 * (up + up.adjoint()), Complex(0.0, -0.5) * (up - up.adjoint()), Sz};
}

Matrix symplectic_J(Index k) {
  Matrix J = Matrix::Zero(2 * k, 2 * k);
  J.topRightCorner(k, k).setIdentity();
  J.bottomLeftCorner(k, k) = -Matrix::Identity(k, k);
  return J;
}

Matrix indefinite_J(Index p, Index q) {
  Matrix J = Matrix::Identity(p + q, p + q);
  J.bottomRightCorner(q, q) *= -1.0;
  return J;
}

bool keeps_denormals() {
  return ways_to_keep_denormals<float>() == 2 && ways_to_keep_denormals<double>() == 2;
}

bool flushes_denormals() {
  return ways_to_keep_denormals<float>() == 0 && ways_to_keep_denormals<double>() == 0;
}

WithFolder::WithFolder()
    : folder_(std::filesystem::temp_directory_path() /
              fmt::format("isosyrk_{}_{}", ::getpid(),
                          ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
  std::filesystem::create_directory(folder_);
}

std::filesystem::path WithFolder::write(const std::filesystem::path& file,
                                        const std::string& contents) const {
  std::filesystem::create_directories((folder_ / file).parent_path());
  std::ofstream(folder_ / file, std::ios::binary) << contents;
  return folder_ / file;
}

double poisson_map_defect(Integrator& integrator, const Matrix& W0, double h) {
  const Flow& flow = integrator.flow();
  const bool real = dynamic_cast<const RealFlow*>(&flow) != nullptr;
  const std::vector<Matrix> basis = basis_of(flow.algebra(), real);
  const auto size = static_cast<Index>(basis.size());
  const auto element = [&](Index a) -> const Matrix& { return basis[static_cast<std::size_t>(a)]; };
  const auto pairing = [](const Matrix& A, const Matrix& B) {
    return -A.cwiseProduct(B.transpose()).sum().real();
  };
  const RealMatrix gram = RealMatrix::NullaryExpr(
      size, size, [&](Index a, Index b) { return pairing(element(a), element(b)); });
  const RealMatrix to_coordinates = gram.inverse();
  const auto tensor = [&](const Matrix& W) {
    const RealMatrix lower = RealMatrix::NullaryExpr(size, size, [&](Index a, Index b) {
      return pairing(W, commutator(element(a), element(b)));
    });
    return RealMatrix(
        to_coordinates.lazyProduct(lower).eval().lazyProduct(to_coordinates.transpose()));
  };
  // Sixth-order differences: error delta^6, rounding 1e-15 / delta and what a projection adds.
  const double delta = 1e-3;
  RealMatrix derivative(size, size);
  for (Index b = 0; b < size; ++b) {
    const auto shifted = [&](double amount) {
      return integrated(integrator, W0 + amount * delta * element(b), h, 1);
    };
    const auto central = [&](double amount) { return Matrix(shifted(amount) - shifted(-amount)); };
    const Matrix slope = (45.0 * central(1.0) - 9.0 * central(2.0) + central(3.0)) / (60.0 * delta);
    RealVector pairings(size);
    for (Index a = 0; a < size; ++a) pairings(a) = pairing(element(a), slope);
    derivative.col(b) = to_coordinates * pairings;
  }
  const RealMatrix before = tensor(W0), after = tensor(integrated(integrator, W0, h, 1));
  return (derivative.lazyProduct(before).eval().lazyProduct(derivative.transpose()) - after)
             .norm() /
         after.norm();
}

ConjugationFlow::ConjugationFlow(const QuadraticAlgebra& algebra, unsigned seed)
    : Flow(algebra), D_(random_part(algebra, 1.0, seed)) {}

void ConjugationFlow::generator(const Matrix& W, Matrix& B) const { B = product({D_, W, D_}); }

double ConjugationFlow::hamiltonian(const Matrix& W) const {
  return 0.5 * product({W, D_, W, D_}).trace().real();
}

Matrix ConjugationFlow::element(unsigned seed) const { return random_part(algebra(), -1.0, seed); }

}  // namespace isosyrk::testing
