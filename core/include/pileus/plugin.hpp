// The C++20 layer over pileus/abi.h: header-only, built into each plugin with hidden visibility.
// Nothing in this file is part of the binary contract.
//
// A plugin is a class derived from Operator<Self> with these members, all but describe optional:
//
//   void describe(Declaration&)                         declares and binds its Slot/Param members
//   void configured()                                   parameters are set; may throw Failure
//   void init(const pileus_step&, Block)                values at the start of a run
//   double prepare(const pileus_step&, Block)           once a step; returns its largest step, s
//   void diagnose(const pileus_step&, Block) const      derived quantities; pure
//   void apply(const pileus_step&, Block) const         advance by step.dt
//   const void* extension(const char* id)               further tables
//   std::vector<std::byte> save() const                 what it keeps beside its quantities: for
//   void load(std::uint32_t format, std::span<const std::byte>)              checkpoints, and back
//   static constexpr std::uint32_t state_format         what these bytes are, beside save and load
//
// Hooks report failures by throwing; no exception ever leaves the library.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "abi.h"
#include "declaration.hpp"
#include "failure.hpp"
#include "philox.hpp"
#include "piecewise_linear.hpp"

namespace pileus {

/// Access to a quantity of any stride and number of components.
template <class T>
class Strided {
 public:
  explicit Strided(const pileus_view& view) : view_(view) {}
  T& operator()(std::int64_t element, std::int64_t component = 0) const {
    char* base = static_cast<char*>(view_.data);
    return *reinterpret_cast<T*>(base + element * view_.stride + component * view_.lane);
  }

 private:
  const pileus_view& view_;
};

/// The parcels of one call.
class Block {
 public:
  Block(const pileus_block& raw, const pileus_host& host) : raw_(raw), host_(host) {}

  std::int64_t count() const { return raw_.count; }
  std::uint64_t uid(std::int64_t parcel) const { return raw_.uid[parcel]; }
  const pileus_block& raw() const { return raw_; }

  /// True if the quantity exists in this run (its `when` holds).
  bool has(Slot slot) const { return view(slot).data != nullptr; }
  /// Values of a quantity declared with reads, updates or owns; element k belongs to parcel k.
  const double* in(Slot slot) const { return dense<const double>(slot, PILEUS_READ); }
  /// Values of a quantity declared with updates, owns or derives.
  double* out(Slot slot) const { return dense<double>(slot, PILEUS_WRITE); }
  /// Totals of a quantity of the ground declared with accumulates, to be added to: element
  /// x + cells[0]·y belongs to that column of the mesh, and there are elements(slot) of them.
  double* accumulator(Slot slot) const { return dense<double>(slot, PILEUS_ADD); }
  /// The items of a parcel, as positions in quantities of items; in and out give those as well.
  std::int64_t item_begin(std::int64_t parcel) const { return raw_.item_begin[parcel]; }
  std::int64_t item_end(std::int64_t parcel) const {
    return raw_.item_begin[parcel] + raw_.item_count[parcel];
  }
  /// The multiplicity of items: whole numbers.
  const std::int64_t* whole_in(Slot slot) const {
    return whole<const std::int64_t>(slot, PILEUS_READ);
  }
  std::int64_t* whole_out(Slot slot) const { return whole<std::int64_t>(slot, PILEUS_WRITE); }
  /// Number of values of a quantity: parcels, items, or columns of the mesh for one of the ground.
  std::int64_t elements(Slot slot) const { return view(slot).count; }
  /// The same for quantities with components or another element type.
  template <class T>
  Strided<const T> strided_in(Slot slot) const {
    return Strided<const T>(checked(slot, PILEUS_READ));
  }
  template <class T>
  Strided<T> strided_out(Slot slot) const {
    return Strided<T>(checked(slot, PILEUS_WRITE));
  }

