// The extension "pileus.item_lists/1" over the lists of a store.
#pragma once
#include <functional>
#include <utility>

#include "parcels/store.hpp"
#include "pileus/abi.h"

namespace pileus::coupling {

/// Does not move: plugins keep the address of the table.
class ItemExtension {
 public:
  /// `store` must outlive this.
  explicit ItemExtension(parcels::Store& store);
  ItemExtension(const ItemExtension&) = delete;
  ItemExtension& operator=(const ItemExtension&) = delete;

  const pileus_item_lists_ext* table() const { return &table_; }
  void set_budget_scale(double scale) { table_.budget_scale = scale; }

  /// Brings a record and its views up to date with new lists.
  using Show = std::function<void(pileus_block&)>;
  /// Items may be regrouped, by the operator of the running call, as long as this lives.
  class Permission {
   public:
    Permission(ItemExtension* extension, Show show) : extension_(extension) {
      if (extension_ != nullptr) extension_->show_ = std::move(show);
    }
    ~Permission() {
      if (extension_ != nullptr) extension_->show_ = nullptr;
    }
    Permission(const Permission&) = delete;
    Permission& operator=(const Permission&) = delete;

   private:
    ItemExtension* extension_;
  };

 private:
  static pileus_status regroup(const pileus_item_lists_ext* ext, const pileus_block* block,
                               const std::int32_t* count, const std::int64_t* source,
                               pileus_error* error);
  const char* complaint(const pileus_block* block, const std::int32_t* count,
                        const std::int64_t* source) const;

  parcels::Store& store_;
  pileus_item_lists_ext table_{};
  Show show_;  // empty: not now
};

}  // namespace pileus::coupling
