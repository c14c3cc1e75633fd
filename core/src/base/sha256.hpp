// SHA-256 of data that arrives in pieces.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace pileus {

/// Incremental SHA-256 (FIPS 180-4). Throws Error(ExitCode::file) when libcrypto refuses to work.
class Sha256 {
 public:
  using Digest = std::array<std::uint8_t, 32>;

  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  Sha256& update(const void* data, std::size_t bytes);
  Sha256& update(std::string_view text) { return update(text.data(), text.size()); }
  /// Ends the message; the object may not be used again.
  Digest finish();
  /// As `finish`, in 64 lower-case hexadecimal digits.
  std::string finish_hex();

 private:
  struct Release {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Release> context_;
};

/// SHA-256 of one piece of data in hexadecimal digits.
std::string sha256_hex(std::string_view data);

}  // namespace pileus
