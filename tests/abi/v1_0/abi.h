/* pileus/abi.h - the whole binary contract between the core and its plugins, major 1.
 *
 * Plain C11: no allocation changes owner across this line, no exception crosses it, no C++ type
 * appears in it. Strings are UTF-8, zero-terminated, and live as long as the table they stand in.
 * Members named `reserved` are 0, or refused.
 *
 * What 1.x promises: any plugin of major 1 runs in any program of major 1 that has at least the
 * minor it needs. Tables that start with `size` grow at their end and nowhere else, the extensions'
 * among them; pileus_view and pileus_grid sit in hot arrays, have no `size`, and pileus_note is
 * read from files: these three never change. Nothing changes its meaning, position or type. Enums
 * gain values and lose none; a value that the reader does not know is refused, not guessed, so that
 * whoever uses a newer one says so in `abi_minor_needed` (a status that is not known is a failure).
 * An extension that has to change otherwise gets a new number behind its slash.
 *
 * Phases:  [setup] one thread, nothing is stepping;  [step] one thread, between blocks;
 * [block] many threads at once on the same `self`, which is read-only then, with disjoint blocks;
 * [any] all of them. A plugin starts no threads of its own. */
#ifndef PILEUS_ABI_H
#define PILEUS_ABI_H
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

#define PILEUS_ABI_MAJOR 1u /* also in the entry symbol's name: a new major is a new symbol */
#define PILEUS_ABI_MINOR 0u /* raised when a table grows */
#define PILEUS_ENTRY_SYMBOL "pileus_module_v1"
#define PILEUS_EXPORT __attribute__((visibility("default")))
/* Does table P, filled in by the other side, reach as far as MEMBER? A member that is not reached
 * reads as zero, and zero is a valid meaning of every member added after minor 0. Those of minor 0
 * are always reached: shorter tables are refused. No table has padding, where a later member could
 * seem to be reached. */
#define PILEUS_HAS(P, TYPE, MEMBER) \
  ((P)->size >= offsetof(TYPE, MEMBER) + sizeof(((const TYPE*)0)->MEMBER))

/* ---- status and errors ---------------------------------------------------------------------- */
typedef uint32_t pileus_status;
enum {
  PILEUS_OK = 0,
  PILEUS_RETRY = 1,       /* apply: the core restores the block and tries smaller steps */
  PILEUS_E_CONFIG = 16,   /* parameters contradict each other */
  PILEUS_E_INPUT = 17,    /* a value handed in lies outside its declared range */
  PILEUS_E_DIVERGED = 18, /* an iteration used up its declared limit */
  PILEUS_E_NUMERIC = 19,  /* a NaN or an infinity was produced */
  PILEUS_E_MEMORY = 20,
  PILEUS_E_UNSUPPORTED = 21,
  PILEUS_E_INTERNAL = 22 /* anything else, a caught C++ exception included */
};
/* Owned by the caller, who sets `size`, and valid for one call; nothing beyond is written. */
typedef struct pileus_error {
  uint32_t size;
  int32_t slot;   /* quantity at fault, -1: none */
  uint64_t uid;   /* parcel at fault, 0: none */
  double value;   /* the offending value */
  double dt_hint; /* with PILEUS_RETRY: a step that should work, s; 0: none */
  char text[480]; /* one sentence: what, where, how to fix */
} pileus_error;

