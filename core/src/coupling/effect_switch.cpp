// Effects of the operator sequence that wait, and how they are switched on.
#include <algorithm>

#include "coupling/operator_sequence.hpp"

namespace pileus::coupling {

bool OperatorSequence::activate(const std::string& effect) {
  bool found = false;
  for (std::size_t which = 0; which < operators_.size(); ++which) {
    OperatorEntry& entry = operators_[which];
    bool mine = false;
    for (std::size_t i = 0; i < entry.effects.size(); ++i) {
      if (entry.effects[i] != EffectState::watched || effect != entry.table->effects[i].name)
        continue;
      entry.effects[i] = EffectState::on;
      mine = true;
    }
    if (!mine || which >= bound_.size()) continue;
    follow_effects(bound_[which]);
    progress_[which].diagnosed_at = progress_[which].demanded_at = 0;
    progress_[which].idle_at = 0;
    found = true;
  }
  return found;
}

/// What a watched effect would derive is nothing until it is switched on; zeros stand for it in
/// outputs and for operators that read it.
void OperatorSequence::clear_withheld() {
  if (!withheld_stale_) return;
  withheld_stale_ = false;
  for (const BoundOperator& bound : bound_) {
    for (const std::size_t s : bound.derived) {
      if (bound.dormant || bound.slots[s].withheld) {
        std::fill_n(store_->column(bound.slots[s].column), store_->size(), 0.0);
      }
    }
  }
}

}  // namespace pileus::coupling
