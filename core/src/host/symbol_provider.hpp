// Where a symbol of a library that is to be loaded would come from.
#pragma once
#include <string>

namespace pileus::host {

/// File of the object in this process that gives out the symbol; empty if none does.
std::string provider_of(const std::string& symbol);

}  // namespace pileus::host