/* ---- what a plugin says about itself: constant data ----------------------------------------- */
/* clang-format off */
enum { /* place: where a quantity lives */
  PILEUS_PARCEL = 1,
  PILEUS_ITEM,              /* in lists that every parcel owns; see below */
  PILEUS_MESH,              /* deposited by the core from the parcels' quantity of that name, or a
                             * quantity of the gridded flow; one element per node, see
                             * pileus.mesh/1; read only, not in diagnose */
  PILEUS_MESH_AT_PARCEL,    /* the same, interpolated back to the parcels */
  PILEUS_SURFACE,           /* one element per column of cells: x + cells[0] * y */
  PILEUS_DOMAIN             /* one number of the whole run; see below */
};
enum { /* type; F32 and U64 are words for later, no program of minor 0 takes them */
  PILEUS_F64 = 1, PILEUS_F32, PILEUS_I64, PILEUS_U64
};
enum { /* access, a bit set */
  PILEUS_READ = 1u,
  PILEUS_WRITE = 2u,        /* returns a new value */
  PILEUS_CREATE = 4u,       /* owns the quantity; one owner per run */
  PILEUS_ADD = 8u,          /* only adds to a shared accumulator */
  PILEUS_OPTIONAL = 16u,    /* not called for: exists if something else brings it about; one to be
                             * written exists only where parcels carry it, not where it is derived */
  PILEUS_ON_DEMAND = 32u    /* derived, and not needed by the flow: diagnose is given a NULL view in
                             * the stages within a step, unless another closure reads it */
};
enum { /* nature: what happens at a merge or split; 0: as the quantity's owner declares */
  PILEUS_EXTENSIVE = 1, PILEUS_INTENSIVE, PILEUS_LABEL, PILEUS_DERIVED
};
enum { /* rule at a merge or split; 0: the default of the nature; the others are words for later, no
        * program of minor 0 takes them */
  PILEUS_RULE_DEFAULT = 0, PILEUS_RULE_SUM, PILEUS_RULE_MEAN, PILEUS_RULE_MIN, PILEUS_RULE_MAX,
  PILEUS_RULE_COPY, PILEUS_RULE_SHARE, PILEUS_RULE_HOOK
};
enum { /* scope: which parcels one call must see together, and maybe more; choose the narrowest */
  PILEUS_LOCAL = 1, PILEUS_CELLWISE, PILEUS_COLUMNWISE, PILEUS_GLOBAL
};
enum { /* form */
  PILEUS_FLOW = 1,          /* apply(dt) advances its own sub-problem from the current state */
  PILEUS_PROJECTION,        /* apply maps onto a constraint; twice is the same as once */
  PILEUS_CLOSURE,           /* diagnose only: derived quantities in every Runge-Kutta stage */
  PILEUS_OBSERVER           /* apply writes nothing */
};
enum { /* repeatability: what the same bits are promised for */
  PILEUS_REPEAT_NONE = 0,
  PILEUS_REPEAT_RUN,        /* same binary, same number of threads */
  PILEUS_REPEAT_THREADS,    /* any number of threads, block size, skipping, restart */
  PILEUS_REPEAT_RANKS       /* also any decomposition into processes */
};
enum { /* flags, a bit set */
  PILEUS_SERIAL = 1u,       /* blocks one after another */
  PILEUS_STIFF = 2u,
  PILEUS_RANDOM = 4u,
  PILEUS_RESIZES_ITEMS = 8u /* calls regroup of pileus.item_lists/1 in apply; scope global */
};
enum { /* parameter type */
  PILEUS_NUMBER = 1, PILEUS_INTEGER, PILEUS_SWITCH, PILEUS_CHOICE, PILEUS_TEXT,
  PILEUS_NUMBERS,           /* a list of numbers of one unit; a single number is a list of one */
  PILEUS_PROFILE,           /* piecewise linear over height: the list is z0, v0, z1, v1 ... (z in m,
                             * ascending), constant beyond its ends; a single number: everywhere */
  PILEUS_SERIES             /* the same over time, s */
};
enum { PILEUS_PROVIDES = 1, PILEUS_REQUIRES, PILEUS_EXCLUDES };     /* role of an effect */
enum { PILEUS_LT = 1, PILEUS_LE, PILEUS_GT, PILEUS_GE, PILEUS_NE }; /* comparison */
/* clang-format on */

/* `when`, wherever it stands: NULL (always), or comparisons (== and !=) of a choice, switch,
 * integer or number with a literal (in SI units), joined by " and ":  "thermodynamics == real".
 * In the `when` of a quantity a term may also ask for an effect that the operator provides:
 * "effect.condensation == on". Where an effect is off, its quantities do not exist (their views
 * are NULL), and the operator leaves out the work for them; where it is watched, they begin to be
 * handed over when it is switched on. */

