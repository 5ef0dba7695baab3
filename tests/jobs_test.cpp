#include "benchmarks/jobs.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "isosyrk/split/linear_combination.h"

namespace isosyrk::testing {
namespace {

using Json = nlohmann::ordered_json;

const auto unheard = [](std::size_t) {};

TEST(Jobs, ResultsComeInOrderAndEachIsHeardOfOnce) {
  for (const long threads : {1, 2, 5}) {
    std::vector<int> heard(100);
    const auto results = run_jobs(
        heard.size(), threads,
        [](std::size_t k) {
          return Json{{"square", k * k}};
        },
        [&](std::size_t k) { ++heard[k]; });
    for (std::size_t k = 0; k < heard.size(); ++k) {
      EXPECT_EQ(results[k]["square"], k * k);
      EXPECT_EQ(heard[k], 1);
    }
  }
}

TEST(Jobs, RunAtTheSameTime) {
  std::atomic<int> begun{0};
  const auto job = [&](std::size_t) -> Json {
    ++begun;
    for (int wait = 0; begun < 2 && wait < 10000; ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return begun.load();
  };
  for (const Json& result : run_jobs(2, 2, job, unheard)) EXPECT_EQ(result, 2);
}

TEST(Jobs, NoneIsFine) {
  EXPECT_TRUE(run_jobs(
                  0, 2, [](std::size_t) { return Json(); }, unheard)
                  .empty());
}

// Also after a step on several threads of this one.
TEST(Jobs, MayUseThreadsOfTheirOwn) {
  const auto norm = [](std::size_t) -> Json {
    const ThreadScope scope(2);
    return largest_norm(SplitStages{SplitMatrix(Matrix::Identity(64, 64))});
  };
  EXPECT_EQ(norm(0), 8.0);
  for (const Json& result : run_jobs(4, 2, norm, unheard)) EXPECT_EQ(result, 8.0);
}

TEST(Jobs, AFailureEndsThemAndIsPassedOn) {
  for (const long threads : {1, 2}) {
    std::size_t finished = 0;
    const auto job = [](std::size_t k) -> Json {
      if (k == 3) throw std::runtime_error("job 3 failed");
      return k;
    };
    try {
      run_jobs(100000, threads, job, [&](std::size_t) { ++finished; });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "job 3 failed");
    }
    EXPECT_LT(finished, 100000U);
  }
}

}  // namespace
}  // namespace isosyrk::testing
