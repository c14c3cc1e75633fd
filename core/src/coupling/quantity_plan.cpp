#include "coupling/quantity_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string_view>

#include "base/error.hpp"
#include "base/quantities.hpp"
#include "coupling/mesh_access.hpp"
#include "mesh/flow_quantities.hpp"

namespace pileus::coupling {
namespace {

/// A declaration of one quantity by one operator.
struct Claim {
  const OperatorEntry* by;
  const pileus_quantity* row;
  bool creates() const { return (row->access & PILEUS_CREATE) != 0; }
  bool optional() const { return (row->access & PILEUS_OPTIONAL) != 0; }
};

/// Claims by name, names in the order of their first appearance.
struct Claims {
  std::vector<std::string> names;
  std::map<std::string, std::vector<Claim>> of;

  bool know(const std::string& name) const { return of.find(name) != of.end(); }
  void add(const Claim& claim) {
    if (!know(claim.row->name)) names.emplace_back(claim.row->name);
    of[claim.row->name].push_back(claim);
  }
};

class Planner {
 public:
  Planner(const std::vector<OperatorEntry>& operators, const std::vector<std::string>& initial)
      : operators_(operators), initial_(initial.begin(), initial.end()) {}

  QuantityPlan plan() {
    collect();
    keep_those_called_for();
    for (const std::string& name : initial_) check_name(name, "the initial state");
    QuantityPlan plan;
    if (!claims_.know(buoyancy_name)) {
      plan.scalars.push_back(passive(buoyancy_name));
    }
    for (const std::string& name : claims_.names) plan.scalars.push_back(unite(name));
    for (const std::string& name : initial_) {
      if (!claims_.know(name) && name != buoyancy_name && !owned_on_surface(name)) {
        plan.scalars.push_back(passive(name));
      }
    }
    for (const std::string& name : surface_claims_.names) {
      plan.surface.push_back(unite_on_surface(name));
    }
    plan.items = unite_items();
    plan.closures = order_closures();
    if (!problems_.empty()) throw Error(ExitCode::usage, problems_);
    return plan;
  }

 private:
  void complain(const std::string& text) { problems_ += (problems_.empty() ? "" : "\n") + text; }

  void collect() {
    for (const OperatorEntry& entry : operators_) {
      const host::OperatorTable& table = *entry.table;
      for (std::size_t i = 0; i < table.quantities.size(); ++i) {
        const pileus_quantity& row = table.quantities[i];
        if (!entry.exists(i)) continue;
        if (!check_support(entry, row)) continue;
        if (row.place == PILEUS_PARCEL || row.place == PILEUS_MESH ||
            row.place == PILEUS_MESH_AT_PARCEL) {
          if (is_core_quantity(row.name)) continue;
        }
        check_units(entry, row);
        if (row.place == PILEUS_DOMAIN) continue;
        if (row.place == PILEUS_SURFACE) {
          surface_claims_.add({&entry, &row});
        } else if (row.place == PILEUS_ITEM) {
          item_claims_.add({&entry, &row});
        } else if (row.place == PILEUS_PARCEL || !mesh::is_flow_quantity(row.name)) {
          claims_.add({&entry, &row});
        }
      }
    }
  }

  /// Optional quantities that nobody else brings about do not exist.
  void keep_those_called_for() {
    std::erase_if(claims_.names, [&](const std::string& name) {
      const std::vector<Claim>& claims = claims_.of.at(name);
      const bool unwanted =
          initial_.count(name) == 0 &&
          std::all_of(claims.begin(), claims.end(), [](const Claim& c) { return c.optional(); });
      if (unwanted) claims_.of.erase(name);
      return unwanted;
    });
  }

  bool check_support(const OperatorEntry& entry, const pileus_quantity& row) {
    const auto refuse = [&](const char* what) {
      complain(fmt::format("operator '{}' declares '{}' {}, which this version does not offer",
                           entry.name, row.name, what));
      return false;
    };
    if (row.place == PILEUS_SURFACE) return check_surface_support(entry, row);
    if (row.place == PILEUS_ITEM) return true;  // the plugin's table has been checked
    if (row.place == PILEUS_DOMAIN) return check_domain_support(entry, row);
    const bool on_mesh = row.place == PILEUS_MESH || row.place == PILEUS_MESH_AT_PARCEL;
    if (row.place != PILEUS_PARCEL && !on_mesh) {
      return refuse("elsewhere than on the parcels, the surface or the mesh");
    }
    if (on_mesh && entry.table->op.diagnose != nullptr) {
      return refuse("on the mesh, and derives quantities in every stage,");
    }
    if (row.type != PILEUS_F64 || row.components != 1) {
      return refuse("as something other than one double-precision number per parcel");
    }
    if (row.nature == PILEUS_LABEL) return refuse("as a label");
    if (row.on_merge != PILEUS_RULE_DEFAULT || row.on_split != PILEUS_RULE_DEFAULT) {
      return refuse("with a merge or split rule of its own");
    }
    if (row.nature == PILEUS_INTENSIVE && std::string_view(row.weight) != volume_name) {
      return refuse("with a weight other than the volume");
    }
    return true;
  }

