#include "coupling/item_extension.hpp"

#include <cstdio>
#include <new>
#include <vector>

#include "base/parallel.hpp"

namespace pileus::coupling {
namespace {

pileus_status refuse(pileus_error* error, const char* text, pileus_status status) {
  if (error != nullptr) std::snprintf(error->text, sizeof error->text, "%s", text);
  return status;
}

}  // namespace

ItemExtension::ItemExtension(parcels::Store& store) : store_(store) {
  table_.size = sizeof table_;
  table_.impl = this;
  table_.budget_scale = 1;
  table_.regroup = regroup;
}

/// A sentence on what is wrong with a call, or null.
const char* ItemExtension::complaint(const pileus_block* block, const std::int32_t* count,
                                     const std::int64_t* source) const {
  if (!show_ || omp_in_parallel())
    return "items are regrouped in init, or in apply by an operator of global scope that declares "
           "PILEUS_RESIZES_ITEMS, outside of its parallel loops";
  if (block == nullptr || count == nullptr) return "items were to be regrouped with a null pointer";
  if (block->count != static_cast<std::int64_t>(store_.size()))
    return "items were to be regrouped with a block that is not that of all parcels";
  const parcels::ItemLists& items = store_.items();
  std::int64_t total = 0;
  for (std::size_t p = 0; p < store_.size(); ++p) {
    if (count[p] < 0) return "a parcel was to get a negative number of items";
    total += count[p];
  }
  const auto size = static_cast<std::int64_t>(items.size());
  for (std::int64_t k = 0; source != nullptr && k < total; ++k)
    if (source[k] >= size) return "an item was to be a copy of one that does not exist";
  return nullptr;
}

pileus_status ItemExtension::regroup(const pileus_item_lists_ext* ext, const pileus_block* block,
                                     const std::int32_t* count, const std::int64_t* source,
                                     pileus_error* error) {
  auto& me = *static_cast<ItemExtension*>(ext->impl);
  if (const char* text = me.complaint(block, count, source))
    return refuse(error, text, PILEUS_E_INPUT);
  try {
    const std::size_t parcels = me.store_.size();
    std::size_t total = 0;
    for (std::size_t p = 0; p < parcels; ++p) total += static_cast<std::size_t>(count[p]);
    std::vector<std::int64_t> anew;
    if (source == nullptr) anew.assign(total, -1);
    me.store_.items().regroup({count, parcels}, {source != nullptr ? source : anew.data(), total});
    me.show_(const_cast<pileus_block&>(*block));
    return PILEUS_OK;
  } catch (const std::bad_alloc&) {
    return refuse(error, "out of memory for items", PILEUS_E_MEMORY);
  }
}

}  // namespace pileus::coupling
