// A bounded window that moves over one member of the input.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/byte_window.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>

namespace scansion {

Result<ByteWindow> ByteWindow::open(const Member& member) {
  ByteWindow window;
  window.name_ = member.name;
  window.offset_ = member.offset;
  window.size_ = member.size;
  window.fd_ = member.fd;
  if (!member.path.empty()) {
    window.owned_ = UniqueFd(::open(member.path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
    if (!window.owned_) return system_error(member.name + ": cannot be opened; check the path and its permissions", errno);
    window.fd_ = window.owned_.get();
  }
  // Scans of ten thousand small files are common: no more than the file needs.
  window.buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kWindow, member.size)) + 1);
  window.begin_ = window.end_ = window.buffer_.data();
  return window;
}

Result<void> ByteWindow::fill(std::size_t want) {
  if (available() >= want || read_ == size_) return success();
  const std::size_t kept = available();
  std::memmove(buffer_.data(), begin_, kept);
  begin_ = buffer_.data();
  end_ = begin_ + kept;
  const auto room = static_cast<std::size_t>(std::min<std::uint64_t>(buffer_.size() - 1 - kept, size_ - read_));
  SCANSION_TRY(n, read_at(fd_, offset_ + read_, std::as_writable_bytes(std::span(end_, room)), name_));
  if (n != room) return fail(Errc::io, name_, ": became shorter while it was read; wait until it is complete and start again");
  end_ += n;
  read_ += n;
  return success();
}

Result<bool> ByteWindow::next_row(std::string_view& row) {
  const std::size_t have = available();
  if (have > kMaxRow) {
    if (const void* feed = std::memchr(begin_, '\n', kMaxRow + 1); feed != nullptr) {
      const auto length = static_cast<std::size_t>(static_cast<const char*>(feed) - begin_);
      row = {begin_, length};
      begin_ += length + 1;
      ++row_;
      return true;
    }
  }
  return next_row_slowly(row);
}

Result<bool> ByteWindow::next_row_slowly(std::string_view& row) {
  SCANSION_TRY(fill(kMaxRow + 1));
  const std::size_t have = available();
  if (have == 0) return false;
  ++row_;
  const std::size_t look = std::min(have, kMaxRow + 1);
  const void* feed = std::memchr(begin_, '\n', look);
  if (feed == nullptr && look > kMaxRow) {
    if (std::memchr(begin_, '\0', look) != nullptr)
      return fail(Errc::undecodable, where(), ": binary data; give a text file of points, a CSV or a PLY file");
    return fail(Errc::undecodable, where(), ": a row of more than ", std::to_string(kMaxRow),
                " bytes; write one point per row, rows ended by a line feed");
  }
  const std::size_t length = feed != nullptr ? static_cast<std::size_t>(static_cast<const char*>(feed) - begin_) : have;
  if (feed == nullptr) *end_ = '\n'; // the buffer has one byte more than the window
  row = {begin_, length};
  begin_ += feed != nullptr ? length + 1 : length;
  return true;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 24;
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : text.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F) {
      out += c;
    } else {
      out += "\\x";
      out += kHex[byte >> 4U];
      out += kHex[byte & 0xFU];
    }
  }
  out += text.size() > kShown ? "...\"" : "\"";
  return out;
}

} // namespace scansion
