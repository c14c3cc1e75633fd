// Projects of new plugins: what is written, and what is refused.
#include "authoring/new_plugin.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "base/error.hpp"

namespace pileus::authoring {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class NewPluginTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_ =
      fs::path(testing::TempDir()) /
      (std::string("new_plugin_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(NewPluginTest, kinds_are_the_folders_of_templates) {
  EXPECT_EQ(plugin_kinds(),
            (std::vector<std::string>{"forcing", "microphysics", "mixing", "surface"}));
}

TEST_F(NewPluginTest, every_kind_is_complete_and_bears_its_name) {
  for (const std::string& kind : plugin_kinds()) {
    SCOPED_TRACE(kind);
    const auto files = write_project({"two_words", kind, folder_});
    std::vector<std::string> names;
    for (const fs::path& file : files) {
      names.push_back(file.filename());
      EXPECT_EQ(contents(file).find("my_scheme"), std::string::npos) << file;
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"CMakeLists.txt", "LICENSE", "README.md", "example.yaml",
                                        "plugin.cpp", "rates.hpp", "rates_test.cpp"}));
    const std::string source = contents(folder_ / "plugin.cpp");
    EXPECT_NE(source.find("class TwoWords : public"), std::string::npos);
    EXPECT_NE(source.find("d.op.title = \"Two words\""), std::string::npos);
    EXPECT_NE(source.find("d.op.kind = \"" + kind + "\""), std::string::npos);
    EXPECT_NE(source.find("\"org.example.two_words\", \"0.1.0\""), std::string::npos);
    fs::remove_all(folder_);
  }
}

TEST_F(NewPluginTest, an_existing_folder_is_left_alone) {
  fs::create_directories(folder_);
  EXPECT_THROW(write_project({"name", "mixing", folder_}), Error);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(NewPluginTest, names_that_are_none_make_no_folder) {
  for (const char* name : {"", "Upper", "9lives", "a__b", "a_", "_a", "a-b", "clean"}) {
    EXPECT_THROW(write_project({name, "mixing", folder_}), Error) << name;
    EXPECT_FALSE(fs::exists(folder_)) << name;
  }
}

}  // namespace
}  // namespace pileus::authoring
