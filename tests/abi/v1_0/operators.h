/* The operators of this library, written against the header beside it and nothing else. */
#ifndef OPERATORS_H
#define OPERATORS_H
#include "abi.h"

#define MODULE "org.example.v1_0"
#define VERSION "1.0.0"

extern const pileus_operator decay, pulse, drops;

/* What all of them have in common: NULL-terminated and static. */
extern const pileus_reference* const references[];

/* Element k of a view of doubles. */
static inline double* element(const pileus_view* view, int64_t k) {
  return (double*)((char*)view->data + k * view->stride);
}

#endif
