/* A tracer of the parcels decays towards a floor, by the exact solution:
 *
 *   c(t + dt) = floor + (c(t) - floor) exp(-rate dt)   where c > floor.
 *
 * Uses: a quantity that it owns, one that it reads, parameters, a condition of activity that
 * compares with one of them, a budget, an effect. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "operators.h"

enum { TRACER, VOLUME };
enum { RATE, FLOOR };

struct decay {
  double rate, floor;
};

static const pileus_quantity tracer = {.size = sizeof(pileus_quantity),
                                       .place = PILEUS_PARCEL,
                                       .type = PILEUS_F64,
                                       .components = 1,
                                       .access = PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE,
                                       .nature = PILEUS_INTENSIVE,
                                       .name = "passive_tracer",
                                       .units = "1",
                                       .weight = "parcel_volume",
                                       .budget = "tracer",
                                       .high = 100,
                                       .initial = 2};
static const pileus_quantity volume = {.size = sizeof(pileus_quantity),
                                       .place = PILEUS_PARCEL,
                                       .type = PILEUS_F64,
                                       .components = 1,
                                       .access = PILEUS_READ,
                                       .name = "parcel_volume",
                                       .units = "m3",
                                       .high = 1e30};
static const pileus_quantity* const quantities[] = {[TRACER] = &tracer, [VOLUME] = &volume, NULL};

static const pileus_parameter rate = {.size = sizeof(pileus_parameter),
                                      .type = PILEUS_NUMBER,
                                      .name = "rate",
                                      .units = "s-1",
                                      .fallback = 0.125,
                                      .high = 10};
static const pileus_parameter base = {.size = sizeof(pileus_parameter),
                                      .type = PILEUS_NUMBER,
                                      .name = "floor",
                                      .units = "1",
                                      .fallback = 0.5,
                                      .high = 10};
static const pileus_parameter* const parameters[] = {[RATE] = &rate, [FLOOR] = &base, NULL};

static const pileus_condition above = {.size = sizeof(pileus_condition),
                                       .op = PILEUS_GT,
                                       .quantity = "passive_tracer",
                                       .parameter = "floor"};
static const pileus_condition* const active_if[] = {&above, NULL};

static const pileus_effect decays = {
    .size = sizeof(pileus_effect), .role = PILEUS_PROVIDES, .name = "tracer_decay"};
static const pileus_effect* const effects[] = {&decays, NULL};
static const char* const budgets[] = {"tracer", NULL};

static pileus_status create(const pileus_host* host, void** self, pileus_error* error) {
  (void)host;
  (void)error;
  *self = calloc(1, sizeof(struct decay));
  return *self != NULL ? PILEUS_OK : PILEUS_E_MEMORY;
}

static pileus_status configure(void* self, const pileus_values* values, pileus_error* error) {
  struct decay* me = self;
  (void)error;
  me->rate = values->number[RATE];
  me->floor = values->number[FLOOR];
  return PILEUS_OK;
}

static pileus_status apply(void* self, const pileus_step* step, const pileus_block* block,
                           pileus_error* error) {
  const struct decay* me = self;
  const double lost = -expm1(-me->rate * step->dt);
  (void)error;
  for (int64_t k = 0; k < block->active_count; ++k) {
    const int64_t parcel = block->active != NULL ? (int64_t)block->active[k] : k;
    double* value = element(&block->views[TRACER], parcel);
    if (*value <= me->floor) continue;
    const double loss = lost * (*value - me->floor);
    *value -= loss;
    block->ledger[0] -= loss * *element(&block->views[VOLUME], parcel);
  }
  return PILEUS_OK;
}

const pileus_operator decay = {
    .size = sizeof(pileus_operator),
    .repeatability = PILEUS_REPEAT_RANKS,
    .scope = PILEUS_LOCAL,
    .form = PILEUS_FLOW,
    .id = MODULE ".decay",
    .kind = "test",
    .version = VERSION,
    .title = "Decay to a floor",
    .summary = "Lets a tracer decay to a floor, exactly for any time step.",
    .authors = "Pileus contributors",
    .licence = "Apache-2.0",
    .references = references,
    .quantities = quantities,
    .parameters = parameters,
    .effects = effects,
    .active_if = active_if,
    .budgets = budgets,
    .create = create,
    .configure = configure,
    .apply = apply,
    .destroy = free};
