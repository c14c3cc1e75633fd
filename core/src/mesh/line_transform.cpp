#include "mesh/line_transform.hpp"

#include <fftw3.h>

#include <mutex>
#include <numbers>
#include <utility>

#include "base/aligned_array.hpp"
#include "base/error.hpp"

namespace pileus::mesh {

namespace {

// FFTW's planner keeps global tables.
std::mutex& planner_lock() {
  static std::mutex lock;
  return lock;
}

fftw_complex* complex(double* p) {
  return reinterpret_cast<fftw_complex*>(p);
}

}  // namespace

struct LineTransform::Plans {
  fftw_plan forward = nullptr;
  fftw_plan backward = nullptr;

  Plans() = default;
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;
  ~Plans() {
    const std::lock_guard guard(planner_lock());
    if (forward != nullptr) fftw_destroy_plan(forward);
    if (backward != nullptr) fftw_destroy_plan(backward);
  }
};

LineTransform::LineTransform(int length, int batch)
    : length_(length), batch_(batch), plans_(std::make_unique<Plans>()) {
  if (length < 1 || batch < 1)
    throw Error(ExitCode::usage, "A Fourier transform needs at least one point and one line.");
  AlignedArray<double> in(doubles()), out(doubles());
  const std::lock_guard guard(planner_lock());
  const auto plan = [&](int sign) {
    return fftw_plan_many_dft(1, &length_, batch_, complex(in.data()), nullptr, batch_, 1,
                              complex(out.data()), nullptr, batch_, 1, sign,
                              FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
  };
  plans_->forward = plan(FFTW_FORWARD);
  plans_->backward = plan(FFTW_BACKWARD);
  if (plans_->forward == nullptr || plans_->backward == nullptr)
    throw Error(ExitCode::numerical,
                "FFTW has no plan for lines of " + std::to_string(length) + " points.");
}

LineTransform::~LineTransform() = default;
LineTransform::LineTransform(LineTransform&&) noexcept = default;
LineTransform& LineTransform::operator=(LineTransform&&) noexcept = default;

void LineTransform::forward(const double* in, double* out) const {
  fftw_execute_dft(plans_->forward, complex(const_cast<double*>(in)), complex(out));
}

void LineTransform::backward(const double* in, double* out) const {
  fftw_execute_dft(plans_->backward, complex(const_cast<double*>(in)), complex(out));
}

double derivative_wavenumber(int m, int n, double extent) {
  if (is_nyquist(m, n)) return 0;
  return 2 * std::numbers::pi * signed_index(m, n) / extent;
}

}  // namespace pileus::mesh
