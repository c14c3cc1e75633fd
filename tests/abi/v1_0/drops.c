/* Makes two items per parcel, of masses 1 and 3, in lists that it asks the core for; a loop over
 * all threads doubles their masses. Uses: items, the extensions on both sides, parallel_for,
 * scratch. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "operators.h"

enum { NUMBER, MASS };

static const pileus_quantity number = {.size = sizeof(pileus_quantity),
                                       .place = PILEUS_ITEM,
                                       .type = PILEUS_I64,
                                       .components = 1,
                                       .access = PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE,
                                       .nature = PILEUS_EXTENSIVE,
                                       .name = "droplet_multiplicity",
                                       .units = "1",
                                       .high = 1e18};
static const pileus_quantity mass = {.size = sizeof(pileus_quantity),
                                     .place = PILEUS_ITEM,
                                     .type = PILEUS_F64,
                                     .components = 1,
                                     .access = PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE,
                                     .nature = PILEUS_INTENSIVE,
                                     .name = "droplet_water_mass",
                                     .units = "kg",
                                     .weight = "droplet_multiplicity",
                                     .high = 1e30};
static const pileus_quantity* const quantities[] = {[NUMBER] = &number, [MASS] = &mass, NULL};

struct drops {
  const pileus_host* host;
};

static pileus_status create(const pileus_host* host, void** self, pileus_error* error) {
  struct drops* made = calloc(1, sizeof *made);
  (void)error;
  *self = made;
  if (made == NULL) return PILEUS_E_MEMORY;
  made->host = host;
  return PILEUS_OK;
}

static pileus_status configure(void* self, const pileus_values* values, pileus_error* error) {
  (void)self;
  (void)values;
  (void)error;
  return PILEUS_OK;
}

static pileus_status init(void* self, const pileus_step* step, const pileus_block* whole,
                          pileus_error* error) {
  const pileus_host* host = ((struct drops*)self)->host;
  const pileus_item_lists_ext* lists = host->extension(host, PILEUS_ITEM_LISTS_EXTENSION);
  (void)step;
  if (lists == NULL) return PILEUS_E_UNSUPPORTED;
  int32_t* count = host->scratch(host, (size_t)whole->count * sizeof *count);
  if (count == NULL && whole->count > 0) return PILEUS_E_MEMORY;
  for (int64_t p = 0; p < whole->count; ++p) count[p] = 2;
  const pileus_status status = lists->regroup(lists, whole, count, NULL, error);
  if (status != PILEUS_OK) return status;
  for (int64_t p = 0; p < whole->count; ++p) {
    for (int64_t k = 0; k < whole->item_count[p]; ++k) {
      const int64_t item = whole->item_begin[p] + k;
      *(int64_t*)((char*)whole->views[NUMBER].data + item * whole->views[NUMBER].stride) = 5;
      *element(&whole->views[MASS], item) = k == 0 ? 1 : 3;
    }
  }
  return PILEUS_OK;
}

static pileus_status double_some(void* user, int64_t begin, int64_t end, pileus_error* error) {
  (void)error;
  for (int64_t item = begin; item < end; ++item) *element(user, item) *= 2;
  return PILEUS_OK;
}

static pileus_status apply(void* self, const pileus_step* step, const pileus_block* block,
                           pileus_error* error) {
  const pileus_host* host = ((struct drops*)self)->host;
  pileus_view masses = block->views[MASS];
  if (step->dt == 0) return PILEUS_OK;
  return host->parallel_for(host, masses.count, 64, double_some, &masses, error);
}

static const void* extension(void* self, const char* id) {
  static const pileus_items_ext items = {
      .size = sizeof(pileus_items_ext), .most_per_parcel = 4, .budget_scale = 1};
  (void)self;
  return strcmp(id, PILEUS_ITEMS_EXTENSION) == 0 ? &items : NULL;
}

const pileus_operator drops = {.size = sizeof(pileus_operator),
                               .repeatability = PILEUS_REPEAT_THREADS,
                               .scope = PILEUS_GLOBAL,
                               .form = PILEUS_FLOW,
                               .id = MODULE ".drops",
                               .kind = "test",
                               .version = VERSION,
                               .title = "Doubling drops",
                               .summary = "Makes two drops per parcel and doubles them.",
                               .authors = "Pileus contributors",
                               .licence = "Apache-2.0",
                               .references = references,
                               .quantities = quantities,
                               .create = create,
                               .configure = configure,
                               .init = init,
                               .apply = apply,
                               .destroy = free,
                               .extension = extension};
