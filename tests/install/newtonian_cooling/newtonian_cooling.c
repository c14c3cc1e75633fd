/* Newtonian cooling in plain C11: the potential temperature of every parcel relaxes to one value,
 *
 *   d theta/dt = (target - theta)/time_scale,
 *
 * by its exact solution. What the C++ layer does by itself stands here in full: the tables of
 * declarations, the values of an instance, the entry function and the note. */
#include <math.h>
#include <pileus/abi.h>
#include <stdio.h>
#include <stdlib.h>

#define ID "org.example.newtonian_cooling"
#define VERSION "1.0.0"

/* Positions in the lists below. */
enum { THETA };
enum { TIME_SCALE, TARGET };

struct cooling {
  double time_scale; /* s */
  double target;     /* K */
};

static const pileus_quantity theta = {.size = sizeof(pileus_quantity),
                                      .place = PILEUS_PARCEL,
                                      .type = PILEUS_F64,
                                      .components = 1,
                                      .access = PILEUS_READ | PILEUS_WRITE,
                                      .nature = PILEUS_INTENSIVE,
                                      .name = "air_potential_temperature",
                                      .units = "K",
                                      .weight = "parcel_volume",
                                      .low = 50,
                                      .high = 2000,
                                      .doc = "relaxed; the scene or another operator brings it"};
static const pileus_quantity* const quantities[] = {[THETA] = &theta, NULL};

static const pileus_parameter time_scale = {.size = sizeof(pileus_parameter),
                                            .type = PILEUS_NUMBER,
                                            .name = "time_scale",
                                            .units = "s",
                                            .doc = "e-folding time",
                                            .fallback = 86400,
                                            .low = 1,
                                            .high = 1e9};
static const pileus_parameter target = {.size = sizeof(pileus_parameter),
                                        .type = PILEUS_NUMBER,
                                        .name = "target",
                                        .units = "K",
                                        .doc = "value relaxed to",
                                        .fallback = 300,
                                        .low = 50,
                                        .high = 2000};
static const pileus_parameter* const parameters[] = {
    [TIME_SCALE] = &time_scale, [TARGET] = &target, NULL};

static const pileus_effect cools = {
    .size = sizeof(pileus_effect), .role = PILEUS_PROVIDES, .name = "newtonian_cooling"};
static const pileus_effect* const effects[] = {&cools, NULL};

static const pileus_reference held_suarez = {
    .size = sizeof(pileus_reference),
    .doi = "10.1175/1520-0477(1994)075<1825:APFTIO>2.0.CO;2",
    .text = "Held & Suarez 1994: Newtonian cooling"};
static const pileus_reference* const references[] = {&held_suarez, NULL};

static pileus_status create(const pileus_host* host, void** self, pileus_error* error) {
  (void)host;
  *self = calloc(1, sizeof(struct cooling));
  if (*self != NULL) return PILEUS_OK;
  snprintf(error->text, sizeof error->text, "out of memory");
  return PILEUS_E_MEMORY;
}

static pileus_status configure(void* self, const pileus_values* values, pileus_error* error) {
  (void)error; /* ranges were checked before */
  struct cooling* me = self;
  me->time_scale = values->number[TIME_SCALE];
  me->target = values->number[TARGET];
  return PILEUS_OK;
}

/* Dense or not: a view says how far its elements are apart. */
static double* element(const pileus_view* view, int64_t parcel) {
  return (double*)((char*)view->data + parcel * view->stride);
}

static pileus_status apply(void* self, const pileus_step* step, const pileus_block* block,
                           pileus_error* error) {
  (void)error; /* the exact solution cannot fail */
  const struct cooling* me = self;
  /* expm1, so that a step of zero changes nothing and short steps lose no digits. */
  const double share = -expm1(-step->dt / me->time_scale);
  for (int64_t k = 0; k < block->active_count; ++k) {
    const int64_t parcel = block->active != NULL ? (int64_t)block->active[k] : k;
    double* value = element(&block->views[THETA], parcel);
    *value += share * (me->target - *value);
  }
  return PILEUS_OK;
}

static void destroy(void* self) {
  free(self);
}

static const pileus_operator cooling = {
    .size = sizeof(pileus_operator),
    .repeatability = PILEUS_REPEAT_RANKS,
    .scope = PILEUS_LOCAL,
    .form = PILEUS_FLOW,
    .id = ID,
    .kind = "forcing",
    .version = VERSION,
    .title = "Newtonian cooling",
    .summary = "Relaxes the potential temperature to one value, exactly for any time step.",
    .authors = "Pileus contributors",
    .licence = "Apache-2.0",
    .references = references,
    .quantities = quantities,
    .parameters = parameters,
    .effects = effects,
    .create = create,
    .configure = configure,
    .apply = apply,
    .destroy = destroy};

PILEUS_EXPORT const pileus_module* pileus_module_v1(void) {
  static const pileus_operator* const operators[] = {&cooling, NULL};
  static const pileus_module module = {.size = sizeof(pileus_module),
                                       .abi_minor_built = PILEUS_ABI_MINOR,
                                       .abi_minor_needed = 0,
                                       .operators = operators};
  return &module;
}

__attribute__((section(PILEUS_NOTE_SECTION), used)) static const pileus_note note = {
    .magic = PILEUS_NOTE_MAGIC,
    .abi_major = PILEUS_ABI_MAJOR,
    .abi_minor_built = PILEUS_ABI_MINOR,
    .module = ID,
    .version = VERSION,
    .toolchain = "C11, " __VERSION__};
