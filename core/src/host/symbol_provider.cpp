#include "host/symbol_provider.hpp"

#include <dlfcn.h>

namespace pileus::host {

std::string provider_of(const std::string& symbol) {
  const void* address = ::dlsym(RTLD_DEFAULT, symbol.c_str());
  Dl_info info{};
  if (address == nullptr || ::dladdr(address, &info) == 0 || info.dli_fname == nullptr) return {};
  return info.dli_fname;
}

}  // namespace pileus::host
