// A plugin that breaks exactly one rule of the contract: which one is chosen by HOSTILE, a name.
#include <pileus/abi.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string_view>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#ifndef HOSTILE_ENTRY
#define HOSTILE_ENTRY pileus_module_v1
#endif

#ifndef HOSTILE_MAGIC
#define HOSTILE_MAGIC PILEUS_NOTE_MAGIC
#endif

namespace {

constexpr bool is(std::string_view name) {
  return name == HOSTILE;
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Switches denormals off for the whole process, as fast-math start-up code does.
void change_arithmetic() {
#if defined(__SSE2__)
  _mm_setcsr(_mm_getcsr() | 0x8040u);
#endif
}

[[gnu::noinline]] void crash() {
  std::raise(SIGSEGV);
}

struct AtLoad {
  AtLoad() {
    if (is("changes_arithmetic_at_load")) change_arithmetic();
    if (is("crashes_at_load")) crash();
  }
} at_load;

pileus_quantity tracer_row() {
  pileus_quantity q{};
  q.size = is("short_row") ? 40 : sizeof q;
  q.place = is("unknown_place") ? 77 : PILEUS_PARCEL;
  q.type = PILEUS_F64;
  q.components = 1;
  q.access = PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE;
  q.nature = is("no_nature") ? 0 : PILEUS_INTENSIVE;
  q.name = is("null_name") ? nullptr : is("unregistered_name") ? "pasive_tracer" : "passive_tracer";
  q.units = is("wrong_units") ? "kg" : "1";
  q.weight = is("no_weight") ? nullptr : "parcel_volume";
  q.low = is("inverted_range") ? 2.0 : 0.0;
  q.high = 1.0;
  q.initial = is("initial_out_of_range") ? 5.0 : 0.5;
  q.doc = is("doc_not_utf8") ? "\xff\xfe" : nullptr;
  if (is("writes_infinity_in_any_range")) {
    q.low = -std::numeric_limits<double>::infinity();
    q.high = std::numeric_limits<double>::infinity();
  }
  return q;
}

pileus_quantity derived_row() {
  pileus_quantity q{};
  q.size = sizeof q;
  q.place = PILEUS_PARCEL;
  q.type = PILEUS_F64;
  q.components = 1;
  q.access = PILEUS_WRITE | PILEUS_CREATE;
  q.nature = PILEUS_DERIVED;
  q.name = is("declares_twice") ? "passive_tracer" : "buoyancy";
  q.units = "m s-2";
  q.low = -10.0;
  q.high = 10.0;
  q.when = is("wrong_when") ? "mode == fast" : nullptr;
  return q;
}

pileus_parameter rate_row() {
  pileus_parameter p{};
  p.size = sizeof p;
  p.type = PILEUS_NUMBER;
  p.name = is("reserved_parameter") ? "use" : "rate";
  p.units = "s-1";
  p.fallback = is("default_out_of_range") ? 7.0 : 1.0;
  p.low = 0.0;
  p.high = 2.0;
  if (is("broken_integer")) p.type = PILEUS_INTEGER, p.fallback = 0.5;
  if (is("broken_switch")) p.type = PILEUS_SWITCH, p.fallback = 2.0;
  return p;
}

const pileus_quantity tracer = tracer_row(), derived = derived_row();
const pileus_quantity* const quantities[] = {&tracer, &derived, nullptr};
const pileus_parameter rate = rate_row();
const pileus_parameter* const parameters[] = {&rate, nullptr};

const char* const budgets[] = {is("books_nan") ? "water" : nullptr, nullptr};

const pileus_host* core = nullptr;
const pileus_values* given = nullptr;

pileus_status create(const pileus_host* host, void** self, pileus_error*) {
  if (is("throws_in_create")) throw std::runtime_error("no create");
  static int instance;
  *self = &instance;
  core = host;
  return PILEUS_OK;
}
pileus_status configure(void*, const pileus_values* values, pileus_error*) {
  given = values;
  if (is("throws_in_configure")) throw 42;
  return is("refuses_configure") ? PILEUS_E_CONFIG : PILEUS_OK;
}
pileus_status init(void*, const pileus_step*, const pileus_block* whole, pileus_error*) {
  if (is("throws_in_init")) throw std::runtime_error("no init");
  if (is("sets_nan_in_init")) static_cast<double*>(whole->views[0].data)[1] = nan;
  return PILEUS_OK;
}
pileus_status prepare(void*, const pileus_step*, const pileus_block*, double* limit,
                      pileus_error*) {
  if (is("throws_in_prepare")) throw std::runtime_error("no prepare");
  if (is("negative_step_limit")) *limit = -1.0;
  return PILEUS_OK;
}
pileus_status diagnose(void*, const pileus_step*, const pileus_block* block, pileus_error*) {
  if (is("throws_in_diagnose")) throw std::runtime_error("no diagnose");
  if (is("crashes_in_diagnose")) crash();
  double* b = static_cast<double*>(block->views[1].data);
  for (int64_t i = 0; i < block->count; ++i) b[i] = 0.0;
  if (is("derives_nan")) b[block->count / 2] = nan;
  return PILEUS_OK;
}
/// A chunk of a loop over all threads.
pileus_status chunk(void*, int64_t, int64_t, pileus_error*) {
  if (is("throws_in_loop")) throw std::runtime_error("no loop");
  if (is("crashes_in_loop")) crash();
  if (is("changes_arithmetic_in_loop")) change_arithmetic();
  return PILEUS_OK;
}

pileus_status apply(void*, const pileus_step*, const pileus_block* block, pileus_error* error) {
  double* q = static_cast<double*>(block->views[0].data);
  if (is("throws_in_apply")) throw std::runtime_error("no apply");
  if (is("aborts_in_apply")) std::abort();
  if (is("exits_in_apply")) std::exit(0);
  if (is("books_nan")) block->ledger[0] = nan;
  if (is("writes_nan")) q[1] = nan;
  if (is("writes_infinity") || is("writes_infinity_in_any_range"))
    q[1] = std::numeric_limits<double>::infinity();
  if (is("writes_out_of_range")) q[1] = 3.5;
  if (is("keeps_its_values")) {
    std::snprintf(error->text, sizeof error->text, "the rate is %g", given->number[0]);
    return PILEUS_E_UNSUPPORTED;
  }
  if (is("always_retries")) return PILEUS_RETRY;
  if (is("unknown_status")) return 99;
  if (is("unterminated_text")) {
    for (char& c : error->text) c = 'x';
    return PILEUS_E_INTERNAL;
  }
  if (is("changes_arithmetic_in_apply")) change_arithmetic();
  if (is("throws_in_loop") || is("crashes_in_loop") || is("changes_arithmetic_in_loop"))
    return core->parallel_for(core, block->count, 64, chunk, nullptr, error);
  return PILEUS_OK;
}
void destroy(void*) {
  if (is("throws_in_destroy")) throw std::runtime_error("no destroy");
}

pileus_operator make_operator() {
  pileus_operator op{};
  op.size = is("short_operator") ? 16 : sizeof op;
  op.repeatability = PILEUS_REPEAT_RANKS;
  const bool loops =
      is("throws_in_loop") || is("crashes_in_loop") || is("changes_arithmetic_in_loop");
  op.scope = is("unknown_scope") ? 9 : loops ? PILEUS_GLOBAL : PILEUS_LOCAL;
  op.form = PILEUS_FLOW;
  op.reserved = is("reserved_in_use") ? 1u : 0u;
  op.flags = is("unknown_flag") ? 1u << 30 : 0u;
  op.id = is("malformed_id") ? "Hostile Plugin"
          : is("foreign_id") ? "org.example.other"
                             : "org.example.hostile";
  op.kind = "forcing";
  op.version = is("malformed_version") ? "one" : "1.0.0";
  op.title = "Hostile";
  op.summary = is("not_utf8") ? "\xff\xfe" : "Breaks one rule.";
  op.authors = "Nobody";
  op.licence = is("null_licence") ? nullptr : "MIT";
  op.quantities = quantities;
  op.parameters = parameters;
  op.budgets = budgets;
  op.create = is("null_create") ? nullptr : create;
  op.configure = configure;
  op.init = init;
  op.prepare = prepare;
  op.diagnose = is("null_diagnose") ? nullptr : diagnose;
  op.apply = is("null_apply") ? nullptr : apply;
  op.destroy = destroy;
  return op;
}

}  // namespace

extern "C" PILEUS_EXPORT const pileus_module* HOSTILE_ENTRY(void) {
  static const pileus_operator op = make_operator();
  static const pileus_operator* const list[] = {is("no_operators") ? nullptr : &op, nullptr};
  static const pileus_module module{is("short_module") ? 8u : std::uint32_t{sizeof(pileus_module)},
                                    PILEUS_ABI_MINOR, is("disagrees_with_note") ? 1u : 0u, 0, list};
  if (is("throwing_entry")) throw std::runtime_error("no entry");
  return is("null_module") ? nullptr : &module;
}

#if !defined(HOSTILE_WITHOUT_NOTE)
[[gnu::section(".pileus.note"), gnu::used]] static const pileus_note note = {
    HOSTILE_MAGIC,
    is("wrong_major") ? 7u : PILEUS_ABI_MAJOR,
    PILEUS_ABI_MINOR,
    is("newer_minor") ? PILEUS_ABI_MINOR + 1u : 0u,
    is("fast_math") ? std::uint32_t{PILEUS_BUILT_FASTMATH} : 0u,
    "org.example.hostile",
    "1.0.0",
    "none",
    ""};
#endif
