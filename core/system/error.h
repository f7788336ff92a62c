// The one exception type of the library.
//
// Core code never prints and never exits: every failure is thrown as pcm::Error, whose text names the file or folder,
// what was found, what was expected and, where possible, what the user can do.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace pcm {

enum class ErrorCode {
    not_found,          // no such file or folder
    permission,         // the operating system refused access
    no_space,           // the disk or quota is full
    io,                 // any other failure of the operating system while reading or writing
    bad_format,         // the bytes violate the format
    truncated,          // the file is shorter than its header promises
    corrupt,            // a checksum or a count is wrong
    not_a_tree,         // the folder holds no point cloud tree
    interrupted_build,  // the folder holds a tree whose build never finished
    exists,             // the output exists already
    unsupported,        // well-formed, but not supported by this library
    cancelled,          // the progress callback asked to stop
    invalid_argument,   // a parameter is outside its range
};

const char* name_of(ErrorCode code);  // "not_found"

class Error : public std::runtime_error {
public:
    // `path` is empty where no file is concerned; `hint` says what the user can do, or is empty.
    Error(ErrorCode code, const std::filesystem::path& path, const std::string& what, const std::string& hint = {});

    // From a value of `errno`, saved before other calls can change it; `action` is a phrase like "writing the index".
    static Error from_errno(int error_number, const std::filesystem::path& path, const std::string& action);

    // The error `failure` of a step after the result was in place. `result` says what is done, as in "the points are in
    // the tree".
    static Error after(const std::filesystem::path& path, const std::string& result, const std::exception& failure);

    ErrorCode code() const noexcept { return code_; }
    const std::filesystem::path& path() const noexcept { return path_; }
    const std::string& hint() const noexcept { return hint_; }
    // The operation has done what it was asked for, and only a later step failed: the result may not survive a loss of
    // power, or remains could not be removed. Repeating the operation would do it twice. Functions that return an
    // Outcome report such failures as its warnings (system/progress.h); those that return nothing throw them.
    bool is_done() const noexcept { return done_; }

private:
    ErrorCode code_;
    std::filesystem::path path_;
    std::string hint_;
    bool done_ = false;
};

}  // namespace pcm
