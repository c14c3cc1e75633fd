/* pileus/selftest.h - extension "pileus.selftest/1": tests that a plugin brings for itself, run by
 * `pileus conform`. Plain C11, under the rules of pileus/abi.h. */
#ifndef PILEUS_SELFTEST_H
#define PILEUS_SELFTEST_H
#include "abi.h"
#ifdef __cplusplus
extern "C" {
#endif

#define PILEUS_SELFTEST_EXTENSION "pileus.selftest/1"
/* Asked for after configure with the default parameters [setup]. */
typedef struct pileus_selftest_ext {
  uint32_t size, count;                                           /* count: of the tests */
  const char* (*name)(void* self, uint32_t test);                 /* a few words */
  pileus_status (*run)(void* self, uint32_t test, pileus_error*); /* PILEUS_OK: passed */
} pileus_selftest_ext;

#ifdef __cplusplus
}
#endif
#endif /* PILEUS_SELFTEST_H */
