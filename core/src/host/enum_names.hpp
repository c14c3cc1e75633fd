// Words for the enumerations of pileus/abi.h; a value without a word is unknown and refused.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace pileus::host {

/// The words of an enumeration whose values run from `first` without gaps.
struct EnumWords {
  std::uint32_t first;
  std::span<const char* const> words;

  bool knows(std::uint32_t value) const { return value - first < words.size(); }
  const char* operator()(std::uint32_t value) const {
    return knows(value) ? words[value - first] : "unknown";
  }
};

namespace words {
inline constexpr std::array<const char*, 6> place_list = {"parcel",         "item",    "mesh",
                                                          "mesh_at_parcel", "surface", "domain"};
inline constexpr std::array<const char*, 4> type_list = {"f64", "f32", "i64", "u64"};
inline constexpr std::array<const char*, 5> nature_list = {"as its owner declares", "extensive",
                                                           "intensive", "label", "derived"};
inline constexpr std::array<const char*, 8> rule_list = {"default", "sum",  "mean",  "min",
                                                         "max",     "copy", "share", "hook"};
inline constexpr std::array<const char*, 4> scope_list = {"local", "cellwise", "columnwise",
                                                          "global"};
inline constexpr std::array<const char*, 4> form_list = {"flow", "projection", "closure",
                                                         "observer"};
inline constexpr std::array<const char*, 4> repeat_list = {"none", "run", "threads", "ranks"};
inline constexpr std::array<const char*, 8> parameter_list = {
    "number", "integer", "switch", "choice", "text", "numbers", "profile", "series"};
inline constexpr std::array<const char*, 3> role_list = {"provides", "requires", "excludes"};
inline constexpr std::array<const char*, 5> comparison_list = {"<", "<=", ">", ">=", "!="};

inline constexpr EnumWords place{1, place_list};
inline constexpr EnumWords type{1, type_list};
inline constexpr EnumWords nature{0, nature_list};
inline constexpr EnumWords rule{0, rule_list};
inline constexpr EnumWords scope{1, scope_list};
inline constexpr EnumWords form{1, form_list};
inline constexpr EnumWords repeatability{0, repeat_list};
inline constexpr EnumWords parameter{1, parameter_list};
inline constexpr EnumWords role{1, role_list};
inline constexpr EnumWords comparison{1, comparison_list};
}  // namespace words

}  // namespace pileus::host
