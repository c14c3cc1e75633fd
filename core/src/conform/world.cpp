#include "conform/world.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "conform/small_mesh.hpp"

namespace pileus::conform {

World::World(const Case& subject, host::ParameterValues values, std::uint64_t seed, StateKind kind)
    : around_(subject, std::move(values)), seed_(seed), kind_(kind) {
  try {
    kind.dimension == 2 ? build<2>() : build<3>();
    bind_subject();
  } catch (const Error& error) {
    throw StateRefused{error.what()};
  }
}

World::~World() = default;

template <int D>
void World::build() {
  Random random(mix_bits(seed_));
  coupling::SequenceOptions options;
  options.initial = around_.initial();
  options.seed = seed_;
  try {
    sequence_ = std::make_unique<coupling::OperatorSequence>(around_.entries(), std::move(options));
  } catch (const Error&) {
    throw NotApplicable{"no run with this operator can be planned; C04 or C05 says why"};
  }
  store_ = std::make_unique<parcels::Store>(D, sequence_->required_scalars(),
                                            sequence_->required_items());
  std::array<int, D> cells{};
  std::array<double, D> origin{}, extent{};
  cells.fill(D == 3 ? 4 : 8);
  extent.fill(2000);
  const mesh::Grid<D> grid(cells, origin, extent);
  draw_population<D>(*store_, grid, random, kind_.corners);
  auto mesh = std::make_unique<SmallMesh<D>>(grid, *store_, seed_);
  mesh->reorder();
  mesh_ = std::move(mesh);
  grid_ = coupling::abi_grid(grid);
  sequence_->bind(*store_, grid_, mesh_.get());
  sequence_->init({0, 0, 0});
  if (around_.stands_in_for_maker()) fill_items(random);
  fill_surface(random);
}

/// A few items a parcel, some parcels without.
void World::fill_items(Random& random) {
  parcels::ItemLists& items = store_->items();
  std::vector<std::int32_t> count;
  std::size_t total = 0;
  for (std::size_t p = 0; p < population; ++p) {
    count.push_back(static_cast<std::int32_t>(random() % 8));
    total += static_cast<std::size_t>(count.back());
  }
  items.regroup(count, std::vector<std::int64_t>(total, -1));
  for (std::size_t k = 0; k < total; ++k)
    items.multiplicity()[k] = static_cast<std::int64_t>(draw_between(random, {1, 1e12}));
  for (std::size_t c = 0; c < items.declaration().columns.size(); ++c) {
    const parcels::ItemColumn& column = items.declaration().columns[c];
    const Range range = typical_range({column.low, column.high}, column.units, true, false);
    for (std::size_t k = 0; k < total; ++k)
      items.column(static_cast<int>(c))[k] = draw_between(random, range);
  }
}

void World::fill_surface(Random& random) {
  coupling::SurfaceFields& surface = sequence_->surface();
  for (const coupling::OperatorEntry& entry : sequence_->operators())
    for (const pileus_quantity& row : entry.table->quantities) {
      const int field = row.place == PILEUS_SURFACE ? surface.find(row.name) : -1;
      if (field < 0) continue;
      const Range range = typical_range({row.low, row.high}, row.units, false, false);
      for (double& value : surface.values(static_cast<std::size_t>(field)))
        value = draw_between(random, range);
    }
}

void World::bind_subject() {
  quantities_ = std::make_unique<coupling::MeshQuantities>(*mesh_, *store_);
  extension_ = std::make_unique<coupling::MeshExtension>(*mesh_, *store_);
  if (store_->items().exist()) {
    items_ = std::make_unique<coupling::ItemExtension>(*store_);
    items_->set_budget_scale(store_->items().budget_scale());
  }
  coupling::SurfaceFields& surface = sequence_->surface();
  bound_.push_back(coupling::bind_operator(subject_entry(), *store_, surface,
                                           {quantities_.get(), extension_.get(), items_.get()}, 7,
                                           nullptr));
  const auto versions = static_cast<std::size_t>(
      coupling::version_of_item(*store_, surface, coupling::item_quantities(*store_)));
  if (!bound_.front().mesh.empty())
    quantities_->update(bound_.front().mesh, std::vector<std::uint64_t>(versions, 1));
  runner_ = std::make_unique<coupling::BlockRunner>(bound_, *store_, surface, &*grid_,
                                                    quantities_.get(), items_.get());
  work_.reserve(bound_, std::max(store_->size(), coupling::block_parcels));
  work_.reserve_surface(bound_, surface.columns());
}

host::Lent World::lent() const {
  const coupling::BoundOperator& subject = bound_.front();
  const bool lend_items = (subject.creates_items || subject.resizes_items) && items_ != nullptr;
  return {nullptr, subject.is_local() ? nullptr : extension_->table(),
          lend_items ? items_->table() : nullptr};
}

pileus_block World::whole(coupling::Derived what) {
  return runner_->block(0, {-1, 0, store_->size()}, what, work_);
}

}  // namespace pileus::conform