  /// Calls f(parcel) for every active parcel, ascending.
  template <class F>
  void each(F&& f) const {
    if (raw_.active == nullptr) {
      for (std::int64_t i = 0; i < raw_.count; ++i) f(i);
    } else {
      for (std::int64_t k = 0; k < raw_.active_count; ++k) {
        f(static_cast<std::int64_t>(raw_.active[k]));
      }
    }
  }

  /// Books an amount brought in from outside (positive) or lost to it.
  void book(Budget budget, double amount) const {
    if (budget.index == Budget{}.index) throw Failure("a budget was used that describe left out");
    raw_.ledger[budget.index] += amount;
  }

  /// Reports increments cut by limiters and values moved into their range, for the run's ledger.
  void repaired(std::uint64_t count) const {
    if (count > 0 && PILEUS_HAS(&host_, pileus_host, repaired)) host_.repaired(&host_, count);
  }

  /// Room for `count` values until the call returns; contents undefined.
  std::span<double> scratch(std::size_t count) const {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(double)) throw std::bad_alloc();
    void* room = host_.scratch(&host_, count * sizeof(double));
    if (room == nullptr && count > 0) throw std::bad_alloc();
    return {static_cast<double*>(room), count};
  }

 private:
  const pileus_view& view(Slot slot) const {
    if (slot.index == Slot{}.index) throw Failure("a quantity was used that describe left out");
    return raw_.views[slot.index];
  }
  const pileus_view& checked(Slot slot, std::uint32_t access) const {
    const pileus_view& found = view(slot);
    if (found.data == nullptr) throw Failure("a quantity was used that does not exist in this run");
    if ((found.access & access) == 0) throw Failure("a quantity was used against its declaration");
    return found;
  }
  template <class T>
  T* dense(Slot slot, std::uint32_t access) const {
    const pileus_view& found = checked(slot, access);
    if (found.type != PILEUS_F64 || found.stride != sizeof(double)) {
      throw Failure("a quantity that is not a dense array of doubles was used as one");
    }
    return static_cast<T*>(found.data);
  }

  template <class T>
  T* whole(Slot slot, std::uint32_t access) const {
    const pileus_view& found = checked(slot, access);
    if (found.type != PILEUS_I64 || found.stride != sizeof(std::int64_t)) {
      throw Failure("a quantity that is not a dense array of whole numbers was used as one");
    }
    return static_cast<T*>(found.data);
  }

  const pileus_block& raw_;
  const pileus_host& host_;
};

/// Base of every operator written in C++; see the head of this file.
template <class Self>
class Operator {
 public:
  /// The operator's table; NULL if describe threw, which the core refuses by name.
  static const pileus_operator* table() noexcept {
    try {
      static Declaration declared = make_declaration();
      return &declared.op;
    } catch (...) {
      return nullptr;
    }
  }

 protected:
  const pileus_host& host() const { return *host_; }
  double value(Param p) const { return number_[p.index]; }
  bool is_on(Param p) const { return number_[p.index] != 0; }
  std::int64_t integer(Param p) const { return static_cast<std::int64_t>(number_[p.index]); }
  /// Position of the chosen word in its list.
  int choice(Param p) const { return static_cast<int>(number_[p.index]); }
  const std::string& text(Param p) const { return text_[p.index]; }
  std::span<const double> list(Param p) const { return list_[p.index]; }
  /// A parameter over height or time.
  PiecewiseLinear profile(Param p) const { return PiecewiseLinear(list_[p.index]); }

