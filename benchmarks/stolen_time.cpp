#include "benchmarks/stolen_time.h"

#include <unistd.h>

#include <fstream>
#include <string>

namespace isosyrk {

double stolen_seconds(std::istream& stat, double ticks) {
  std::string all;
  double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0, steal = 0;
  stat >> all >> user >> nice >> system >> idle >> iowait >> irq >> softirq >> steal;
  return stat && all == "cpu" && steal > 0 ? steal / ticks : 0.0;
}

double stolen_seconds() {
  std::ifstream stat("/proc/stat");
  return stolen_seconds(stat, static_cast<double>(sysconf(_SC_CLK_TCK)));
}

}  // namespace isosyrk
