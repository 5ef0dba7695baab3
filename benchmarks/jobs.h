// Independent jobs on all cores, for studies that count rather than time.
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

namespace isosyrk {

/// Calls job(0) .. job(count - 1), each once, on so many threads, this one included, and returns their
/// results in order.  `finished(k)` is called as each ends, one at a time.  Jobs may share nothing
/// that one of them writes.  Rethrows the first failure; no further job is begun then.
std::vector<nlohmann::ordered_json> run_jobs(
    std::size_t count, long threads,
    const std::function<nlohmann::ordered_json(std::size_t)>& job,
    const std::function<void(std::size_t)>& finished);

}  // namespace isosyrk