  /// Calls body(i) for i = 0 … n−1 on all threads; for operators of global scope, in `apply`, and
  /// for all in `init`. The result for i must not depend on other calls.
  template <class Body>
  void parallel_for(std::int64_t n, Body&& body) const {
    constexpr std::int64_t grain = 2048;
    parallel_chunks(n, grain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) body(i);
    });
  }
  /// Calls body(begin, end) for chunks of `grain`.
  template <class Body>
  void parallel_chunks(std::int64_t n, std::int64_t grain, Body&& body) const {
    Failure failure("");
    failure.record.size = sizeof failure.record;
    failure.status = host_->parallel_for(
        host_, n, grain,
        [](void* user, std::int64_t begin, std::int64_t end, pileus_error* error) {
          return guarded(error,
                         [&] { (*static_cast<std::remove_reference_t<Body>*>(user))(begin, end); });
        },
        const_cast<void*>(static_cast<const void*>(&body)), &failure.record);
    if (failure.status != PILEUS_OK) throw failure;
  }

  /// Gives every parcel a new list of items: `count` per parcel, and for every new item, parcel
  /// after parcel, the old one that it is a copy of, or a negative number for one of zeros. For
  /// the maker of the items in `init`, and for operators of global scope with PILEUS_RESIZES_ITEMS;
  /// arrays taken
  /// from the block before are those of the old lists.
  void regroup_items(const Block& block, std::span<const std::int32_t> count,
                     std::span<const std::int64_t> source) const {
    const void* found = host_->extension(host_, PILEUS_ITEM_LISTS_EXTENSION);
    if (found == nullptr) throw Failure("this run has no items");
    const auto* lists = static_cast<const pileus_item_lists_ext*>(found);
    Failure failure("");
    failure.record.size = sizeof failure.record;
    failure.status =
        lists->regroup(lists, &block.raw(), count.data(), source.data(), &failure.record);
    if (failure.status != PILEUS_OK) throw failure;
  }

  /// By what amounts of items are divided to count in budgets, as the maker of the items has it.
  double item_budget_scale() const {
    const void* found = host_->extension(host_, PILEUS_ITEM_LISTS_EXTENSION);
    if (found == nullptr) throw Failure("this run has no items, or they are not lent to it");
    return static_cast<const pileus_item_lists_ext*>(found)->budget_scale;
  }

  /// Rejects the step if a value of the quantity lies outside the range declared here or is not a
  /// number, and names the parcel (of a global operator also of values of the ground): where
  /// what comes out depends on what a scene prescribes. `why` tells the user what may be wrong.
  void expect_in_range(const Block& block, Slot slot, const char* why) const {
    const pileus_quantity& row = *table()->quantities[slot.index];
    const double* values = block.in(slot);
    const bool of_parcels = row.place == PILEUS_PARCEL;
    const auto look = [&](std::int64_t i) {
      if (!(values[i] >= row.low && values[i] <= row.high))
        throw Retry(why).at(of_parcels ? block.uid(i) : 0, slot.index, values[i]);
    };
    if (table()->scope == PILEUS_GLOBAL) {
      parallel_for(block.elements(slot), look);
    } else {
      block.each(look);
    }
  }

  /// Draws 0 … n−1 of `channel` (< 64) for one parcel at this step, each in (0,1).
  static void draw(const pileus_step& step, std::uint64_t uid, std::uint32_t channel,
                   std::uint32_t n, double* out) {
    draw_uniform({step.seed, step.stream, uid, step.number, step.call, channel}, n, out);
  }

 private:
  template <class F>
  static pileus_status guarded(pileus_error* error, F&& body) noexcept {
    try {
      body();
      return PILEUS_OK;
    } catch (const Failure& failure) {
      hand_over(failure.record, error);
      // What was thrown did not succeed, whatever its status says.
      return failure.status != PILEUS_OK ? failure.status : pileus_status{PILEUS_E_INTERNAL};
    } catch (const std::bad_alloc&) {
      return say(error, "out of memory", PILEUS_E_MEMORY);
    } catch (const std::exception& other) {
      return say(error, other.what(), PILEUS_E_INTERNAL);
    } catch (...) {
      return say(error, "an exception that is no std::exception", PILEUS_E_INTERNAL);
    }
  }
  static pileus_status say(pileus_error* error, const char* text, pileus_status status) noexcept {
    if (error != nullptr) std::snprintf(error->text, sizeof error->text, "%s", text);
    return status;
  }

  void keep(const pileus_values& values) {
    number_.assign(values.number, values.number + values.count);
    text_.assign(values.count, {});
    list_.assign(values.count, {});
    for (std::uint32_t i = 0; i < values.count; ++i) {
      if (values.text != nullptr && values.text[i] != nullptr) text_[i] = values.text[i];
      if (values.list != nullptr && values.list[i] != nullptr) {
        list_[i].assign(values.list[i], values.list[i] + values.list_count[i]);
      }
    }
  }

  static Declaration make_declaration() {
    Declaration d;
    d.op.scope = PILEUS_LOCAL;
    d.op.repeatability = PILEUS_REPEAT_RANKS;
    Self{}.describe(d);
    d.op.create = [](const pileus_host* host, void** self, pileus_error* error) {
      return guarded(error, [&] {
        require_whole(PILEUS_HAS(host, pileus_host, repaired), "pileus_host");
        auto made = std::make_unique<Self>();
        Declaration bound;
        made->describe(bound);
        static_cast<Operator*>(made.get())->host_ = host;
        *self = made.release();
      });
    };
    d.op.configure = [](void* self, const pileus_values* values, pileus_error* error) {
      return guarded(error, [&] {
        require_whole(PILEUS_HAS(values, pileus_values, list_count), "pileus_values");
        auto* me = static_cast<Self*>(self);
        static_cast<Operator*>(me)->keep(*values);
        if constexpr (requires { me->configured(); }) me->configured();
      });
    };
    d.op.destroy = [](void* self) { delete static_cast<Self*>(self); };
    add_step_hooks(d.op);
    add_block_hooks(d.op);
    d.seal();
    return d;
  }

  static void add_step_hooks(pileus_operator& op) {
    if constexpr (requires(Self & s, const pileus_step& t, Block b) { s.init(t, b); }) {
      op.init = [](void* self, const pileus_step* step, const pileus_block* whole,
                   pileus_error* error) {
        return guarded(error, [&] {
          require_whole(*step, *whole);
          auto* me = static_cast<Self*>(self);
          me->init(*step, Block(*whole, *static_cast<Operator*>(me)->host_));
        });
      };
    }
    if constexpr (requires(Self & s, const pileus_step& t, Block b) { s.prepare(t, b); }) {
      op.prepare = [](void* self, const pileus_step* step, const pileus_block* whole, double* limit,
                      pileus_error* error) {
        return guarded(error, [&] {
          require_whole(*step, *whole);
          auto* me = static_cast<Self*>(self);
          *limit = me->prepare(*step, Block(*whole, *static_cast<Operator*>(me)->host_));
        });
      };
    }
    add_extensions(op);
  }

  static void add_extensions(pileus_operator& op) {
    constexpr bool has_more = requires(Self & s, const char* id) {
      s.extension(id);
    };
    constexpr bool keeps_state = requires(const Self& s) {
      s.save();
    };
    if constexpr (has_more || keeps_state) {
      op.extension = [](void* self, const char* id) -> const void* {
        try {
          if constexpr (keeps_state)
            if (std::strcmp(id, PILEUS_STATE_EXTENSION) == 0) return &state_table();
          if constexpr (has_more) return static_cast<Self*>(self)->extension(id);
        } catch (...) {
        }
        return nullptr;
      };
    }
  }

  static const pileus_state_ext& state_table() {
    static const pileus_state_ext table{
        sizeof(pileus_state_ext), Self::state_format,
        [](void* self, int (*put)(void*, const void*, std::size_t), void* sink,
           pileus_error* error) {
          return guarded(error, [&] {
            const std::vector<std::byte> bytes = static_cast<const Self*>(self)->save();
            if (put(sink, bytes.data(), bytes.size()) == 0) throw std::bad_alloc();
          });
        },
        [](void* self, std::uint32_t format, const void* bytes, std::size_t count,
           pileus_error* error) {
          return guarded(error, [&] {
            static_cast<Self*>(self)->load(format, {static_cast<const std::byte*>(bytes), count});
          });
        }};
    return table;
  }

  static void add_block_hooks(pileus_operator& op) {
    if constexpr (requires(const Self& s, const pileus_step& t, Block b) { s.diagnose(t, b); }) {
      op.diagnose = [](void* self, const pileus_step* step, const pileus_block* block,
                       pileus_error* error) {
        return guarded(error, [&] {
          require_whole(*step, *block);
          const auto* me = static_cast<const Self*>(self);
          me->diagnose(*step, Block(*block, *static_cast<const Operator*>(me)->host_));
        });
      };
    }
    if constexpr (requires(const Self& s, const pileus_step& t, Block b) { s.apply(t, b); }) {
      op.apply = [](void* self, const pileus_step* step, const pileus_block* block,
                    pileus_error* error) {
        return guarded(error, [&] {
          require_whole(*step, *block);
          const auto* me = static_cast<const Self*>(self);
          me->apply(*step, Block(*block, *static_cast<const Operator*>(me)->host_));
        });
      };
    }
  }

  const pileus_host* host_ = nullptr;
  std::vector<double> number_;
  std::vector<std::string> text_;
  std::vector<std::vector<double>> list_;
};

}  // namespace pileus

