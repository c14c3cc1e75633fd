// How an operator written in C++ declares itself: the tables of pileus/abi.h, built by naming.
#pragma once
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <limits>
#include <vector>

#include "abi.h"

namespace pileus {

/// A declared quantity: its position in the operator's list.
struct Slot {
  std::uint32_t index = std::numeric_limits<std::uint32_t>::max();
};
/// A declared parameter.
struct Param {
  std::uint32_t index = std::numeric_limits<std::uint32_t>::max();
};
/// A declared budget.
struct Budget {
  std::uint32_t index = std::numeric_limits<std::uint32_t>::max();
};

/// Collects the declarations of one operator. `describe` runs once for the library's tables and
/// once for every instance, so that its Slot and Param members learn their index. Strings must be
/// literals: the tables keep the pointers.
class Declaration {
 public:
  pileus_operator op{};  // id, kind, version, title, summary, authors, licence, scope, form, …

  class Quantity {
   public:
    Quantity(pileus_quantity& row, std::uint32_t index) : row_(row), index_(index) {}
    /// Admissible values, both ends included; the core checks them after every call.
    Quantity& range(double low, double high) { return row_.low = low, row_.high = high, *this; }
    /// Conserved per unit volume: volume-weighted mean at a merge, copied at a split.
    Quantity& intensive(const char* budget = nullptr) {
      row_.nature = PILEUS_INTENSIVE, row_.weight = "parcel_volume", row_.budget = budget;
      return *this;
    }
    /// An amount: summed at a merge, shared by volume at a split.
    Quantity& extensive(const char* budget = nullptr) {
      return row_.nature = PILEUS_EXTENSIVE, row_.budget = budget, *this;
    }
    /// Of each of the things that an item stands for.
    Quantity& of_each(const char* multiplicity, const char* budget = nullptr) {
      row_.nature = PILEUS_INTENSIVE, row_.weight = multiplicity, row_.budget = budget;
      return *this;
    }
    /// Part of a budget, of the nature that its owner gives it, where it is not derived.
    Quantity& counts_in(const char* budget) { return row_.budget = budget, *this; }
    /// Of the larger parcel at a merge, copied at a split.
    Quantity& label() { return row_.nature = PILEUS_LABEL, *this; }
    /// Not called for: exists (Block::has) if another operator or the scene brings it about; one
    /// that is updated exists only where parcels carry it, not where it is derived.
    Quantity& optional() { return row_.access |= PILEUS_OPTIONAL, *this; }
    /// Of one that is derived: left out within a step, where only the flow is advanced. Ask
    /// Block::has in `diagnose`.
    Quantity& on_demand() { return row_.access |= PILEUS_ON_DEMAND, *this; }
    /// The value at the start where the scene states none.
    Quantity& initial(double value) { return row_.initial = value, *this; }
    /// Numbers per element; more than one is reached with strided_in and strided_out.
    Quantity& components(std::uint32_t count) { return row_.components = count, *this; }
    /// Where it lives, if not on parcels.
    Quantity& place(std::uint32_t where) { return row_.place = where, *this; }
    /// Of an element, if not a double.
    Quantity& type(std::uint32_t element) { return row_.type = element, *this; }
    /// Exists only where this holds: of parameters and effects, see pileus/abi.h.
    Quantity& when(const char* condition) { return row_.when = condition, *this; }
    /// One line for people, beyond the register's definition.
    Quantity& doc(const char* text) { return row_.doc = text, *this; }
    operator Slot() const { return {index_}; }  // NOLINT: `slot = d.reads(…)` is the point

   private:
    pileus_quantity& row_;
    std::uint32_t index_;
  };

  class Parameter {
   public:
    Parameter(pileus_parameter& row, std::uint32_t index) : row_(row), index_(index) {}
    /// Admissible values, both ends included.
    Parameter& range(double low, double high) { return row_.low = low, row_.high = high, *this; }
    /// Trades accuracy for time; `ladder` from coarse to fine, NaN-terminated, static.
    Parameter& knob(const double* ladder) { return row_.knob = 1, row_.ladder = ladder, *this; }
    /// Means something only where this holds.
    Parameter& when(const char* condition) { return row_.when = condition, *this; }
    /// One line for people.
    Parameter& doc(const char* text) { return row_.doc = text, *this; }
    operator Param() const { return {index_}; }  // NOLINT: `param = d.number(…)` is the point