/* Items. Every parcel owns a list of items, each of which stands for many alike (droplets). Each of
 * their quantities has an owner that CREATEs it, others may read and write it. Exactly one is of
 * type I64 and EXTENSIVE: how many things the item stands for; its owner makes the items in init,
 * before other operators are initialised, and an item of 0 things is none and soon gone. Those of
 * type F64 and INTENSIVE, weighted by it, belong to each of these things; if one has a budget,
 * multiplicity times value over pileus_items_ext.budget_scale counts in it. One named
 * height_within_parcel, a LABEL, is the item's height above its parcel's centre over the parcel's
 * vertical half-extent.
 *
 * The core keeps the lists through splits of parcels (each half gets half of every item, at the
 * same relative height), mergers (lists are joined, items stay at their height, and lists that have
 * become too long are shortened by uniting items alike, with sums kept) and restarts. An activity
 * condition on a quantity of the items holds for a parcel if it holds for one of its items. */
/* The surface. Its quantities have no nature. Operators of global scope ADD to a shared one, or
 * CREATE one of their own, which they read and WRITE; it starts at `initial` or at what the scene's
 * initial state says under its name, as a function of x and y.
 *
 * The domain. "domain_mean_x_velocity" and "domain_mean_y_velocity" (m s-1) are the horizontal
 * momentum that the vorticity of the parcels does not hold; operators of global scope may WRITE
 * them. "coriolis_parameter" (s-1) is read only. In two dimensions there is only the first. */
typedef struct pileus_quantity { /* its position in `quantities` is its slot number */
  uint32_t size, place, type, components, access, nature, on_merge, on_split;
  const char* name;   /* CF standard name, or one registered in schemas/quantities.yaml */
  const char* units;  /* UDUNITS text of that registration; "1" for pure numbers */
  const char* weight; /* INTENSIVE: what weights its mean: "parcel_volume", or the multiplicity */
  const char* budget; /* closed sum it belongs to ("water"), or NULL */
  const char* when;   /* the slot exists only then */
  double low, high;   /* admissible range, both ends included */
  double initial;     /* given to parcels when the scene states nothing (CREATE) */
  const char* doc;
} pileus_quantity;

typedef struct pileus_parameter {      /* its position is its index in pileus_values */
  uint32_t size, type, knob, reserved; /* knob: 1 if it trades accuracy for time */
  const char *name, *units, *doc;
  double fallback;  /* the default; of NUMBERS: a list of this one; of a PROFILE: everywhere */
  double low, high; /* both ends included; low == high: unbounded */
  const char* const* choices; /* CHOICE: zero-terminated; the first is the default */
  const double* ladder;       /* knob values, coarse to fine, NaN-terminated; or NULL */
  const char* when;           /* the parameter means something only then */
  const char* text_fallback;  /* TEXT: the default, or NULL for an empty text */
} pileus_parameter;

typedef struct pileus_effect {
  uint32_t size, role;
  const char* name;
  const char* when;
} pileus_effect;

/* One comparison of an activity condition. Conditions of equal `clause` must all hold; any clause
 * suffices. If no clause holds for a parcel, apply would leave it bitwise unchanged and add
 * nothing to a ledger: that is the meaning, and it is audited. */
typedef struct pileus_condition {
  uint32_t size, clause, op, reserved;
  const char* quantity;
  const char* parameter; /* compare with this parameter, or (NULL) with `value` */
  double value;
} pileus_condition;

typedef struct pileus_reference {
  uint32_t size, reserved;
  const char *doi, *text;
} pileus_reference;

/* ---- what the core lends ------------------------------------------------------------------------
 * pileus_host, what its `extension` returns and pileus_values live as long as `self`; steps, blocks
 * and all they point to until the call returns. */
