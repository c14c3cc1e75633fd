#include "output/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <string_view>

#include "base/log.hpp"
#include "output/seal.hpp"

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

namespace {

constexpr std::string_view file_prefix = "checkpoint_", file_suffix = ".h5";
constexpr const char* format_name = "pileus checkpoint 1";

/// The step in the name of a checkpoint, or nothing for other files.
std::optional<std::uint64_t> step_of(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  if (name.size() <= file_prefix.size() + file_suffix.size() || !name.starts_with(file_prefix) ||
      !name.ends_with(file_suffix))
    return {};
  std::uint64_t step = 0;
  const char* end = name.data() + name.size() - file_suffix.size();
  const auto [stop, error] = std::from_chars(name.data() + file_prefix.size(), end, step);
  if (error != std::errc{} || stop != end) return {};
  return step;
}

struct Header {
  double time = 0, dt = 0;
  std::uint64_t step = 0, parcels = 0, dimension = 0;
};

void write_header(const Session& session, const Header& header) {
  const hid_t file = session.file();
  hdf5::write_attribute(session, file, "format", format_name);
  hdf5::write_attribute(session, file, "time", H5T_NATIVE_DOUBLE, &header.time);
  hdf5::write_attribute(session, file, "dt", H5T_NATIVE_DOUBLE, &header.dt);
  hdf5::write_attribute(session, file, "step", H5T_NATIVE_UINT64, &header.step);
  hdf5::write_attribute(session, file, "parcels", H5T_NATIVE_UINT64, &header.parcels);
  hdf5::write_attribute(session, file, "dimension", H5T_NATIVE_UINT64, &header.dimension);
}

Header read_header(const Session& session) {
  const hid_t file = session.file();
  const std::string format = hdf5::read_text_attribute(session, file, "format");
  if (format != format_name)
    throw Error(ExitCode::file, fmt::format("{}: the file has the form \"{}\", not \"{}\".",
                                            session.path().string(), format, format_name));
  Header header;
  hdf5::read_attribute(session, file, "time", H5T_NATIVE_DOUBLE, &header.time);
  hdf5::read_attribute(session, file, "dt", H5T_NATIVE_DOUBLE, &header.dt);
  hdf5::read_attribute(session, file, "step", H5T_NATIVE_UINT64, &header.step);
  hdf5::read_attribute(session, file, "parcels", H5T_NATIVE_UINT64, &header.parcels);
  hdf5::read_attribute(session, file, "dimension", H5T_NATIVE_UINT64, &header.dimension);
  return header;
}

Id open_state(const Session& session) {
  return Id(session.check(H5Gopen2(session.file(), "state", H5P_DEFAULT), "open the state"));
}

/// Counts per parcel, multiplicities and columns; in a group of their own, which a run without
/// items does not have.
void write_items(const Session& session, const parcels::ItemLists& items) {
  const Id group = hdf5::create_group(session, session.file(), "items");
  hdf5::write_array(session, group, "count", H5T_STD_I32LE, H5T_NATIVE_INT32, items.count(),
                    items.parcels());
  hdf5::write_array(session, group, items.declaration().multiplicity, H5T_STD_I64LE,
                    H5T_NATIVE_INT64, items.multiplicity(), items.size());
  for (std::size_t c = 0; c < items.declaration().columns.size(); ++c)
    hdf5::write_array(session, group, items.declaration().columns[c].name, H5T_IEEE_F64LE,
                      H5T_NATIVE_DOUBLE, items.column(static_cast<int>(c)), items.size());
}

void read_items(const Session& session, parcels::ItemLists& items, std::size_t parcels) {
  const parcels::ItemDeclaration& declared = items.declaration();
  std::set<std::string> wanted = {"count", declared.multiplicity};
  for (const parcels::ItemColumn& column : declared.columns) wanted.insert(column.name);
  std::set<std::string> found;
  const bool any = hdf5::has_object(session.file(), "items");
  if (!any && !items.exist()) return;
  Id group;
  if (any) {
    group = Id(session.check(H5Gopen2(session.file(), "items", H5P_DEFAULT), "open the items"));
    for (const std::string& name : hdf5::object_names(session, group)) found.insert(name);
  }
  if (found != wanted || !items.exist())
    throw Error(
        ExitCode::file,
        fmt::format("{}: the checkpoint is of another scene: its parcels' items carry [{}], "
                    "those of the scene [{}].",
                    session.path().string(), fmt::join(found, ", "),
                    items.exist() ? fmt::format("{}", fmt::join(wanted, ", ")) : ""));
  std::vector<std::int32_t> count(parcels);
  hdf5::read_array_into(session, group, "count", H5T_NATIVE_INT32, count.data(), parcels);
  std::int64_t total = 0;
  for (const std::int32_t n : count) {
    if (n < 0)
      throw Error(ExitCode::file, fmt::format("{}: a parcel has a negative number of items.",
                                              session.path().string()));
    total += n;
  }
  items.start(parcels);
  items.regroup(count, std::vector<std::int64_t>(static_cast<std::size_t>(total), -1));
  hdf5::read_array_into(session, group, declared.multiplicity, H5T_NATIVE_INT64,
                        items.multiplicity(), items.size());
  for (std::size_t c = 0; c < declared.columns.size(); ++c)
    hdf5::read_array_into(session, group, declared.columns[c].name, H5T_NATIVE_DOUBLE,
                          items.column(static_cast<int>(c)), items.size());
}

void require_same_columns(const Session& session, const Header& header, hid_t state,
                          const parcels::Store& store) {
  const std::vector<std::string> names = hdf5::object_names(session, state);
  std::set<std::string> found(names.begin(), names.end()), wanted = {"uid"};
  for (int column = 0; column < store.state_columns(); ++column)
    wanted.insert(store.column_name(column));
  std::vector<std::string> missing, surplus;
  std::set_difference(wanted.begin(), wanted.end(), found.begin(), found.end(),
                      std::back_inserter(missing));
  std::set_difference(found.begin(), found.end(), wanted.begin(), wanted.end(),
                      std::back_inserter(surplus));
  if (header.dimension == static_cast<std::uint64_t>(store.dimension()) && missing.empty() &&
      surplus.empty())
    return;
  throw Error(ExitCode::file,
              fmt::format("{}: the checkpoint is of another scene: it is {}-dimensional (the scene "
                          "{}), lacks [{}] and has [{}] in addition.",
                          session.path().string(), header.dimension, store.dimension(),
                          fmt::join(missing, ", "), fmt::join(surplus, ", ")));
}

void remove_older(const std::filesystem::path& folder, const std::filesystem::path& newest,
                  int keep) {
  int kept = 1;
  for (const std::filesystem::path& path : list_checkpoints(folder)) {
    // Steps beyond the newest belong to a future that a resumed run has given up.
    const bool abandoned = *step_of(path) > *step_of(newest);
    if (path == newest || (!abandoned && kept++ < keep)) continue;
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error)
      log(LogLevel::warning,
          fmt::format("{}: cannot remove the old checkpoint: {}.", path.string(), error.message()));
  }
}

}  // namespace

