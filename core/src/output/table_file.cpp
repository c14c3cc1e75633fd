#include "output/table_file.hpp"

#include <numeric>

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

Id create_column(const Session& session, const NumberColumn& column, const VariableShape& shape) {
  if (column.whole)
    return create_variable(session, session.file(), column.variable, H5T_STD_I64LE, shape, false);
  Encoding exact;
  exact.exact = true;
  exact.compress = false;
  return create_variable(session, session.file(), column.variable, exact, shape);
}

void write_table(const std::filesystem::path& path, const std::string& dimension, std::size_t rows,
                 const std::vector<NumberColumn>& numbers, const std::vector<WordColumn>& words,
                 const Provenance& provenance) {
  Session session = Session::create(path);
  write_provenance(session, session.file(), provenance);
  std::vector<double> places(rows);
  std::iota(places.begin(), places.end(), 0.0);
  const Axis axis{{dimension, "1", "row of the table", ""}, std::move(places), "", true};
  const Id scale = create_axis(session, session.file(), axis);
  const std::vector<hsize_t> start = {0}, count = {rows};
  const VariableShape shape{{scale}, {rows}, {rows}, {std::max<hsize_t>(rows, 1)}};
  for (const NumberColumn& column : numbers) {
    const Id dataset = create_column(session, column, shape);
    hdf5::write_slab(session, dataset, start, count, H5T_NATIVE_DOUBLE, column.values.data());
  }
  const Id text = variable_length_text(session);
  for (const WordColumn& column : words) {
    const Id dataset =
        create_variable(session, session.file(), column.variable, text, shape, false);
    std::vector<const char*> pointers;
    for (const std::string& word : column.values) pointers.push_back(word.c_str());
    hdf5::write_slab(session, dataset, start, count, text, pointers.data());
  }
  session.commit();
}

}  // namespace pileus::output
