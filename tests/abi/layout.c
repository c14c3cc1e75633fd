/* The layout of the plugin contract as a C compiler sees it. */
#include "print_layout.h"
