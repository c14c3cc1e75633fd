#include "output/named_data.hpp"

#include <stdexcept>
#include <string_view>
#include <type_traits>

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

namespace {

/// A name HDF5 takes as one link: it reads '/' as a path and '.' as the group itself.
std::string link_name(const std::string& name) {
  if (name.empty() || name.find('\0') != std::string::npos)
    throw std::invalid_argument("stored items need a name without NUL");
  std::string link;
  for (const char c : name) link += c == '/' ? "%2F" : c == '%' ? "%25" : std::string(1, c);
  return link == "." ? "%2E" : link;
}

std::string name_of_link(const std::string& link) {
  std::string name;
  for (std::size_t i = 0; i < link.size(); ++i) {
    const std::string_view code = std::string_view(link).substr(i, 3);
    const char c = code == "%2F" ? '/' : code == "%25" ? '%' : code == "%2E" ? '.' : '\0';
    name += c != '\0' ? c : link[i];
    if (c != '\0') i += 2;
  }
  return name;
}

template <class T>
hid_t native_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

template <class T>
void write_section(const Session& session, const std::string& section,
                   const std::map<std::string, std::vector<T>>& items) {
  const Id group = hdf5::create_group(session, session.file(), section);
  for (const auto& [name, values] : items) {
    hdf5::write_array(session, group, link_name(name), native_type<T>(), native_type<T>(),
                      values.data(), values.size());
  }
}

template <class T>
void read_section(const Session& session, const std::string& section,
                  std::map<std::string, std::vector<T>>& items) {
  const Id group(
      session.check(H5Gopen2(session.file(), section.c_str(), H5P_DEFAULT), "open " + section));
  for (const std::string& link : hdf5::object_names(session, group)) {
    const std::string name = name_of_link(link);
    std::vector<T>& values = items[name];
    values = hdf5::read_array<T>(session, group, link);
  }
}

}  // namespace

void write_named_data(const Session& session, const NamedData& data) {
  write_section(session, "arrays", data.arrays);
  write_section(session, "counters", data.counters);
  write_section(session, "bytes", data.bytes);
  const Id texts = hdf5::create_group(session, session.file(), "texts");
  for (const auto& [name, text] : data.texts) {
    if (text.find('\0') != std::string::npos)
      throw std::invalid_argument("stored text " + name + " holds NUL");
    hdf5::write_text(session, texts, link_name(name), text);
  }
}

NamedData read_named_data(const Session& session) {
  NamedData data;
  read_section(session, "arrays", data.arrays);
  read_section(session, "counters", data.counters);
  read_section(session, "bytes", data.bytes);
  const Id texts(session.check(H5Gopen2(session.file(), "texts", H5P_DEFAULT), "open texts"));
  for (const std::string& link : hdf5::object_names(session, texts)) {
    std::string& text = data.texts[name_of_link(link)];
    text = hdf5::read_text(session, texts, link);
  }
  return data;
}

}  // namespace pileus::output