typedef struct pileus_view { /* element k, component c: (char*)data + k*stride + c*lane */
  void* data;                /* NULL when the slot does not exist in this run */
  int64_t stride, lane;      /* bytes */
  int64_t count;             /* elements */
  uint32_t type, components, space, access; /* space 0: host memory; nothing else unasked */
} pileus_view;

typedef struct pileus_grid {    /* two-dimensional runs have cells[1] == 1 */
  int64_t cells[3];             /* x, y, z */
  double origin[3], spacing[3]; /* m */
  uint32_t periodic[3], dimension;
} pileus_grid;

typedef struct pileus_step {
  uint32_t size;
  uint32_t call;   /* below 1024; distinguishes the calls of one operator within one step */
  uint32_t stream; /* distinguishes operators (and the two halves of a Strang step) */
  uint32_t reserved;
  uint64_t number; /* of the step */
  uint64_t seed;   /* of the run */
  double time, dt; /* s; time: start of this call's interval; dt: its length */
} pileus_step;

typedef struct pileus_block {
  uint32_t size, reserved;
  int64_t count;             /* parcels in the views */
  const uint32_t* active;    /* indices to work on, ascending; NULL: all of them */
  int64_t active_count;      /* == count when active is NULL */
  const uint64_t* uid;       /* identity of each parcel: the key of its random numbers */
  const pileus_view* views;  /* one per declared quantity, by slot */
  const int64_t* item_begin; /* per parcel, into ITEM views; NULL without items */
  const int32_t *item_count, *item_room; /* item_room: reserved, NULL */
  const pileus_grid* grid;               /* NULL in a zero-dimensional box */
  double* ledger; /* apply: per declared budget, amount brought in from outside, to be added to */
} pileus_block;

typedef struct pileus_values { /* validated before it is given; lives as long as `self` */
  uint32_t size, count;
  const double* number;      /* also integers (exact to 2^53), switches, choice indices */
  const char* const* text;   /* TEXT and CHOICE, else NULL */
  const double* const* list; /* NUMBERS, else NULL */
  const int64_t* list_count;
} pileus_values;

typedef pileus_status (*pileus_range_fn)(void* user, int64_t begin, int64_t end,
                                         pileus_error* error);

enum { PILEUS_LOG_DEBUG = 0, PILEUS_LOG_INFO, PILEUS_LOG_WARNING, PILEUS_LOG_ERROR };

typedef struct pileus_host { /* no function of minor 0 is NULL */
  uint32_t size, abi_minor;
  void* impl;                                                               /* the core's own */
  void (*log)(const struct pileus_host*, uint32_t level, const char* text); /* [any] */
  /* [any] for long loops: 1 when the run is to end after this step. Who gives up the step instead,
   * with whatever error, ends the run without a checkpoint of it. */
  int (*should_stop)(const struct pileus_host*);
  /* [step][block] 64-byte aligned, undefined contents, gone after the call (in a loop: after the
   * chunk); NULL: no memory, or none asked for */
  void* (*scratch)(const struct pileus_host*, size_t bytes);
  /* [any] draws 0 ... n-1 of a channel (< 64) for one parcel, each in the open interval (0,1);
   * n at most 131072. Philox4x32-10; the keys are specified in pileus/philox.hpp. */
  void (*uniform)(const struct pileus_host*, const pileus_step*, uint64_t uid, uint32_t channel,
                  uint32_t n, double* out);
  /* [step] of GLOBAL operators; not nested. Chunks of `grain`, whatever the number of threads, each
   * with a pileus_error of its own, of which a failing one is handed on. */
  pileus_status (*parallel_for)(const struct pileus_host*, int64_t n, int64_t grain,
                                pileus_range_fn, void* user, pileus_error*);
  /* [any] named timers in the run's ledger; a token of 0 is not timed */
  uint64_t (*span_begin)(const struct pileus_host*, const char* name);
  void (*span_end)(const struct pileus_host*, uint64_t span);
  const void* (*extension)(const struct pileus_host*,
                           const char* id); /* [setup][step] NULL: unknown */
  /* [step][block] counts repairs for the run's ledger: increments that a limiter cut, values moved
   * into their range. Conserving or not, none goes unreported. */
  void (*repaired)(const struct pileus_host*, uint64_t count);
} pileus_host;

