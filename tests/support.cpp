#include "tests/support.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sched.h>

#include <Eigen/Dense>
#include <cstdio>
#include <fstream>
#include <list>
#include <random>
#include <sstream>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "isosyrk/tableaux/gauss_tableau.h"
#include "isosyrk/flows/invariants.h"
#include "isosyrk/split/split_products.h"
#include "isosyrk/simulation/run.h"
#include "isosyrk/flows/spin.h"

namespace isosyrk::testing {

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
  const Index n = A.rows();
  Matrix C(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      std::complex<long double> sum = 0.0L;
      for (Index k = 0; k < n; ++k) {
        sum += std::complex<long double>(A(i, k)) * std::complex<long double>(B(k, j));
      }
      C(i, j) = Complex(static_cast<double>(sum.real()), static_cast<double>(sum.imag()));
    }
  }
  return C;
}

Matrix commutator(const Matrix& A, const Matrix& B) { return product({A, B}) - product({B, A}); }

std::vector<GemmKernel> tested_kernels() {
  static std::list<std::string> names;
  std::vector<GemmKernel> tested;
  for (GemmKernel kernel : gemm_kernels()) {
    tested.push_back(kernel);
    kernel.name = names.emplace_back(kernel.name + std::string("_copies")).c_str();
    kernel.limits = kernel.single_limits = {0, 0};
    tested.push_back(kernel);
  }
  return tested;
}

Matrix read_reference(const std::string& file, Index n) {
  std::ifstream input(std::string(ISOSYRK_TEST_DATA "/") + file);
  std::string line;
  std::getline(input, line);
  if (line != "i,j,re,im") throw std::runtime_error("not a reference matrix: " + file);
  Matrix W = Matrix::Zero(n, n);
  Index entries = 0;
  while (std::getline(input, line)) {
    long i = 0;
    long j = 0;
    double re = 0.0;
    double im = 0.0;
    if (std::sscanf(line.c_str(), "%ld,%ld,%lf,%lf", &i, &j, &re, &im) != 4) {
      throw std::runtime_error("broken line in " + file);
    }
    W(i, j) = Complex(re, im);
    ++entries;
  }
  if (entries != n * n) throw std::runtime_error("entries missing in " + file);
  return W;
}

Matrix integrated(Integrator& integrator, const Matrix& W0, double h, long steps) {
  Matrix W = W0;
  const RunReport report = run(integrator, W, h, steps);
  EXPECT_TRUE(report.converged()) << name(report.status) << " at step " << report.failed_step;
  return W;
}

std::unique_ptr<Integrator> gauss(Formulation formulation, const Flow& flow, int s,
                                  double tolerance) {
  return make_formulation(formulation, flow, gauss_tableau(s), {tolerance, 1000},
                          ProductBackend::openblas);
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

double observed_order(const std::vector<double>& h, const std::vector<double>& errors) {
  const double count = static_cast<double>(h.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t k = 0; k < h.size(); ++k) {
    const double x = std::log(h[k]);
    const double y = std::log(errors[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (count * sxy - sx * sy) / (count * sxx - sx * sx);
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

std::vector<std::size_t> allowed_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  std::vector<std::size_t> processors;
  for (std::size_t each = 0; each < CPU_SETSIZE; ++each) {
    if (CPU_ISSET(each, &set)) processors.push_back(each);
  }
  return processors;
}

void run_on(const std::vector<std::size_t>& processors) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const std::size_t processor : processors) CPU_SET(processor, &set);
  ASSERT_EQ(sched_setaffinity(0, sizeof set, &set), 0);
}

ConjugationFlow::ConjugationFlow(const QuadraticAlgebra& algebra, unsigned seed) : Flow(algebra) {
  const Matrix M = random_matrix(size(), seed);
  Matrix mirrored(size(), size());
  algebra.involution(M, mirrored);
  D_ = (M + mirrored) / (M + mirrored).norm();
}

void ConjugationFlow::generator(const Matrix& W, Matrix& B) const { B = product({D_, W, D_}); }

double ConjugationFlow::hamiltonian(const Matrix& W) const {
  return 0.5 * product({W, D_, W, D_}).trace().real();
}

Matrix ConjugationFlow::element(unsigned seed) const {
  const Matrix M = random_matrix(size(), seed);
  Matrix mirrored(size(), size());
  algebra().involution(M, mirrored);
  return (M - mirrored) / (M - mirrored).norm();
}

}  // namespace isosyrk::testing
