// The one exception type of the library.
//
// Core code never prints and never exits: whatever goes wrong is thrown as pcm::Error, whose text names the file or
// folder, what was found and what was expected, and, where there is one, what the user can do about it.
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
    bad_format,         // the bytes are not what the format prescribes
    truncated,          // the file ends before what its header promises
    corrupt,            // a checksum or a count does not hold
    not_a_tree,         // the folder holds no point cloud tree
    interrupted_build,  // the folder holds a tree whose build never finished
    exists,             // the output is there already
    unsupported,        // well-formed, but nothing here can read it
    cancelled,          // the progress callback asked to stop
    invalid_argument,   // a parameter is outside its range
};

class Error : public std::runtime_error {
public:
    // `path` may be empty where no file is concerned; `hint` says what to do and may be empty.
    Error(ErrorCode code, const std::filesystem::path& path, const std::string& what, const std::string& hint = {});

    // Built from `errno` (pass it on before anything else can change it); `action` reads like "writing the index".
    static Error from_errno(int error_number, const std::filesystem::path& path, const std::string& action);

    ErrorCode code() const noexcept { return code_; }
    const std::filesystem::path& path() const noexcept { return path_; }

private:
    ErrorCode code_;
    std::filesystem::path path_;
};

}  // namespace pcm