   private:
    pileus_parameter& row_;
    std::uint32_t index_;
  };

  /// A quantity of the parcels that the operator only reads.
  Quantity reads(const char* name, const char* units) { return touches(name, units, PILEUS_READ); }
  /// One it reads and gives new values.
  Quantity updates(const char* name, const char* units) {
    return touches(name, units, PILEUS_READ | PILEUS_WRITE);
  }
  /// One it owns and advances; state its nature with intensive() or extensive().
  Quantity owns(const char* name, const char* units) {
    return touches(name, units, PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE);
  }
  /// One that `diagnose` computes from the others.
  Quantity derives(const char* name, const char* units) {
    return touches(name, units, PILEUS_WRITE | PILEUS_CREATE, PILEUS_DERIVED);
  }
  /// One of the ground that it adds to: a number per column of cells. Only global operators may.
  Quantity accumulates(const char* name, const char* units) {
    return touches(name, units, PILEUS_ADD).place(PILEUS_SURFACE);
  }

  /// One of the ground of its own: read and given new values in `apply`, starting at initial() or
  /// at what the scene says. Only global operators may.
  Quantity owns_on_surface(const char* name, const char* units) {
    return owns(name, units).place(PILEUS_SURFACE);
  }
  /// A number of the whole run: element 0 of its view. pileus/abi.h lists them.
  Quantity reads_domain(const char* name, const char* units) {
    return reads(name, units).place(PILEUS_DOMAIN);
  }
  /// The same to be changed. Only global operators may.
  Quantity updates_domain(const char* name, const char* units) {
    return updates(name, units).place(PILEUS_DOMAIN);
  }

  /// A quantity on the nodes of the mesh: the parcels' quantity of that name as the core gathers
  /// it, or one of the gridded flow (strain_rate_magnitude, x_derivative_of_z_velocity, …), of the
  /// state at the start of `apply`.
  Quantity reads_mesh(const char* name, const char* units) {
    return touches(name, units, PILEUS_READ).place(PILEUS_MESH);
  }
  /// The same interpolated back to the parcels.
  Quantity reads_mesh_at_parcel(const char* name, const char* units) {
    return touches(name, units, PILEUS_READ).place(PILEUS_MESH_AT_PARCEL);
  }

  /// How many things each item of the parcels' lists stands for: the quantity that makes items.
  Quantity owns_items(const char* multiplicity) {
    return touches(multiplicity, "1", PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE, PILEUS_EXTENSIVE)
        .place(PILEUS_ITEM)
        .type(PILEUS_I64);
  }
  /// Another number of every item; state with of_each() or label() what it is.
  Quantity owns_of_items(const char* name, const char* units) {
    return owns(name, units).place(PILEUS_ITEM);
  }
  /// The same of items that another operator owns; the multiplicity is of type(PILEUS_I64).
  Quantity reads_of_items(const char* name, const char* units) {
    return reads(name, units).place(PILEUS_ITEM);
  }
  Quantity updates_of_items(const char* name, const char* units) {
    return updates(name, units).place(PILEUS_ITEM);
  }

  /// A number with a unit.
  Parameter number(const char* name, const char* units, double fallback) {
    return parameter(PILEUS_NUMBER, name, units, fallback);
  }
  /// A whole number.
  Parameter integer(const char* name, std::int64_t fallback) {
    return parameter(PILEUS_INTEGER, name, "1", static_cast<double>(fallback));
  }
  /// true or false in a scene.
  Parameter toggle(const char* name, bool fallback) {
    return parameter(PILEUS_SWITCH, name, "1", fallback ? 1.0 : 0.0);
  }
  /// One of a few words; the first is the default.
  Parameter choice(const char* name, std::initializer_list<const char*> words) {
    std::vector<const char*>& list = choices_.emplace_back(words);
    list.push_back(nullptr);
    Parameter made = parameter(PILEUS_CHOICE, name, "1", 0);
    parameters_.items.back().choices = list.data();
    return made;
  }
  /// Any text.
  Parameter text(const char* name, const char* fallback) {
    Parameter made = parameter(PILEUS_TEXT, name, "1", 0);
    parameters_.items.back().text_fallback = fallback;
    return made;
  }
  /// A list of numbers of one unit; the default is a list of one.
  Parameter numbers(const char* name, const char* units, double fallback) {
    return parameter(PILEUS_NUMBERS, name, units, fallback);
  }

