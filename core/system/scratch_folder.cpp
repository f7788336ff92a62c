#include "pcm/system/scratch_folder.h"

#include "pcm/system/error.h"
#include "pcm/system/file_lock.h"
#include "pcm/system/part_file.h"

#include <cstring>
#include <system_error>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr const char* marker_name = "scratch";
constexpr char marker_text[] = "A folder with temporary files of pcmlab. It can be removed when no program uses it.\n";
constexpr std::size_t marker_bytes = sizeof marker_text - 1;

bool is_marker(const File& file)
{
    char text[marker_bytes];
    return file.size() == marker_bytes && file.read_some_at(text, marker_bytes, 0) == marker_bytes &&
           std::memcmp(text, marker_text, marker_bytes) == 0;
}

// The marker last: without it the rest would not be known for what it is.
void remove_contents(const fs::path& folder)
{
    std::error_code error;
    fs::remove_all(folder / "work", error);
    if (!error) fs::remove(folder / marker_name, error);
}

void remove_abandoned(const fs::path& folder)
{
    std::error_code ignored;
    try {
        if (fs::exists(fs::symlink_status(folder / marker_name))) {
            const File marker(folder / marker_name, File::Mode::change);
            if (take_lock(marker.descriptor(), marker.path()) != FileLock::taken) return;
            // Empty: its process was killed before it wrote anything.
            if (marker.size() > 0 && !is_marker(marker)) return;
            remove_contents(folder);
        }
        fs::remove(folder, ignored);  // fails where anything else is in it
    } catch (const Error&) {          // it stays for the next one
    }
}

void remove_abandoned_beside(const fs::path& output)
{
    std::error_code error;
    const std::string name = output.filename().string();
    fs::directory_iterator at(folder_holding(output), error);
    for (; !error && at != fs::directory_iterator(); at.increment(error)) {
        std::error_code ignored;
        if (is_part_name(at->path().filename().string(), name) &&
            fs::is_directory(fs::symlink_status(at->path(), ignored)))
            remove_abandoned(at->path());
    }
}

}  // namespace

ScratchFolder::ScratchFolder(const fs::path& output)
{
    std::error_code error;
    if (const fs::path parent = folder_holding(output); !fs::is_directory(parent, error))
        throw Error(ErrorCode::not_found, parent, "no such folder to put the output in");
    remove_abandoned_beside(output);
    do path_ = new_part_name(output);
    while (!make());
    if (!fs::create_directory(work(), error) && error) {
        const Error failure = Error::from_errno(error.value(), work(), "creating the folder");
        remove_contents(path_);
        fs::remove(path_, error);
        throw failure;
    }
}

// False when the name is taken, or another process took the new folder for an abandoned one before it was locked.
bool ScratchFolder::make()
{
    std::error_code error;
    if (!fs::create_directory(path_, error)) {
        if (error) throw Error::from_errno(error.value(), path_, "creating the folder");
        return false;
    }
    try {
        marker_ = File(path_ / marker_name, File::Mode::create_new);
        if (take_lock(marker_.descriptor(), marker_.path()) == FileLock::held) return false;
        if (!fs::exists(path_ / marker_name, error)) return false;
        marker_.write_at(marker_text, marker_bytes, 0);
        return true;
    } catch (const Error& failure) {
        if (failure.code() == ErrorCode::not_found) return false;
        fs::remove(path_ / marker_name, error);
        fs::remove(path_, error);
        throw;
    }
}

ScratchFolder::~ScratchFolder()
{
    std::error_code ignored;
    remove_contents(path_);
    fs::remove(path_, ignored);
}

}  // namespace pcm
