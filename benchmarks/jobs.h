// Independent jobs on all cores, for studies that count rather than time.
//
// In processes, not threads: products and LAPACK calls then have nothing in common that they could
// wait for or spoil.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

namespace isosyrk {

/// Calls job(0) .. job(count - 1), each once, in `processes` child processes (in this one if 1),
/// and returns their results in order; `finished(k)` is called here as each arrives.  Throws
/// std::runtime_error with the first failure's message; no further job is begun then.  Throws
/// std::logic_error if this process has run steps on several threads: OpenMP would hang in a child.
std::vector<nlohmann::ordered_json> run_jobs(
    std::size_t count, long processes,
    const std::function<nlohmann::ordered_json(std::size_t)>& job,
    const std::function<void(std::size_t)>& finished);

}  // namespace isosyrk