  bool check_surface_support(const OperatorEntry& entry, const pileus_quantity& row) {
    const auto refuse = [&](const char* why) {
      complain(
          fmt::format("operator '{}' declares '{}' on the surface {}", entry.name, row.name, why));
      return false;
    };
    if (row.type != PILEUS_F64 || row.components != 1) {
      return refuse("as something other than one double-precision number per column of cells");
    }
    if ((row.access & PILEUS_WRITE) != 0 && (row.access & PILEUS_CREATE) == 0)
      return refuse("to overwrite it; only its owner does, others add to it");
    const bool adds = (row.access & (PILEUS_ADD | PILEUS_CREATE)) != 0;
    if (adds && entry.table->op.scope != PILEUS_GLOBAL) {
      return refuse(
          "to change it from blocks that run side by side, in no fixed order; its scope has to be "
          "global");
    }
    return true;
  }

  bool check_domain_support(const OperatorEntry& entry, const pileus_quantity& row) {
    const auto refuse = [&](const std::string& why) {
      complain(
          fmt::format("operator '{}' declares '{}' of the domain {}", entry.name, row.name, why));
      return false;
    };
    const std::string_view name = row.name;
    const bool wind = name == mean_wind_names[0] || name == mean_wind_names[1];
    if (!wind && name != coriolis_parameter_name)
      return refuse(fmt::format("; there are {}, {} and {}", mean_wind_names[0], mean_wind_names[1],
                                coriolis_parameter_name));
    if (row.type != PILEUS_F64 || row.components != 1)
      return refuse("as something other than one double-precision number");
    if ((row.access & PILEUS_WRITE) == 0) return true;
    if (!wind) return refuse("to overwrite it; it is the scene's");
    if (entry.table->op.scope != PILEUS_GLOBAL)
      return refuse("to change it from blocks that run side by side; its scope has to be global");
    return true;
  }

