#include "pcm/cluster/job_folder.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/system/part_file.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t job_magic = 0x31424f4a4d4350;  // "PCMJOB1"
constexpr const char* unfinished_mark = ".unfinished";

struct End {
    std::uint64_t bytes = 0, checksum = 0, magic = 0;
};

}  // namespace

void JobFolder::begin(const char* stage) const
{
    std::error_code error;
    fs::create_directories(folder_ / stage, error);
    if (error) throw Error::from_errno(error.value(), folder_ / stage, "creating the folder");
}

fs::path JobFolder::file(const Key& job) const
{
    char name[32];
    std::snprintf(name, sizeof name, "%09llu", static_cast<unsigned long long>(job.number));
    return folder_ / job.stage / name;
}

fs::path JobFolder::unfinished(const Key& job) const
{
    fs::path name = file(job);
    name += unfinished_mark + std::to_string(rank_);
    return new_part_name(name);
}

bool JobFolder::is_done(const Key& job) const
{
    std::error_code error;
    return fs::exists(file(job), error);
}

std::vector<std::byte> JobFolder::record(const Key& job) const
{
    if (!is_done(job))
        throw Error(ErrorCode::not_found, file(job), "the file of a finished part of the work is gone", how_to_go_on());
    const File from(file(job), File::Mode::read);
    const std::uint64_t size = from.size();
    End end;
    if (size >= sizeof end) from.read_at(&end, sizeof end, size - sizeof end);
    std::vector<std::byte> record;
    if (end.magic == job_magic && end.bytes <= size - sizeof end) {
        record.resize(end.bytes);
        from.read_at(record.data(), record.size(), size - sizeof end - end.bytes);
        if (checksum(record.data(), record.size()) == end.checksum) return record;
    }
    throw Error(ErrorCode::corrupt, from.path(), "the file of a finished part of the work is damaged", how_to_go_on());
}

// Jobs that could do a part again may have been given up.
std::string JobFolder::how_to_go_on() const { return "remove " + folder_.parent_path().string() + " and start again"; }

std::optional<std::vector<std::byte>> JobFolder::record_if_done(const Key& job) const
{
    if (!is_done(job)) return std::nullopt;
    return record(job);
}

void JobFolder::finish(const Key& job, const fs::path& unfinished, std::uint64_t bytes,
                       const std::vector<std::byte>& record) const
{
    File to(unfinished, File::Mode::change_or_create);
    to.write_at(record.data(), record.size(), bytes);
    const End end{record.size(), checksum(record.data(), record.size()), job_magic};
    to.write_at(&end, sizeof end, bytes + record.size());
    if (durable_) to.sync();
    to.close();
    // A name that a failing machine forgets costs the work again, and nothing else: the folder is not synced.
    rename_path(unfinished, file(job), "giving a finished part of the work its name");
}

void JobFolder::write(const Key& job, const std::vector<std::byte>& data, const std::vector<std::byte>& record) const
{
    const fs::path name = unfinished(job);
    {
        File to(name, File::Mode::create_new);
        to.write_at(data.data(), data.size(), 0);
    }
    finish(job, name, data.size(), record);
}

void JobFolder::give_up(const std::vector<const char*>& stages, const char* done) const
{
    if (durable_) sync_folder(folder_ / done);
    most_bytes();
    std::error_code error;  // what stays takes room, and does no harm
    for (const char* name : stages) fs::remove_all(folder_ / name, error);
}

std::uint64_t JobFolder::most_bytes() const
{
    std::error_code error;
    std::uint64_t bytes = 0;
    for (auto entry = fs::recursive_directory_iterator(folder_, error); !error && entry != fs::end(entry);
         entry.increment(error)) {
        struct stat status {};  // files have holes
        if (::stat(entry->path().c_str(), &status) == 0) bytes += static_cast<std::uint64_t>(status.st_blocks) * 512;
    }
    std::uint64_t most = most_bytes_;
    while (most < bytes && !most_bytes_.compare_exchange_weak(most, bytes)) {
    }
    return std::max(most, bytes);
}

void JobFolder::remove_unfinished() const
{
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(folder_, error))
        if (entry.path().filename().string().find(unfinished_mark) != std::string::npos)
            fs::remove(entry.path(), error);
}

}  // namespace pcm
