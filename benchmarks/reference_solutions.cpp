// Computes the reference solutions that errors are measured against, one file for each n.
#include <fmt/format.h>

#include <cstdio>

#include "benchmarks/arguments.h"
#include "benchmarks/command_line.h"
#include "benchmarks/output_file.h"
#include "benchmarks/product_rate.h"
#include "benchmarks/reference.h"

namespace isosyrk::reference_solutions {
namespace {

// Keeps a file that already holds this reference.
void make(Index n, const std::string& folder) {
  const Scene scene = smooth_scene(n);
  const std::string path = reference_path(folder, n);
  const OutputFile output("--out", path);
  std::string state = "kept";
  Reference reference;
  try {
    reference = read_reference("--out", folder, scene, HbarConvention::paper, default_modes());
  } catch (const BadArgument&) {
    std::fputs(fmt::format("reference n = {}: computing ...\n", n).c_str(), stderr);
    reference = compute_reference(scene, choose_backend({}, n).chosen);
    output.write(to_json(reference, scene, HbarConvention::paper, default_modes()));
    state = "computed";
  }
  std::fputs(
      fmt::format("reference n = {}: {}; {} with {} steps, {} with {}; they differ by {:.2g}\n", n,
                  state, reference.first.integrator, reference.first.steps,
                  reference.second.integrator, reference.second.steps, reference.uncertainty)
          .c_str(),
      stderr);
}

}  // namespace

int main_program(int argc, char** argv) {
  CommandLine line{
      "Computes W(5) of the smooth scene for each n with two integrators, whose difference is its "
      "uncertainty.  A file that is already there is kept."};
  std::string out;
  std::vector<std::string> sizes;
  line.option("--out", out, "folder for reference_n<n>.json", CommandLine::Need::required);
  line.option("--n", sizes, "matrix sizes, 5 to 513 (default 17 33 65 129)");
  if (const auto exit_code = line.read(argc, argv)) return *exit_code;
  use_one_blas_thread();
  if (sizes.empty()) sizes = {"17", "33", "65", "129"};
  std::vector<Index> wanted;
  for (const std::string& n : sizes) wanted.push_back(whole_number("--n", n, 5, 513));
  for (const Index n : wanted) OutputFile("--out", reference_path(out, n));  // checks all first
  for (const Index n : wanted) make(n, out);
  return exit_done;
}

}  // namespace isosyrk::reference_solutions
