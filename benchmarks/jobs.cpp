#include "benchmarks/jobs.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "isosyrk/split/parallel.h"

namespace isosyrk {
namespace {

using Json = nlohmann::ordered_json;
using Job = std::function<Json(std::size_t)>;

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

// The next job to begin, in memory that children share.
class SharedCounter {
 public:
  SharedCounter() {
    void* memory =
        mmap(nullptr, sizeof(Counter), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw_errno("mmap");
    counter_ = new (memory) Counter(0);
  }
  ~SharedCounter() { munmap(counter_, sizeof(Counter)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  std::size_t take() { return (*counter_)++; }
  void exhaust(std::size_t count) { *counter_ = count; }

 private:
  using Counter = std::atomic<std::size_t>;
  static_assert(Counter::is_always_lock_free);
  Counter* counter_;
};

void write_all(int pipe, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(pipe, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) _exit(1);  // nobody listens any more
    done += static_cast<std::size_t>(written);
  }
}

// A child whose parent is killed would work on for nobody: its brothers hold the pipe open.
void end_with(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it was killed before
}

// What a child does: one line of JSON for each job.
void work(std::size_t count, SharedCounter& next, const Job& job, int pipe) {
  for (std::size_t k = next.take(); k < count; k = next.take()) {
    Json line = {{"job", k}};
    try {
      line["result"] = job(k);
    } catch (const std::exception& error) {
      next.exhaust(count);
      line["failure"] = error.what();
    }
    write_all(pipe, line.dump() + "\n");
  }
}

// A child and what it has written so far.
class Worker {
 public:
  Worker(std::size_t count, SharedCounter& next, const Job& job) {
    int ends[2];
    if (pipe(ends) != 0) throw_errno("pipe");
    const pid_t parent = getpid();
    child_ = fork();
    if (child_ < 0) throw_errno("fork");
    if (child_ == 0) {
      end_with(parent);
      close(ends[0]);
      work(count, next, job, ends[1]);
      _exit(0);  // what the parent will destroy is not ours to destroy
    }
    close(ends[1]);
    read_end_ = ends[0];
  }
  ~Worker() {
    close(read_end_);
    waitpid(child_, nullptr, 0);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  int read_end() const { return read_end_; }
  bool ended() const { return ended_; }

  /// Reads what has come and hands every whole line on.
  void receive(const std::function<void(const std::string&)>& take_line) {
    char block[65536];
    const ssize_t got = read(read_end_, block, sizeof block);
    if (got < 0 && errno == EINTR) return;
    if (got <= 0) {
      ended_ = true;
      return;
    }
    text_.append(block, static_cast<std::size_t>(got));
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      take_line(text_.substr(0, end));
      text_.erase(0, end + 1);
    }
  }

 private:
  pid_t child_ = -1;
  int read_end_ = -1;
  bool ended_ = false;
  std::string text_;
};

}  // namespace

std::vector<Json> run_jobs(std::size_t count, long processes, const Job& job,
                           const std::function<void(std::size_t)>& finished) {
  std::vector<Json> results(count);
  if (processes == 1) {
    for (std::size_t k = 0; k < count; ++k) {
      results[k] = job(k);
      finished(k);
    }
    return results;
  }
  if (has_run_in_parallel()) {
    throw std::logic_error("run_jobs: after a step on several threads, those of a child would hang");
  }
  SharedCounter next;
  std::vector<std::unique_ptr<Worker>> workers;
  for (long p = 0; p < processes; ++p)
    workers.push_back(std::make_unique<Worker>(count, next, job));

  std::size_t done = 0;
  std::string failure;
  const auto take_line = [&](const std::string& text) {
    Json line = Json::parse(text);
    const auto k = line["job"].get<std::size_t>();
    ++done;
    if (line.contains("failure")) {
      if (failure.empty()) failure = line["failure"].get<std::string>();
      return;
    }
    results[k] = std::move(line["result"]);
    finished(k);
  };
  while (!workers.empty()) {
    std::vector<pollfd> waiting;
    for (const auto& worker : workers) waiting.push_back({worker->read_end(), POLLIN, 0});
    if (poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) throw_errno("poll");
    for (std::size_t p = 0; p < waiting.size(); ++p) {
      if (waiting[p].revents != 0) workers[p]->receive(take_line);
    }
    std::erase_if(workers, [](const auto& worker) { return worker->ended(); });
  }
  if (!failure.empty()) throw std::runtime_error(failure);
  if (done < count) {
    throw std::runtime_error(
        fmt::format("a child process was lost: {} of {} jobs done", done, count));
  }
  return results;
}

}  // namespace isosyrk