  /// A function of height, linear between its points; the default holds everywhere.
  Parameter profile(const char* name, const char* units, double fallback) {
    return parameter(PILEUS_PROFILE, name, units, fallback);
  }
  /// A function of time.
  Parameter series(const char* name, const char* units, double fallback) {
    return parameter(PILEUS_SERIES, name, units, fallback);
  }

  /// An effect the operator brings about (in the cases of `when`).
  void provides(const char* effect, const char* when = nullptr) {
    add_effect(PILEUS_PROVIDES, effect, when);
  }
  /// One it cannot do without.
  void requires_effect(const char* effect, const char* when = nullptr) {
    add_effect(PILEUS_REQUIRES, effect, when);
  }
  /// One that must not be provided beside it.
  void excludes(const char* effect, const char* when = nullptr) {
    add_effect(PILEUS_EXCLUDES, effect, when);
  }
  /// A parcel is active if for some `clause` all its comparisons hold.
  void active_if(std::uint32_t clause, const char* quantity, std::uint32_t comparison,
                 double value) {
    pileus_condition& row = conditions_.add();
    row.clause = clause, row.quantity = quantity, row.op = comparison, row.value = value;
  }
  /// The same with the value of a parameter, by its name.
  void active_if_parameter(std::uint32_t clause, const char* quantity, std::uint32_t comparison,
                           const char* parameter) {
    pileus_condition& row = conditions_.add();
    row.clause = clause, row.quantity = quantity, row.op = comparison, row.parameter = parameter;
  }
  /// A source, by DOI and in words.
  void cites(const char* doi, const char* text) {
    pileus_reference& row = references_.add();
    row.doi = doi, row.text = text;
  }
  /// A closed sum whose exchange with the outside is booked.
  Budget budget(const char* name) {
    budgets_.back() = name;
    budgets_.push_back(nullptr);
    return {static_cast<std::uint32_t>(budgets_.size() - 2)};
  }

  // Points the operator's lists at what was collected; the base class calls it.
  void seal() {
    op.size = sizeof op;
    op.quantities = quantities_.view.data();
    op.parameters = parameters_.view.data();
    op.effects = effects_.view.data();
    op.active_if = conditions_.view.data();
    op.references = references_.view.data();
    op.budgets = budgets_.data();
  }

 private:
  template <class T>
  struct List {  // rows that stay where they are, and the zero-terminated view of them
    std::deque<T> items;
    std::vector<const T*> view{nullptr};
    T& add() {
      T& row = items.emplace_back();
      row = T{};
      row.size = sizeof(T);
      view.back() = &row;
      view.push_back(nullptr);
      return row;
    }
  };

  Quantity touches(const char* name, const char* units, std::uint32_t access,
                   std::uint32_t nature = 0) {
    const auto index = static_cast<std::uint32_t>(quantities_.items.size());
    pileus_quantity& row = quantities_.add();
    row.place = PILEUS_PARCEL;
    row.type = PILEUS_F64;
    row.components = 1;
    row.access = access;
    row.nature = nature;
    row.name = name;
    row.units = units;
    row.low = -std::numeric_limits<double>::max();
    row.high = std::numeric_limits<double>::max();
    return {row, index};
  }
  Parameter parameter(std::uint32_t type, const char* name, const char* units, double fallback) {
    const auto index = static_cast<std::uint32_t>(parameters_.items.size());
    pileus_parameter& row = parameters_.add();
    row.type = type;
    row.name = name;
    row.units = units;
    row.fallback = fallback;
    return {row, index};
  }
  void add_effect(std::uint32_t role, const char* name, const char* when) {
    pileus_effect& row = effects_.add();
    row.role = role, row.name = name, row.when = when;
  }

  List<pileus_quantity> quantities_;
  List<pileus_parameter> parameters_;
  List<pileus_effect> effects_;
  List<pileus_condition> conditions_;
  List<pileus_reference> references_;
  std::deque<std::vector<const char*>> choices_;
  std::vector<const char*> budgets_{nullptr};
};

}  // namespace pileus
