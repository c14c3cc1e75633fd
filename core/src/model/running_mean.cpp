#include "model/running_mean.hpp"

namespace pileus::model {

void RunningMean::go_to(double time) {
  if (!(time > now_.latest)) return;
  before_ = now_;
  now_.latest = time;
}

void RunningMean::add(double time, std::span<const double> sample) {
  go_to(time);
  // Not added to zeros: these would turn −0 into 0.
  if (now_.samples == 0)
    now_.sum.assign(sample.begin(), sample.end());
  else
    for (std::size_t i = 0; i < sample.size(); ++i) now_.sum[i] += sample[i];
  ++now_.samples;
}

void RunningMean::clear(double time) {
  go_to(time);
  now_.samples = 0;
}

void RunningMean::mean(std::vector<double>& result) const {
  result = now_.sum;
  for (double& value : result) value /= static_cast<double>(now_.samples);
}

void RunningMean::save(output::NamedData& data, const std::string& name, double time) const {
  const State& state = now_.latest >= time ? before_ : now_;
  data.arrays[name + "/sum"] = state.samples > 0 ? state.sum : std::vector<double>();
  data.arrays[name + "/latest"] = {state.latest};
  data.counters[name + "/samples"] = {state.samples};
}

void RunningMean::restore(const output::NamedData& data, const std::string& name,
                          std::size_t size) {
  const auto sum = data.arrays.find(name + "/sum");
  const auto latest = data.arrays.find(name + "/latest");
  const auto samples = data.counters.find(name + "/samples");
  if (sum == data.arrays.end() || latest == data.arrays.end() || samples == data.counters.end())
    return;
  if (latest->second.size() != 1 || samples->second.size() != 1) return;
  if (samples->second[0] > 0 && sum->second.size() != size) return;
  now_ = {sum->second, samples->second[0], latest->second[0]};
  before_ = now_;
}

}  // namespace pileus::model
