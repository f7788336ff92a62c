// Errors of damaged trees: they name the command that repairs the tree.
#pragma once

#include "pcm/system/error.h"

#include <filesystem>
#include <string>

namespace pcm {

// What a user types to repair the tree in `folder`; a path with characters that a shell takes for its own in quotes.
std::string repair_command(const std::filesystem::path& folder);

// Whether the error is that bytes of a tree are damaged or missing: not that memory, permission or the system failed.
bool is_damage(const Error& error);

// The error of a damaged tree. what() has the way out as a hint, "..., in a terminal: pcmlab repair TREE".
class DamagedTree : public Error {
public:
    // `error` as it was thrown, without a hint; `way_out` says what the command does, and begins the hint. One behind
    // an address cannot be repaired there, and the hint says what can be done instead.
    DamagedTree(const Error& error, const std::filesystem::path& folder, const std::string& way_out);

    // what() without the hint: for lists of faults, below which the command stands once.
    const std::string& fault() const noexcept { return fault_; }

private:
    std::string fault_;
};

}  // namespace pcm