#if defined(__FAST_MATH__)
#define PILEUS_NOTE_FASTMATH_ PILEUS_BUILT_FASTMATH
#else
#define PILEUS_NOTE_FASTMATH_ 0u
#endif
#if defined(NDEBUG)
#define PILEUS_NOTE_ASSERTS_ 0u
#else
#define PILEUS_NOTE_ASSERTS_ PILEUS_BUILT_ASSERTS
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PILEUS_NOTE_SANITIZED_ PILEUS_BUILT_SANITIZED
#else
#define PILEUS_NOTE_SANITIZED_ 0u
#endif

/// The lowest minor of a program that the library runs in, for its author to raise before this
/// header is included; 0 where whatever is newer is asked for with PILEUS_HAS.
#ifndef PILEUS_ABI_MINOR_NEEDED
#define PILEUS_ABI_MINOR_NEEDED 0u
#endif

/// Defines the entry function and the note of a library with the given operators:
/// PILEUS_MODULE("rain", "1.0.0", Kessler::table(), Evaporation::table())
#define PILEUS_MODULE(MODULE, VERSION, ...)                                                   \
  extern "C" PILEUS_EXPORT const pileus_module* pileus_module_v1(void) {                      \
    static const pileus_operator* const list[] = {__VA_ARGS__, nullptr};                      \
    static const pileus_module module{sizeof(pileus_module), PILEUS_ABI_MINOR,                \
                                      PILEUS_ABI_MINOR_NEEDED, 0u, list};                     \
    return &module;                                                                           \
  }                                                                                           \
  [[gnu::section(".pileus.note"), gnu::used]] static const pileus_note pileus_note_record = { \
      PILEUS_NOTE_MAGIC,                                                                      \
      PILEUS_ABI_MAJOR,                                                                       \
      PILEUS_ABI_MINOR,                                                                       \
      PILEUS_ABI_MINOR_NEEDED,                                                                \
      PILEUS_NOTE_FASTMATH_ | PILEUS_NOTE_ASSERTS_ | PILEUS_NOTE_SANITIZED_,                  \
      MODULE,                                                                                 \
      VERSION,                                                                                \
      __VERSION__,                                                                            \
      ""};                                                                                    \
  static_assert(sizeof(MODULE) <= 64 && sizeof(VERSION) <= 32)

/// The usual case: one operator class, the library named by its id.
#define PILEUS_PLUGIN(TYPE, ID, VERSION) PILEUS_MODULE(ID, VERSION, TYPE::table())
