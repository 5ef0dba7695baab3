#include "benchmarks/jobs.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "isosyrk/split/linear_combination.h"

namespace isosyrk::testing {
namespace {

using Json = nlohmann::ordered_json;

const auto unheard = [](std::size_t) {};

// One sweep over an unknown on so many threads.
double norm_on(int threads) {
  const ThreadScope scope(threads);
  return largest_norm(SplitStages{SplitMatrix(Matrix::Identity(64, 64))});
}

TEST(Jobs, MayUseThreadsInChildrenAndAreRefusedAfterThreadsHere) {
  const auto job = [](std::size_t) { return Json{{"norm", norm_on(2)}}; };
  EXPECT_EQ(norm_on(1), 8.0);
  for (const Json& result : run_jobs(4, 2, job, unheard)) EXPECT_EQ(result["norm"], 8.0);
  // In a process of its own, which the other tests do not share.
  const auto after_threads = [&] {
    norm_on(2);
    run_jobs(4, 2, job, unheard);
  };
  EXPECT_EXIT(
      {
        try {
          after_threads();
        } catch (const std::logic_error&) {
          std::_Exit(7);
        }
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(7), "");
}

TEST(Jobs, ResultsComeInOrderAndEachIsHeardOfOnce) {
  for (const long processes : {1, 2, 5}) {
    std::vector<int> heard(100);
    const auto results = run_jobs(
        heard.size(), processes,
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

TEST(Jobs, AResultLongerThanAPipeHolds) {
  const auto results = run_jobs(
      4, 2, [](std::size_t k) { return Json(std::string(1000000, static_cast<char>('a' + k))); },
      unheard);
  EXPECT_EQ(results[3].get<std::string>(), std::string(1000000, 'd'));
}

TEST(Jobs, NoneIsFine) {
  EXPECT_TRUE(run_jobs(
                  0, 2, [](std::size_t) { return Json(); }, unheard)
                  .empty());
}

TEST(Jobs, AFailureEndsThemAndIsPassedOn) {
  for (const long processes : {1, 2}) {
    std::size_t finished = 0;
    const auto job = [](std::size_t k) -> Json {
      if (k == 3) throw std::runtime_error("job 3 failed");
      return k;
    };
    try {
      run_jobs(100000, processes, job, [&](std::size_t) { ++finished; });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "job 3 failed");
    }
    EXPECT_LT(finished, 100000U);
  }
}

TEST(Jobs, AChildThatDiesIsNoticed) {
  const auto job = [](std::size_t k) -> Json {
    if (k == 5) _exit(7);
    return k;
  };
  EXPECT_THROW(run_jobs(50, 2, job, unheard), std::runtime_error);
}

TEST(Jobs, EndWithAParentThatIsKilled) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    const auto job = [&](std::size_t) -> Json {
      if (write(ends[1], "x", 1) == 1) pause();
      return {};
    };
    run_jobs(2, 2, job, unheard);
    _exit(0);
  }
  close(ends[1]);
  char begun = 0;
  for (int k = 0; k < 2; ++k) ASSERT_EQ(::read(ends[0], &begun, 1), 1);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  pollfd waiting{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&waiting, 1, 10000), 1) << "a job still holds its end";
  close(ends[0]);
}

}  // namespace
}  // namespace isosyrk::testing
