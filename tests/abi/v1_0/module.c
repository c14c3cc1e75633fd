/* The entry function and the note. */
#include <stddef.h>

#include "operators.h"

static const pileus_reference none = {.size = sizeof(pileus_reference),
                                      .text = "no reference: a test of the plugin interface"};
const pileus_reference* const references[] = {&none, NULL};

PILEUS_EXPORT const pileus_module* pileus_module_v1(void) {
  static const pileus_operator* const operators[] = {&decay, &pulse, &drops, NULL};
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
    .module = MODULE,
    .version = VERSION,
    .toolchain = "C11, " __VERSION__};
