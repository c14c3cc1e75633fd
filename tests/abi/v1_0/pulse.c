/* The humidity of every parcel grows by dt times the number of the calls of prepare, which is
 * private memory: the extension pileus.state/1. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "operators.h"

enum { FORMAT = 3 };

static const pileus_quantity humidity = {.size = sizeof(pileus_quantity),
                                         .place = PILEUS_PARCEL,
                                         .type = PILEUS_F64,
                                         .components = 1,
                                         .access = PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE,
                                         .nature = PILEUS_INTENSIVE,
                                         .name = "specific_humidity",
                                         .units = "1",
                                         .weight = "parcel_volume",
                                         .high = 1e30};
static const pileus_quantity* const quantities[] = {&humidity, NULL};

static pileus_status create(const pileus_host* host, void** self, pileus_error* error) {
  (void)host;
  (void)error;
  *self = calloc(1, sizeof(uint64_t));
  return *self != NULL ? PILEUS_OK : PILEUS_E_MEMORY;
}

static pileus_status configure(void* self, const pileus_values* values, pileus_error* error) {
  (void)self;
  (void)values;
  (void)error;
  return PILEUS_OK;
}

static pileus_status prepare(void* self, const pileus_step* step, const pileus_block* whole,
                             double* dt_limit, pileus_error* error) {
  (void)step;
  (void)whole;
  (void)dt_limit;
  (void)error;
  ++*(uint64_t*)self;
  return PILEUS_OK;
}

static pileus_status apply(void* self, const pileus_step* step, const pileus_block* block,
                           pileus_error* error) {
  const double calls = (double)*(const uint64_t*)self;
  (void)error;
  for (int64_t k = 0; k < block->active_count; ++k) {
    const int64_t parcel = block->active != NULL ? (int64_t)block->active[k] : k;
    *element(&block->views[0], parcel) += step->dt * calls;
  }
  return PILEUS_OK;
}

static pileus_status save(void* self, int (*put)(void* sink, const void* bytes, size_t count),
                          void* sink, pileus_error* error) {
  (void)error;
  return put(sink, self, sizeof(uint64_t)) ? PILEUS_OK : PILEUS_E_MEMORY;
}

static pileus_status load(void* self, uint32_t format, const void* bytes, size_t count,
                          pileus_error* error) {
  if (format != FORMAT || count != sizeof(uint64_t)) {
    snprintf(error->text, sizeof error->text,
             "its private state has format %u and %zu bytes, expected are %d and %zu", format,
             count, FORMAT, sizeof(uint64_t));
    return PILEUS_E_INPUT;
  }
  memcpy(self, bytes, count);
  return PILEUS_OK;
}

static const void* extension(void* self, const char* id) {
  static const pileus_state_ext state = {
      .size = sizeof(pileus_state_ext), .format = FORMAT, .save = save, .load = load};
  (void)self;
  return strcmp(id, PILEUS_STATE_EXTENSION) == 0 ? &state : NULL;
}

const pileus_operator pulse = {.size = sizeof(pileus_operator),
                               .repeatability = PILEUS_REPEAT_RANKS,
                               .scope = PILEUS_LOCAL,
                               .form = PILEUS_FLOW,
                               .id = MODULE ".pulse",
                               .kind = "test",
                               .version = VERSION,
                               .title = "Counted pulse",
                               .summary = "Moistens by the number of its calls so far.",
                               .authors = "Pileus contributors",
                               .licence = "Apache-2.0",
                               .references = references,
                               .quantities = quantities,
                               .create = create,
                               .configure = configure,
                               .prepare = prepare,
                               .apply = apply,
                               .destroy = free,
                               .extension = extension};
