// conform_main LIBRARY CHECK…: holds a plugin to some of the checks of `pileus conform`, in a core
// of the next minor.
#include <iostream>

#include "base/error.hpp"
#include "conform/conform.hpp"

int main(int count, char** words) {
  if (count < 3) return 2;
  try {
    const pileus::conform::Request request{words[1], {words + 2, words + count}};
    const pileus::conform::Report report = pileus::conform::conform(request);
    std::cout << pileus::conform::render(report);
    return report.count(pileus::conform::Verdict::failed) == 0 ? 0 : 3;
  } catch (const pileus::Error& error) {
    std::cerr << error.what() << '\n';
    return static_cast<int>(error.code());
  }
}
