// Columns of published numbers in CSV files.
#pragma once
#include <string>
#include <vector>

namespace pileus::model {

/// One column of a CSV file with a header row; lines starting with # are comments. `cited_at` is
/// where the file is named ("scene.yaml:12"), for messages.
/// Throws Error(usage): the file cannot be read, has no such column, or a cell is not a number.
std::vector<double> read_table_column(const std::string& path, const std::string& column,
                                      const std::string& cited_at);

}  // namespace pileus::model
