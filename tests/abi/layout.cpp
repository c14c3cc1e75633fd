/* Prints the layout of the plugin contract as a C++ compiler sees it. */
#include <pileus/abi.h>
#include <stdio.h>

#define SIZE(TYPE) printf(#TYPE " %zu\n", sizeof(TYPE));
#define OFFSET(TYPE, MEMBER) printf(#TYPE "." #MEMBER " %zu\n", offsetof(TYPE, MEMBER));

int main() {
#include "layout.inc"
  return 0;
}
