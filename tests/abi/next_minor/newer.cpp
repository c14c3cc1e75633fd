// A plugin built with the header of the next minor (header.py). It uses a member of the host that
// is new there, and does without where the program does not have it.
#include <pileus/plugin.hpp>

#define MODULE_ID "org.example.newer"

namespace {

void introduce(pileus::Declaration& d) {
  d.op.kind = "test";
  d.op.version = "1.0.0";
  d.op.title = "Newer";
  d.op.summary = "Uses what a newer program has.";
  d.op.authors = "Pileus contributors";
  d.op.licence = "Apache-2.0";
  d.op.form = PILEUS_FLOW;
  d.cites(nullptr, "no reference: a test of the plugin interface");
}

/// dc/dt = what the host answers, or a quarter where it cannot be asked.
class Growth : public pileus::Operator<Growth> {
  pileus::Slot tracer_;
  double rate_ = 0.25;

 public:
  void describe(pileus::Declaration& d) {
    introduce(d);
    d.op.id = MODULE_ID ".growth";
    tracer_ = d.owns("passive_tracer", "1").intensive().range(0, 100).initial(1);
  }
  void configured() {
    if (PILEUS_HAS(&host(), pileus_host, appended_member) && host().appended_member != nullptr)
      rate_ = static_cast<double>(host().appended_member(&host()));
  }
  void apply(const pileus_step& step, pileus::Block block) const {
    double* c = block.out(tracer_);
    block.each([&](auto p) { c[p] += rate_ * step.dt; });
  }
};

/// Fails in a loop over all threads: its error records are longer than those of an older core.
class FailingLoop : public pileus::Operator<FailingLoop> {
  pileus::Slot tracer_;

 public:
  void describe(pileus::Declaration& d) {
    introduce(d);
    d.op.id = MODULE_ID ".failing_loop";
    d.op.scope = PILEUS_GLOBAL;
    tracer_ = d.owns("passive_tracer", "1").intensive().range(0, 100).initial(1);
  }
  void apply(const pileus_step&, pileus::Block block) const {
    parallel_for(block.count(), [&](std::int64_t p) {
      if (p == 1) throw pileus::Failure("the loop fails here").at(block.uid(p), tracer_.index, 7);
    });
  }
};

}  // namespace

PILEUS_MODULE(MODULE_ID, "1.0.0", Growth::table(), FailingLoop::table());
