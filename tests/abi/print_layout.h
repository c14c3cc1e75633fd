/* Prints the layout and the values of the plugin contract, one a line, as a compiler sees them. */
#include <pileus/abi.h>
#include <pileus/selftest.h>
#include <stdio.h>

#define OFFSET(TYPE, MEMBER) printf(#TYPE "." #MEMBER " %zu\n", offsetof(TYPE, MEMBER));
#define SIZE(TYPE) printf(#TYPE " %zu\n", sizeof(TYPE));
#define NUMBER(NAME) printf(#NAME " %llu\n", (unsigned long long)(NAME));
#define TEXT(NAME) printf(#NAME " %s\n", NAME);

int main(void) {
#include "layout.inc" /* made by header.py */
  return 0;
}