std::filesystem::path write_checkpoint(const std::filesystem::path& folder,
                                       const parcels::Store& store, const Checkpoint& checkpoint,
                                       int keep) {
  const std::filesystem::path path =
      folder / fmt::format("{}{:012}{}", file_prefix, checkpoint.step, file_suffix);
  const Header header{checkpoint.time, checkpoint.dt, checkpoint.step, store.size(),
                      static_cast<std::uint64_t>(store.dimension())};
  Session session = Session::create(path);
  write_header(session, header);
  {
    const Id state = hdf5::create_group(session, session.file(), "state");
    hdf5::write_array(session, state, "uid", H5T_STD_U64LE, H5T_NATIVE_UINT64, store.uid(),
                      store.size());
    for (int column = 0; column < store.state_columns(); ++column) {
      const std::string name = store.column_name(column);
      hdf5::write_array(session, state, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
                        store.column(column), store.size());
    }
  }
  if (store.items().exist()) write_items(session, store.items());
  write_named_data(session, checkpoint.data);
  session.commit_sealed();
  remove_older(folder, path, std::max(keep, 1));
  return path;
}

Checkpoint read_checkpoint(const std::filesystem::path& path, parcels::Store& store) {
  require_seal(path);
  const Session session = Session::read(path);
  const Header header = read_header(session);
  const Id state = open_state(session);
  require_same_columns(session, header, state, store);
  store.resize(header.parcels);
  hdf5::read_array_into(session, state, "uid", H5T_NATIVE_UINT64, store.uid(), store.size());
  for (int column = 0; column < store.state_columns(); ++column) {
    const std::string name = store.column_name(column);
    hdf5::read_array_into(session, state, name, H5T_NATIVE_DOUBLE, store.column(column),
                          store.size());
  }
  read_items(session, store.items(), store.size());
  return {header.time, header.step, header.dt, read_named_data(session)};
}

void verify_checkpoint(const std::filesystem::path& path) {
  require_seal(path);
  read_header(Session::read(path));
}

std::vector<std::filesystem::path> list_checkpoints(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (step_of(entry.path())) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end(),
            [](const auto& a, const auto& b) { return *step_of(a) > *step_of(b); });
  return paths;
}

std::optional<std::filesystem::path> find_newest_valid_checkpoint(
    const std::filesystem::path& folder) {
  for (const std::filesystem::path& path : list_checkpoints(folder)) {
    try {
      verify_checkpoint(path);
      return path;
    } catch (const Error& error) {
      log(LogLevel::warning, fmt::format("Skipping a damaged checkpoint. {}", error.what()));
    }
  }
  return {};
}

}  // namespace pileus::output
