#include <algorithm>

#include "base/parallel.hpp"
#include "coupling/operator_sequence.hpp"

namespace pileus::coupling {
namespace {

/// Total over all parcels, added in an order that depends on their number alone.
double total_of(const parcels::Store& store, const parcels::Scalar& scalar) {
  const double* x = store.scalar(store.find_scalar(scalar.name));
  const double* volume = store.volume();
  const bool per_volume = scalar.nature == parcels::Nature::intensive;
  const CompensatedSum sum = ordered_reduce(
      store.size(), CompensatedSum{},
      [&](std::size_t begin, std::size_t end) {
        CompensatedSum part;
        for (std::size_t i = begin; i < end; ++i) part.add(per_volume ? volume[i] * x[i] : x[i]);
        return part;
      },
      [](CompensatedSum a, const CompensatedSum& b) {
        a.add(b.value());
        return a;
      });
  return sum.value();
}

/// Multiplicity times value of all items, in the unit of budgets.
double total_of_items(const parcels::ItemLists& items, int column) {
  const std::int64_t* multiplicity = items.multiplicity();
  const double* x = items.column(column);
  const CompensatedSum sum = ordered_reduce(
      items.size(), CompensatedSum{},
      [&](std::size_t begin, std::size_t end) {
        CompensatedSum part;
        for (std::size_t i = begin; i < end; ++i)
          part.add(static_cast<double>(multiplicity[i]) * x[i]);
        return part;
      },
      [](CompensatedSum a, const CompensatedSum& b) {
        a.add(b.value());
        return a;
      });
  return sum.value() / items.budget_scale();
}

}  // namespace

Ledger OperatorSequence::ledger() const {
  Ledger ledger;
  for (std::size_t which = 0; which < operators_.size(); ++which) {
    const host::OperatorTable& table = *operators_[which].table;
    OperatorLedger entry;
    entry.name = operators_[which].name;
    entry.id = table.op.id;
    entry.version = table.op.version;
    entry.closure = table.op.form == PILEUS_CLOSURE;
    OperatorCounts counts;
    const auto collect = [&](const Workspace& work) {
      if (which >= work.applied.size()) return;
      counts.add(work.applied[which]);
      counts.add(work.diagnosed[which]);
      entry.applied += work.applied[which].parcels;
      entry.apply_seconds += work.applied[which].seconds;
    };
    for (const Workspace& work : workspaces_) collect(work);
    collect(whole_);
    entry.calls = counts.calls;
    entry.parcels = counts.parcels;
    entry.skipped_by_epoch = counts.skipped_by_epoch;
    entry.skipped_by_bounds = counts.skipped_by_bounds;
    entry.skipped_by_list = counts.skipped_by_list;
    entry.audited = counts.audited;
    entry.retries = counts.retries;
    entry.core_seconds = counts.seconds;
    for (std::size_t b = 0; b < table.budgets.size() && which < progress_.size(); ++b) {
      entry.budgets.push_back({table.budgets[b], progress_[which].change[b].value(),
                               progress_[which].source[b].value()});
    }
    if (which < bound_.size()) {
      entry.spans = bound_[which].instance->spans();
      entry.repairs = bound_[which].instance->repairs();
    }
    ledger.operators.push_back(std::move(entry));
  }
  if (store_ == nullptr) return ledger;
  const auto add_to_total = [&](const std::string& budget, double amount) {
    auto found = std::find_if(ledger.totals.begin(), ledger.totals.end(),
                              [&](const BudgetTotal& t) { return t.budget == budget; });
    if (found == ledger.totals.end()) found = ledger.totals.insert(found, {budget, 0.0});
    found->total += amount;
  };
  for (const parcels::Scalar& scalar : store_->scalars())
    if (!scalar.budget.empty() && scalar.nature != parcels::Nature::derived)
      add_to_total(scalar.budget, total_of(*store_, scalar));
  const parcels::ItemLists& items = store_->items();
  for (std::size_t c = 0; c < items.declaration().columns.size(); ++c)
    if (const std::string& budget = items.declaration().columns[c].budget; !budget.empty())
      add_to_total(budget, total_of_items(items, static_cast<int>(c)));
  return ledger;
}

std::vector<double> OperatorSequence::books() const {
  std::vector<double> numbers;
  for (const OperatorProgress& progress : progress_) {
    for (std::size_t b = 0; b < progress.change.size(); ++b) {
      for (const CompensatedSum* sum : {&progress.change[b], &progress.source[b]}) {
        numbers.push_back(sum->total());
        numbers.push_back(sum->correction());
      }
    }
  }
  for (const OperatorProgress& progress : progress_) numbers.push_back(progress.step_limit);
  return numbers;
}

void OperatorSequence::restore_books(const std::vector<double>& books) {
  std::size_t at = 0;
  for (OperatorProgress& progress : progress_) {
    for (std::size_t b = 0; b < progress.change.size(); ++b) {
      for (CompensatedSum* sum : {&progress.change[b], &progress.source[b]}) {
        if (at + 2 > books.size()) return;
        *sum = CompensatedSum(books[at], books[at + 1]);
        at += 2;
      }
    }
  }
  for (OperatorProgress& progress : progress_)
    if (at < books.size()) progress.step_limit = books[at++];
}

}  // namespace pileus::coupling
