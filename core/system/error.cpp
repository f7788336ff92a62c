#include "pcm/system/error.h"

#include <cerrno>
#include <cstring>

namespace pcm {
namespace {

std::string compose(const std::filesystem::path& path, const std::string& what, const std::string& hint)
{
    std::string text = path.empty() ? what : path.string() + ": " + what;
    if (!hint.empty()) text += " (" + hint + ")";
    return text;
}

ErrorCode code_of(int error_number)
{
    switch (error_number) {
        case ENOENT:
        case ENOTDIR:
            return ErrorCode::not_found;
        case EACCES:
        case EPERM:
        case EROFS:
            return ErrorCode::permission;
        case ENOSPC:
        case EDQUOT:
        case EFBIG:
            return ErrorCode::no_space;
        case EEXIST:
        case ENOTEMPTY:
            return ErrorCode::exists;
        default:
            return ErrorCode::io;
    }
}

}  // namespace

const char* name_of(ErrorCode code)
{
    static constexpr const char* names[] = {
        "not_found",  "permission",        "no_space", "io",          "bad_format", "truncated",       "corrupt",
        "not_a_tree", "interrupted_build", "exists",   "unsupported", "cancelled",  "invalid_argument"};
    return names[static_cast<std::size_t>(code)];
}

Error::Error(ErrorCode code, const std::filesystem::path& path, const std::string& what, const std::string& hint)
    : std::runtime_error(compose(path, what, hint)), code_(code), path_(path), hint_(hint)
{
}

Error Error::from_errno(int error_number, const std::filesystem::path& path, const std::string& action)
{
    const ErrorCode code = code_of(error_number);
    const char* hint = error_number == EFBIG           ? "files of this size are not allowed here: see 'ulimit -f'"
                       : code == ErrorCode::no_space   ? "free some space or choose another folder"
                       : code == ErrorCode::permission ? "check the owner and the mode of the folder"
                                                       : "";
    return Error(code, path, action + " failed: " + std::strerror(error_number), hint);
}

Error Error::after(const std::filesystem::path& path, const std::string& result, const std::exception& failure)
{
    const auto* const known = dynamic_cast<const Error*>(&failure);
    Error error(known ? known->code() : ErrorCode::io, path, result + ", but: " + failure.what(),
                "do not repeat the operation");
    error.done_ = true;
    return error;
}

}  // namespace pcm
