#include "benchmarks/stability_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "isosyrk/catalogue/fast_forms.h"

namespace isosyrk {

StabilityOptions::StabilityOptions(CommandLine& line, const std::string& quick) {
  line.option("--out", out_, "write the outcomes here, as JSON", CommandLine::Need::required);
  line.option("--n", sizes_, "matrix sizes, 5 to 513");
  line.option("--integrator", integrators_, "names of integrators (default all)");
  line.option("--products", products_, "fastest (default), openblas or eigen");
  line.option("--processes", processes_, "maps or runs at a time (default: one for each core)");
  line.flag("--quick", quick_, quick);
}

void StabilityOptions::allow_fast_forms(CommandLine& line) {
  line.option("--solver", solver_,
              "published (default), or fast: the fast forms of Table 1's formulations");
}

void StabilityOptions::choose_integrators(StabilityRequest& request) const {
  if (solver_ == "published") {
    for (const std::string& wanted : integrators_) {
      request.integrators.push_back(&integrator_entry(wanted));
    }
    if (request.integrators.empty()) {
      for (const IntegratorEntry& entry : integrators()) request.integrators.push_back(&entry);
    }
    return;
  }
  if (solver_ != "fast") {
    throw BadArgument(fmt::format("--solver '{}': must be published or fast", solver_));
  }
  std::vector<IntegratorEntry> all;
  for (const int s : {1, 2, 3}) {
    for (const Formulation formulation : formulations()) {
      all.push_back(fast_gauss_entry(formulation, s));
      all.back().name = gauss_entry(formulation, s).name;
    }
  }
  for (const std::string& wanted : integrators_) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const auto& entry) { return entry.name == wanted; });
    if (found == all.end()) {
      throw BadArgument(fmt::format("--integrator '{}': has no fast form in Table 2", wanted));
    }
    request.fast_forms.push_back(*found);
  }
  if (request.fast_forms.empty()) request.fast_forms = std::move(all);
  for (const IntegratorEntry& entry : request.fast_forms) request.integrators.push_back(&entry);
}

StabilityRequest StabilityOptions::read(const std::vector<Index>& default_sizes,
                                        const std::vector<Index>& quick_sizes) const {
  StabilityRequest request;
  for (const std::string& n : sizes_) request.sizes.push_back(whole_number("--n", n, 5, 513));
  if (request.sizes.empty()) request.sizes = quick_ ? quick_sizes : default_sizes;
  choose_integrators(request);
  request.products = backend_choice(products_);
  request.processes = processes_.empty()
                          ? std::max(1L, static_cast<long>(std::thread::hardware_concurrency()))
                          : whole_number("--processes", processes_, 1, 1024);
  request.output.emplace("--out", out_);
  return request;
}

void JobProgress::finished(const std::string& job) {
  ++done_;
  progress_.say(job, fmt::format("{} of {}", done_, jobs_));
}

}  // namespace isosyrk
