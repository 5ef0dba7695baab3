#include "benchmarks/stolen_time.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

namespace isosyrk {

std::vector<ProcessorTime> processor_times(std::istream& stat, double ticks) {
  std::vector<ProcessorTime> times;
  for (std::string line; std::getline(stat, line);) {
    std::istringstream words(line);
    std::string name;
    double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0, steal = 0;
    words >> name >> user >> nice >> system >> idle >> iowait >> irq >> softirq >> steal;
    // The first line, "cpu", has the sums over all.
    if (!words || name.rfind("cpu", 0) != 0 || name == "cpu" || steal < 0) continue;
    times.push_back({(user + nice + system + irq + softirq) / ticks, steal / ticks});
  }
  return times;
}

std::vector<ProcessorTime> processor_times() {
  std::ifstream stat("/proc/stat");
  return processor_times(stat, static_cast<double>(sysconf(_SC_CLK_TCK)));
}

double stolen_seconds(const std::vector<ProcessorTime>& before,
                      const std::vector<ProcessorTime>& after, int count) {
  std::vector<ProcessorTime> between;
  for (std::size_t each = 0; each < std::min(before.size(), after.size()); ++each) {
    between.push_back(
        {after[each].worked - before[each].worked, after[each].stolen - before[each].stolen});
  }
  std::sort(between.begin(), between.end(),
            [](const ProcessorTime& a, const ProcessorTime& b) { return a.worked > b.worked; });
  double sum = 0;
  for (std::size_t each = 0; each < between.size() && static_cast<int>(each) < count; ++each) {
    sum += between[each].stolen;
  }
  return sum;
}

}  // namespace isosyrk
