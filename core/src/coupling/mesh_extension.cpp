#include "coupling/mesh_extension.hpp"

#include <cstdint>
#include <cstdio>
#include <new>

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"

namespace pileus::coupling {
namespace {

pileus_status refuse(pileus_error* error, const char* text) {
  if (error != nullptr) std::snprintf(error->text, sizeof error->text, "%s", text);
  return PILEUS_E_INPUT;
}

/// Vector code reads and writes whole cache lines: elsewhere it would end the process.
bool is_aligned(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer) % cache_line_bytes == 0;
}

/// A sentence on what is wrong with a call, or null.
template <class T>
const char* complaint(std::int64_t parcels, const parcels::Store& store, T* const* values,
                      std::uint32_t count, std::uint32_t most, const double* field) {
  if (omp_in_parallel())
    return "mesh functions run loops of their own: they cannot be called inside a parallel loop";
  if (field == nullptr || (values == nullptr && count > 0))
    return "a mesh function was given a null pointer";
  if (count > most) return "more values than a record of the mesh has room for";
  bool aligned = is_aligned(field);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (values[i] == nullptr) return "a mesh function was given a null pointer";
    aligned = aligned && is_aligned(values[i]);
  }
  if (!aligned)
    return "mesh functions need arrays that begin at a multiple of 64 bytes, as scratch memory and "
           "the views of all parcels do";
  if (parcels != static_cast<std::int64_t>(store.size()))
    return "mesh functions need arrays over all parcels: only an operator of global scope without "
           "activity conditions has them";
  return nullptr;
}

/// No exception crosses to the plugin.
template <class Body>
pileus_status guarded(pileus_error* error, Body&& body) noexcept {
  try {
    body();
    return PILEUS_OK;
  } catch (const std::bad_alloc&) {
    refuse(error, "out of memory in a mesh function");
    return PILEUS_E_MEMORY;
  } catch (...) {
    refuse(error, "a mesh function failed");
    return PILEUS_E_INTERNAL;
  }
}

}  // namespace

MeshExtension::MeshExtension(MeshAccess& access, const parcels::Store& store)
    : access_(access), store_(store) {
  table_.size = sizeof table_;
  table_.width = static_cast<std::uint32_t>(access.record_width());
  table_.nodes = static_cast<std::int64_t>(access.nodes());
  table_.levels = access.levels();
  table_.impl = this;
  table_.deposit = deposit;
  table_.interpolate = interpolate;
}

pileus_status MeshExtension::deposit(const pileus_mesh_ext* ext, std::int64_t parcels,
                                     const double* const* values, std::uint32_t count,
                                     double* field, pileus_error* error) {
  auto& me = *static_cast<MeshExtension*>(ext->impl);
  if (const char* text = complaint(parcels, me.store_, values, count, ext->width - 1, field))
    return refuse(error, text);
  return guarded(error, [&] { me.access_.deposit({values, count}, field); });
}

pileus_status MeshExtension::interpolate(const pileus_mesh_ext* ext, std::int64_t parcels,
                                         double* field, double* const* values, std::uint32_t count,
                                         pileus_error* error) {
  auto& me = *static_cast<MeshExtension*>(ext->impl);
  if (const char* text = complaint(parcels, me.store_, values, count, ext->width, field))
    return refuse(error, text);
  return guarded(error, [&] {
    me.access_.mirror(field);
    me.access_.interpolate(field, {values, count});
  });
}

}  // namespace pileus::coupling