/* ---- what a plugin implements --------------------------------------------------------------- */
typedef struct pileus_operator {
  uint32_t size, repeatability, scope, form, flags, reserved;
  const char* id;   /* reverse DNS: pileus_note.module, or that, a dot and more */
  const char* kind; /* "microphysics", "mixing", "surface", "forcing", "thermodynamics", ... */
  const char *version, *title, *summary, *authors, *licence; /* SemVer; SPDX */
  const pileus_reference* const* references; /* these six are zero-terminated lists; NULL: empty */
  const pileus_quantity* const* quantities;
  const pileus_parameter* const* parameters;
  const pileus_effect* const* effects;
  const pileus_condition* const* active_if; /* empty: always active */
  const char* const* budgets;
  /* [setup] Where it fails it leaves nothing behind: destroy is not called. */
  pileus_status (*create)(const pileus_host*, void** self, pileus_error*);
  pileus_status (*configure)(void* self, const pileus_values*, pileus_error*); /* [setup] */
  /* [step] once, at the start of a run that is not a restart: sets what it CREATEs; or NULL */
  pileus_status (*init)(void* self, const pileus_step*, const pileus_block* whole, pileus_error*);
  /* [step] before the blocks of a step: may look at all parcels, write nothing but `self` and
   * *dt_limit (comes in as infinity); or NULL */
  pileus_status (*prepare)(void* self, const pileus_step*, const pileus_block* whole,
                           double* dt_limit, pileus_error*);
  /* [block] derived quantities of all parcels (active is NULL) from the others; pure; in every
   * Runge-Kutta stage; or NULL */
  pileus_status (*diagnose)(void* self, const pileus_step*, const pileus_block*, pileus_error*);
  /* [block] advance by step->dt; NULL: CLOSURE */
  pileus_status (*apply)(void* self, const pileus_step*, const pileus_block*, pileus_error*);
  void (*destroy)(void* self); /* [setup] in any state; never fails */
  /* [setup] after configure; a table that lives as long as `self`, or NULL: unknown; or NULL */
  const void* (*extension)(void* self, const char* id);
} pileus_operator;

/* Extension "pileus.items/1" of the operator that CREATEs the items, asked for once after
 * configure: what the core has to know about them. */
#define PILEUS_ITEMS_EXTENSION "pileus.items/1"
typedef struct pileus_items_ext {
  uint32_t size, reserved;
  int64_t most_per_parcel; /* longer lists are shortened once a step; 0: never */
  double budget_scale;     /* amounts over it are in the unit of volume times mass fraction: the
                            * density of the air for items with a mass; above 0 */
} pileus_items_ext;

/* Extension of the host "pileus.item_lists/1", for the maker of the items in init and for operators
 * with PILEUS_RESIZES_ITEMS, which are GLOBAL, in init and apply [step]. */
#define PILEUS_ITEM_LISTS_EXTENSION "pileus.item_lists/1"
typedef struct pileus_item_lists_ext {
  uint32_t size, reserved;
  void* impl;          /* the core's own */
  double budget_scale; /* of pileus_items_ext, as the maker of the items has said */
  /* Replaces the lists of all parcels: parcel p gets count[p] items, and new item k, parcel after
   * parcel, is a copy of the old item source[k] or, where that is negative, all zeros; source NULL:
   * all are. `block` has to be that of the running call; its ITEM views, item_begin and item_count
   * are those of the new lists afterwards. */
  pileus_status (*regroup)(const struct pileus_item_lists_ext*, const pileus_block* block,
                           const int32_t* count, const int64_t* source, pileus_error*);
} pileus_item_lists_ext;

