#include "benchmarks/conditions.h"

#include <cblas.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "benchmarks/build_info.h"
#include "benchmarks/peak.h"
#include "isosyrk/split/split_products.h"

extern "C" char** environ;  // NOLINT(readability-redundant-declaration)

namespace isosyrk {
namespace {

constexpr const char* unknown = "unknown";

std::string cpu_info(std::string_view field) {
  std::ifstream info("/proc/cpuinfo");
  std::string line;
  while (std::getline(info, line)) {
    const auto colon = line.find(':');
    if (!line.starts_with(field) || line.find_first_not_of(" \t", field.size()) != colon) continue;
    return colon + 2 < line.size() ? line.substr(colon + 2) : "";
  }
  return unknown;
}

// Its name, which a virtual machine may give to processors that differ, and what tells those apart.
std::string processor() {
  std::string found = cpu_info("model name");
  for (const std::string_view field : {"cpu family", "model", "stepping"}) {
    if (const std::string value = cpu_info(field); value != unknown)
      found += fmt::format(", {} {}", field, value);
  }
  return found;
}

bool cpu_has(std::string_view flag) {
  const std::string flags = fmt::format(" {} ", cpu_info("flags"));
  return flags.find(fmt::format(" {} ", flag)) != std::string::npos;
}

std::string vector_units() {
  std::vector<std::string_view> present;
  for (const std::string_view flag : {"sse2", "avx", "fma", "avx2", "avx512f", "avx512dq"}) {
    if (cpu_has(flag)) present.push_back(flag);
  }
  return fmt::format("{}; compiled for {}", fmt::join(present, " "), compiled_vector_units());
}

std::string relevant_environment() {
  std::vector<std::string> found;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    for (const std::string_view prefix : {"OPENBLAS_", "OMP_", "GOMP_"}) {
      if (text.starts_with(prefix)) found.emplace_back(text);
    }
  }
  std::sort(found.begin(), found.end());
  return found.empty() ? "no OPENBLAS_*, OMP_* or GOMP_* variable set"
                       : fmt::format("{}", fmt::join(found, " "));
}

std::string kernel_set() { return openblas_get_corename(); }

// OpenBLAS core names whose kernels use 512-bit vectors.
bool kernels_use_avx512() {
  const std::string kernels = kernel_set();
  return kernels == "SkylakeX" || kernels == "Cooperlake" || kernels == "Sapphirerapids";
}

std::string load_average() {
  std::ifstream load("/proc/loadavg");
  std::string one, five, fifteen;
  load >> one >> five >> fifteen;
  return fmt::format("{} {} {}", one, five, fifteen);
}

std::string rates_text(const std::vector<BackendRates>& rates) {
  std::vector<std::string> sizes;
  for (const BackendRates& at : rates) {
    std::vector<std::string> backends;
    for (std::size_t k = 0; k < at.rates.size(); ++k) {
      backends.push_back(fmt::format("{} {:.1f}", name(product_backends()[k]),
                                     at.rates[k] * product_flops(at.n) * 1e-9));
    }
    sizes.push_back(fmt::format("n={}: {}", at.n, fmt::join(backends, ", ")));
  }
  return fmt::format("GFLOP/s {}", fmt::join(sizes, "; "));
}

std::string chosen_text(BackendChoice choice, const std::vector<BackendRates>& rates) {
  std::vector<std::string> sizes;
  for (const BackendRates& at : rates)
    sizes.push_back(fmt::format("n={} {}", at.n, name(at.chosen)));
  return fmt::format("{}: {}", choice ? "as asked" : "the faster by measurement",
                     fmt::join(sizes, ", "));
}

}  // namespace

std::string notice() {
  std::vector<std::string> remarks;
  const char* core_type = std::getenv("OPENBLAS_CORETYPE");
  if (cpu_has("avx512f") && !kernels_use_avx512()) {
    remarks.push_back(fmt::format(
        "this CPU has AVX-512 and OpenBLAS runs its {} kernels, which do not use it{}",
        kernel_set(),
        core_type == nullptr ? "; with OPENBLAS_CORETYPE=SkylakeX it runs others"
                             : fmt::format(" (OPENBLAS_CORETYPE={} is set)", core_type)));
  } else if (core_type != nullptr) {
    remarks.push_back(fmt::format("OPENBLAS_CORETYPE={} is set; OpenBLAS runs its {} kernels",
                                  core_type, kernel_set()));
  }
  if (std::string_view(build_info::build_type) != "Release") {
    remarks.push_back(fmt::format("this is a {} build, not Release", build_info::build_type));
  }
  return fmt::format("{}", fmt::join(remarks, "; "));
}

std::string kernel_sets() {
  return fmt::format("OpenBLAS {}, split products {}, other code compiled for {}", kernel_set(),
                     gemm_kernels().front().name, compiled_vector_units());
}

Conditions machine_conditions(const std::string& program, BackendChoice choice,
                              const std::vector<BackendRates>& rates) {
  return {
      {"isosyrk_program", program},
      {"isosyrk_format", "1"},
      {"version", build_info::version},
      {"commit", build_info::commit},
      {"dirty", build_info::dirty},
      {"compiler", build_info::compiler},
      {"flags", build_info::flags},
      {"build_type", build_info::build_type},
      {"cpu", processor()},
      {"vector_units", vector_units()},
      {"load_average", load_average()},
      {"blas_library", openblas_get_config()},
      {"blas_kernels", kernel_set()},
      {"split_kernels", gemm_kernels().front().name},
      {"blas_threads", fmt::format("{}", openblas_get_num_threads())},
      {"environment", relevant_environment()},
      {"products", chosen_text(choice, rates)},
      {"product_rate", rates_text(rates)},
      {"peak_gflops", fmt::format("{:.1f}", measured_peak_flops() * 1e-9)},
      {"notice", notice()},
  };
}

Conditions solver_conditions(const IterationOptions& options, HbarConvention convention,
                             const std::vector<Mode>& modes) {
  return {
      {"tolerance", fmt::format("{}", options.tolerance)},
      {"max_sweeps", fmt::format("{}", options.max_sweeps)},
      {"norm", "Frobenius, absolute, largest over every unknown"},
      {"start", "cold each step: Q = I, P = W0, W~ = W0, X = K = 0"},
      {"update_order", "Jacobi: all new unknowns from the old ones"},
      {"hbar", fmt::format("{}", name(convention))},
      {"modes_hash", hash_of(modes)},
  };
}

}  // namespace isosyrk
