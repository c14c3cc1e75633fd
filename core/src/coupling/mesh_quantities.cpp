#include "coupling/mesh_quantities.hpp"

#include <algorithm>

namespace pileus::coupling {
namespace {

constexpr std::size_t read_ahead = 8;

/// Room for a population that grows, so that most steps allocate nothing.
void provide(AlignedArray<double>& array, std::size_t parcels) {
  if (array.size() < parcels + read_ahead)
    array.discard_and_resize(parcels + parcels / 8 + read_ahead);
}

/// The lane of a record that holds value number `value`.
int first_lane(bool of_flow) {
  return of_flow ? 0 : 1;
}

}  // namespace

MeshSlot MeshQuantities::find(bool of_flow, int source, bool at_parcels) {
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    Field& field = fields_[f];
    if (field.of_flow != of_flow) continue;
    for (std::size_t l = 0; l < field.lanes.size(); ++l) {
      if (field.lanes[l].source != source) continue;
      field.lanes[l].at_parcels = field.lanes[l].at_parcels || at_parcels;
      return {static_cast<int>(f), static_cast<int>(l), at_parcels};
    }
  }
  return {};
}

MeshSlot MeshQuantities::add(std::string_view name, int column, bool at_parcels) {
  const bool of_flow = column < 0;
  const int source = of_flow ? access_.find_flow_quantity(name) : column;
  if (source < 0) return {};
  if (const MeshSlot known = find(of_flow, source, at_parcels); known.exists()) return known;
  const auto room = static_cast<std::size_t>(access_.record_width() - first_lane(of_flow));
  const auto fitting = std::find_if(fields_.begin(), fields_.end(), [&](const Field& field) {
    return field.of_flow == of_flow && field.lanes.size() < room;
  });
  if (fitting == fields_.end()) {
    Field& field = fields_.emplace_back();
    field.of_flow = of_flow;
    field.records.discard_and_resize(access_.nodes() *
                                     static_cast<std::size_t>(access_.record_width()));
    field.records.fill(0.0);
    field.lanes.push_back({source, at_parcels, {}});
  } else {
    fitting->lanes.push_back({source, at_parcels, {}});
  }
  return find(of_flow, source, at_parcels);
}

/// Every field depends on where the parcels are and on their shapes and volumes; the flow also on
/// the vorticity. All of these are the columns before the first scalar.
std::uint64_t MeshQuantities::version_of(const Field& field,
                                         const std::vector<std::uint64_t>& versions) const {
  std::uint64_t version = 0;
  for (int c = 0; c < store_.first_scalar(); ++c)
    version = std::max(version, versions[static_cast<std::size_t>(c)]);
  if (field.of_flow) return version;
  for (const Lane& lane : field.lanes)
    version = std::max(version, versions[static_cast<std::size_t>(lane.source)]);
  return version;
}

void MeshQuantities::make(Field& field) {
  double* records = field.records.data();
  if (field.of_flow) {
    for (std::size_t l = 0; l < field.lanes.size(); ++l)
      access_.copy_flow_quantity(field.lanes[l].source, records, static_cast<int>(l));
  } else {
    gathered_.clear();
    for (const Lane& lane : field.lanes) gathered_.push_back(store_.column(lane.source));
    access_.deposit(gathered_, records);
    access_.mirror(records);
  }
  const auto at_parcels = [](const Lane& lane) { return lane.at_parcels; };
  if (std::none_of(field.lanes.begin(), field.lanes.end(), at_parcels)) return;
  wanted_.clear();
  for (Lane& lane : field.lanes) {
    provide(lane.values, store_.size());
    // The volume's lane comes first in a gathered record; whoever follows overwrites its values.
    if (wanted_.empty() && !field.of_flow) wanted_.push_back(lane.values.data());
    wanted_.push_back(lane.values.data());
  }
  access_.interpolate(records, wanted_);
}

void MeshQuantities::update(const std::vector<MeshSlot>& slots,
                            const std::vector<std::uint64_t>& versions) {
  for (const MeshSlot& slot : slots) {
    Field& field = fields_[static_cast<std::size_t>(slot.field)];
    const std::uint64_t version = version_of(field, versions);
    if (version <= field.made_at) continue;
    if (field.of_flow && version > flow_at_) {
      access_.evaluate_flow();
      flow_at_ = version;
    }
    make(field);
    field.made_at = version;
  }
}

void MeshQuantities::show(const MeshSlot& slot, std::size_t begin, std::size_t count,
                          pileus_view& view) const {
  const Field& field = fields_[static_cast<std::size_t>(slot.field)];
  const Lane& lane = field.lanes[static_cast<std::size_t>(slot.lane)];
  view.data = nullptr;
  view.count = 0;
  if (field.made_at == 0) return;
  if (slot.at_parcels) {
    view.data = const_cast<double*>(lane.values.data()) + begin;  // lent for reading
    view.count = static_cast<std::int64_t>(count);
    return;
  }
  const double* first = field.records.data() + slot.lane + first_lane(field.of_flow);
  view.data = const_cast<double*>(first);
  view.count = static_cast<std::int64_t>(access_.nodes());
  view.stride = access_.record_width() * static_cast<std::int64_t>(sizeof(double));
}

std::size_t MeshQuantities::allocated_bytes() const {
  std::size_t bytes = 0;
  for (const Field& field : fields_) {
    bytes += field.records.allocated_bytes();
    for (const Lane& lane : field.lanes) bytes += lane.values.allocated_bytes();
  }
  return bytes;
}

}  // namespace pileus::coupling