/* Extension of the host "pileus.mesh/1": between parcels and mesh with the core's own weights, for
 * GLOBAL operators [step]. A field has one record of `width` doubles per node; records of a column
 * follow each other upwards, from one level below the lower wall to one above the upper one:
 * record (j * cells[0] + i) * levels + k + 1 for level k = -1 ... cells[2] + 1 of column (i, j).
 * Arrays over the parcels are 64-byte aligned with room for whole cache lines, as views of all
 * parcels and `scratch` are. Same bits for any number of threads. */
#define PILEUS_MESH_EXTENSION "pileus.mesh/1"
typedef struct pileus_mesh_ext {
  uint32_t size, width; /* doubles per record */
  int64_t nodes, levels;
  void* impl; /* the core's own */
  /* Gathers per-volume values (at most width - 1) of all `parcels`: record[0] is the volume at the
   * node, record[1 + f] the volume-weighted mean of values[f]. Half cells at a wall count double
   * and what reaches beyond it is gathered one level inside. */
  pileus_status (*deposit)(const struct pileus_mesh_ext*, int64_t parcels,
                           const double* const* values, uint32_t count, double* field,
                           pileus_error*);
  /* values[f][p] = sum over nodes of weight * record[f], with weights that are not negative, sum to
   * one, and are those of `deposit`. The levels beyond the walls are set to the mirror image of
   * those inside, whatever they held, so that with f and phi on the nodes and
   *   new_p = phi_p + sum_nodes weight * f * (phi - phi_p)
   * the sum of volume * phi_p stays the same for any f: what a node takes from its parcels it gives
   * back to them. */
  pileus_status (*interpolate)(const struct pileus_mesh_ext*, int64_t parcels, double* field,
                               double* const* values, uint32_t count, pileus_error*);
} pileus_mesh_ext;

/* Extension "pileus.state/1" of an operator, asked for once after configure: private memory that
 * the declared quantities cannot express. It changes in init and prepare alone, since a call of
 * apply may be rejected and repeated. Every checkpoint holds it. */
#define PILEUS_STATE_EXTENSION "pileus.state/1"
typedef struct pileus_state_ext {
  uint32_t size, format; /* format: the plugin's own revision of the bytes */
  /* [step] Hands over the bytes, in as many parts as it likes. `put` returns 0 when there is no
   * room for more; then PILEUS_E_MEMORY is to be returned. */
  pileus_status (*save)(void* self, int (*put)(void* sink, const void* bytes, size_t count),
                        void* sink, pileus_error*);
  /* [step] at a restart, where there is no init. The format is that of the plugin that saved; what
   * it cannot read it refuses. */
  pileus_status (*load)(void* self, uint32_t format, const void* bytes, size_t count,
                        pileus_error*);
} pileus_state_ext;

/* ---- entry ---------------------------------------------------------------------------------- */
typedef struct pileus_module {
  uint32_t size, abi_minor_built, abi_minor_needed, reserved; /* the minors: as in the note */
  const pileus_operator* const* operators;                    /* zero-terminated */
} pileus_module;
/* The one exported function. [setup] No side effects; must not fail. */
PILEUS_EXPORT const pileus_module* pileus_module_v1(void);

/* Facts about the binary, in the ELF section PILEUS_NOTE_SECTION: read from the file before any of
 * its code runs. The first record of the section counts. */
#define PILEUS_NOTE_SECTION ".pileus.note"
#define PILEUS_NOTE_MAGIC "PILEUSNOTE1"
enum { PILEUS_BUILT_FASTMATH = 1u, PILEUS_BUILT_ASSERTS = 2u, PILEUS_BUILT_SANITIZED = 4u };
typedef struct pileus_note {
  char magic[16]; /* PILEUS_NOTE_MAGIC, zero-padded */
  /* Needed: the lowest minor of a program that it runs in; 0 where all that is newer is asked for
   * with PILEUS_HAS. Built: that of the header, for people. */
  uint32_t abi_major, abi_minor_built, abi_minor_needed, build_flags;
  char module[64], version[32], toolchain[64], reserved[64]; /* zero-terminated texts */
} pileus_note;

#ifdef __cplusplus
}
#endif
#endif /* PILEUS_ABI_H */
