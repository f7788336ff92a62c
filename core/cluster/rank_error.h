// Errors that name the rank of a team in which they occurred.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/renamed_error.h"
#include "pcm/threads/team.h"

#include <filesystem>
#include <new>
#include <string>

namespace pcm {

// Calls work() and names the rank in what it throws, unless the team is one process. `path`: what is worked on, for
// errors of the system that name nothing.
template <class Work>
auto named_by_rank(const Team& team, const std::filesystem::path& path, const Work& work)
{
    const std::string rank = team.size() > 1 ? " (on rank " + std::to_string(team.rank()) + ")" : "";
    try {
        return work();
    } catch (const Error& error) {
        if (error.is_done() || error.code() == ErrorCode::cancelled || rank.empty()) throw;
        throw Error(error.code(), error.path(), text_alone(error) + rank, error.hint());
    } catch (const std::filesystem::filesystem_error& error) {
        throw Error::from_errno(error.code().value(), error.path1(), "working in the folder" + rank);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::io, path, "the system has no memory left" + rank, "lower the memory of each process");
    }
}

}  // namespace pcm