  void check_name(const std::string& name, const std::string& who) {
    if (find_quantity(name) != nullptr) return;
    const std::string nearest = nearest_quantity(name);
    complain(fmt::format("{} names the quantity '{}', which is not registered{}", who, name,
                         nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }

  void check_units(const OperatorEntry& entry, const pileus_quantity& row) {
    const std::string who = fmt::format("operator '{}'", entry.name);
    check_name(row.name, who);
    const Quantity* known = find_quantity(row.name);
    if (known != nullptr && known->units != row.units) {
      complain(fmt::format("{} declares '{}' in '{}', registered is '{}'", who, row.name, row.units,
                           known->units));
    }
  }

  static parcels::Scalar passive(const std::string& name) {
    const Quantity* known = find_quantity(name);
    parcels::Scalar scalar;
    scalar.name = name;
    scalar.units = known != nullptr ? known->units : "1";
    scalar.low = std::numeric_limits<double>::lowest();
    scalar.high = std::numeric_limits<double>::max();
    return scalar;
  }

  static parcels::Nature nature_of(std::uint32_t nature) {
    return nature == PILEUS_EXTENSIVE ? parcels::Nature::extensive
           : nature == PILEUS_DERIVED ? parcels::Nature::derived
                                      : parcels::Nature::intensive;
  }

  const Claim* find_owner(const std::string& name, const std::vector<Claim>& claims) {
    const Claim* owner = nullptr;
    for (const Claim& claim : claims) {
      if (claim.creates()) {
        if (owner != nullptr) {
          complain(fmt::format("'{}' is owned by both '{}' and '{}'; remove one of the two", name,
                               owner->by->name, claim.by->name));
        }
        owner = &claim;
      }
    }
    return owner;
  }

  /// What the initial state may set of the ground.
  bool owned_on_surface(const std::string& name) const {
    if (!surface_claims_.know(name)) return false;
    const std::vector<Claim>& claims = surface_claims_.of.at(name);
    return std::any_of(claims.begin(), claims.end(), [](const Claim& c) { return c.creates(); });
  }

  SurfaceQuantity unite_on_surface(const std::string& name) {
    const std::vector<Claim>& claims = surface_claims_.of.at(name);
    if (is_core_quantity(name) || claims_.know(name) ||
        (initial_.count(name) > 0 && !owned_on_surface(name))) {
      complain(fmt::format("operator '{}' declares '{}' on the surface, but parcels carry it",
                           claims.front().by->name, name));
    }
    const bool provided = std::any_of(claims.begin(), claims.end(), [](const Claim& claim) {
      return (claim.row->access & (PILEUS_ADD | PILEUS_CREATE)) != 0;
    });
    if (!provided) {
      complain(
          fmt::format("operator '{}' reads '{}' on the surface, which no operator adds to or owns",
                      claims.front().by->name, name));
    }
    const Claim* owner = find_owner(name, claims);
    return {name, claims.front().row->units, owner != nullptr ? owner->row->initial : 0.0};
  }

  /// One operator makes the items, each of their quantities has an owner, the others agree.
  parcels::ItemDeclaration unite_items() {
    parcels::ItemDeclaration items;
    const OperatorEntry* maker = nullptr;
    for (const std::string& name : item_claims_.names) {
      const std::vector<Claim>& claims = item_claims_.of.at(name);
      const Claim* owner = find_owner(name, claims);
      const bool optional =
          std::all_of(claims.begin(), claims.end(), [](const Claim& c) { return c.optional(); });
      if (owner == nullptr && optional) continue;
      if (owner == nullptr) {
        complain(
            fmt::format("operator '{}' needs '{}' of items, which no operator of the scene makes",
                        claims.front().by->name, name));
        continue;
      }
      maker = owner->by;
      for (const Claim& claim : claims) {
        if (claim.row->type != owner->row->type)
          complain(fmt::format("'{}' and '{}' disagree on the type of '{}'", owner->by->name,
                               claim.by->name, name));
        check_agreement(name, *owner, claim);
      }
      if (is_core_quantity(name) || claims_.know(name) || initial_.count(name) > 0)
        complain(fmt::format("operator '{}' declares '{}' of items, but parcels carry it",
                             owner->by->name, name));
      add_to_items(name, *owner, items);
    }
    if (maker != nullptr && items.multiplicity.empty())
      complain(
          fmt::format("operator '{}' makes items without a multiplicity (one of type i64, "
                      "extensive)",
                      maker->name));
    check_weights(items);
    return items;
  }

  void add_to_items(const std::string& name, const Claim& owner, parcels::ItemDeclaration& items) {
    const pileus_quantity& row = *owner.row;
    if (row.type == PILEUS_I64) {
      if (row.nature != PILEUS_EXTENSIVE || !items.multiplicity.empty())
        complain(
            fmt::format("operator '{}' declares '{}' of items as a whole number; their "
                        "multiplicity is one, extensive, and the only one",
                        owner.by->name, name));
      items.multiplicity = name;
      return;
    }
    parcels::ItemColumn column{name,
                               row.units,
                               parcels::ItemColumn::Kind::of_each,
                               row.budget != nullptr ? row.budget : "",
                               row.low,
                               row.high};
    const bool height = name == height_within_parcel_name;
    if (height) column.kind = parcels::ItemColumn::Kind::height;
    if (row.nature != (height ? PILEUS_LABEL : PILEUS_INTENSIVE))
      complain(fmt::format(
          "operator '{}' declares '{}' of items with a nature it cannot have: {}", owner.by->name,
          name,
          height ? "a height is a label" : "what belongs to each thing of an item is intensive"));
    items.columns.push_back(column);
  }

  void check_weights(const parcels::ItemDeclaration& items) {
    for (const std::string& name : item_claims_.names)
      for (const Claim& claim : item_claims_.of.at(name))
        if (claim.row->nature == PILEUS_INTENSIVE && items.multiplicity != claim.row->weight)
          complain(
              fmt::format("operator '{}' declares '{}' of items with another weight than their "
                          "multiplicity",
                          claim.by->name, name));
  }

  parcels::Scalar unite(const std::string& name) {
    const std::vector<Claim>& claims = claims_.of.at(name);
    const Claim* owner = find_owner(name, claims);
    const Claim* decisive = nullptr;  // the owner, or else the first that states a nature
    for (const Claim& claim : claims) {
      if (decisive == nullptr && claim.row->nature != 0) decisive = &claim;
    }
    if (owner != nullptr) decisive = owner;
    const auto needing = std::find_if(claims.begin(), claims.end(),
                                      [](const Claim& claim) { return !claim.optional(); });
    if (needing != claims.end()) check_source(name, *needing, owner);
    parcels::Scalar scalar = passive(name);
    if (decisive == nullptr) {  // the core's own nature; whoever changes it may keep a budget
      for (const Claim& claim : claims)
        if (claim.row->budget != nullptr) scalar.budget = claim.row->budget;
      return scalar;
    }
    const pileus_quantity& row = *decisive->row;
    for (const Claim& claim : claims) check_agreement(name, *decisive, claim);
    scalar.nature = nature_of(row.nature);
    scalar.budget = row.budget != nullptr ? row.budget : "";
    scalar.low = row.low;
    scalar.high = row.high;
    scalar.initial = owner != nullptr && row.nature != PILEUS_DERIVED ? row.initial : 0.0;
    return scalar;
  }

  void check_source(const std::string& name, const Claim& reader, const Claim* owner) {
    const bool set = initial_.count(name) > 0 || name == previous_height_name;
    if (owner == nullptr && !set) {
      complain(
          fmt::format("operator '{}' needs '{}', which no operator provides and the initial state "
                      "does not set; "
                      "add it to the scene's initial section",
                      reader.by->name, name));
    }
    if (owner != nullptr && set && owner->row->nature == PILEUS_DERIVED) {
      complain(fmt::format(
          "the initial state sets '{}', which operator '{}' derives; set what it derives it from",
          name, owner->by->name));
    }
  }

  void check_agreement(const std::string& name, const Claim& decisive, const Claim& other) {
    const std::uint32_t nature = other.row->nature;
    if (nature == 0) return;
    const char* a = decisive.row->budget != nullptr ? decisive.row->budget : "";
    const char* b = other.row->budget != nullptr ? other.row->budget : "";
    if (nature != decisive.row->nature || std::string_view(a) != b) {
      complain(fmt::format("'{}' and '{}' disagree on what '{}' is (nature or budget)",
                           decisive.by->name, other.by->name, name));
    }
  }

  /// True if operator b derives something that operator a reads.
  bool depends(std::size_t a, std::size_t b) const {
    for (const auto& [name, claims] : claims_.of) {
      bool reads = false, derives = false;
      for (const Claim& claim : claims) {
        const bool own = claim.creates() && claim.row->nature == PILEUS_DERIVED;
        reads = reads || (claim.by == &operators_[a] && !own);
        derives = derives || (claim.by == &operators_[b] && own);
      }
      if (reads && derives) return true;
    }
    return false;
  }

  std::vector<std::size_t> order_closures() {
    std::vector<std::size_t> waiting, ordered;
    for (std::size_t i = 0; i < operators_.size(); ++i) {
      if (operators_[i].table->op.diagnose != nullptr) waiting.push_back(i);
    }
    while (!waiting.empty()) {
      const auto ready = std::find_if(waiting.begin(), waiting.end(), [&](std::size_t a) {
        return std::none_of(waiting.begin(), waiting.end(),
                            [&](std::size_t b) { return a != b && depends(a, b); });
      });
      if (ready == waiting.end()) {
        std::string names;
        for (std::size_t i : waiting) names += (names.empty() ? "" : ", ") + operators_[i].name;
        complain("these operators derive quantities from each other in a ring: " + names);
        return ordered;
      }
      ordered.push_back(*ready);
      waiting.erase(ready);
    }
    return ordered;
  }

  const std::vector<OperatorEntry>& operators_;
  std::set<std::string> initial_;
  Claims claims_, surface_claims_, item_claims_;
  std::string problems_;
};

/// Position of shape_xx … shape_zz in the store's order of the shape matrix, or −1.
int shape_component(int dimension, std::string_view name) {
  static constexpr std::array<std::string_view, 6> space = {"shape_xx", "shape_xy", "shape_xz",
                                                            "shape_yy", "shape_yz", "shape_zz"};
  static constexpr std::array<std::string_view, 3> plane = {"shape_xx", "shape_xz", "shape_zz"};
  const auto position = [&](const auto& names) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  return dimension == 3 ? position(space) : position(plane);
}

}  // namespace

QuantityPlan plan_quantities(const std::vector<OperatorEntry>& operators,
                             const std::vector<std::string>& initial) {
  return Planner(operators, initial).plan();
}

bool is_core_quantity(std::string_view name) {
  static constexpr std::array<std::string_view, 9> names = {
      height_name, volume_name,   "x_position",  "y_position", "z_position",
      "vorticity", "x_vorticity", "y_vorticity", "z_vorticity"};
  return std::find(names.begin(), names.end(), name) != names.end() ||
         shape_component(3, name) >= 0;
}

int find_column(const parcels::Store& store, std::string_view name) {
  if (name == height_name) return store.dimension() - 1;
  if (name == volume_name) return store.dimension();
  if (const int component = shape_component(store.dimension(), name); component >= 0)
    return store.dimension() + 1 + store.vorticity_components() + component;
  for (int c = 0; c < store.column_count(); ++c) {
    if (store.column_name(c) == name) return c;
  }
  return -1;
}

}  // namespace pileus::coupling
