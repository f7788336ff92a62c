#include "pcm/io/pipe/system_check.h"

#include "pcm/system/error.h"

namespace pcm {
namespace {

std::vector<Metadata> crs_blocks(const std::vector<Metadata>& metadata)
{
    std::vector<Metadata> blocks;
    for (const Metadata& block : metadata)
        if (is_crs_block(block)) blocks.push_back(block);
    return blocks;
}

}  // namespace

std::vector<std::string> SystemCheck::add(const FileInfo& info, const std::filesystem::path& path)
{
    std::vector<std::string> notes;
    compare_systems(info, path, notes);
    compare_times(info, path, notes);
    return notes;
}

void SystemCheck::compare_systems(const FileInfo& info, const std::filesystem::path& path,
                                  std::vector<std::string>& notes)
{
    gives_the_system_ = without_ = false;
    std::vector<Metadata> blocks = crs_blocks(info.metadata);
    if (system_ && blocks == blocks_) return;
    const std::optional<CoordinateSystem> found = coordinate_system_of(info.metadata);
    if (!found) {
        without_ = true;
        if (!blocks.empty()) notes.push_back("its coordinate system cannot be decoded");
        // Blocks that nobody here understands are kept, once.
        gives_the_system_ = !system_ && !has_blocks_ && !blocks.empty();
        has_blocks_ = has_blocks_ || !blocks.empty();
        return;
    }
    if (!system_) {
        system_ = found;
        system_of_ = path;
        blocks_ = std::move(blocks);
        gives_the_system_ = true;
        return;
    }
    switch (compare(*system_, *found)) {
        case CrsRelation::same:
            return;
        case CrsRelation::unclear:
            notes.push_back("its coordinate system, " + describe(*found) + ", is taken to be that of " +
                            system_of_.filename().string() + ", " + describe(*system_) +
                            ": what they state cannot be compared");
            return;
        case CrsRelation::different:
            refuse_or_note(path, "its coordinate system is " + describe(*found),
                           system_of_.string() + " has " + describe(*system_), notes);
    }
}

void SystemCheck::compare_times(const FileInfo& info, const std::filesystem::path& path,
                                std::vector<std::string>& notes)
{
    if (!info.schema.find(attribute_name::gps_time)) return;
    const std::optional<GpsTime> found = gps_time_of(info.metadata);
    if (!found) return;
    if (!time_) {
        time_ = found;
        time_of_ = path;
    } else if (*found != *time_) {
        refuse_or_note(path, "its GPS times are " + describe(*found),
                       "those of " + time_of_.string() + " are " + describe(*time_), notes);
    }
}

void SystemCheck::refuse_or_note(const std::filesystem::path& path, const std::string& found,
                                 const std::string& expected, std::vector<std::string>& notes) const
{
    if (!ignore_)
        throw Error(ErrorCode::invalid_argument, path, found + "; " + expected,
                    "bring them into one system first, or ignore the difference (--ignore-crs)");
    notes.push_back(found + "; " + expected + "; the difference is ignored");
}

}  // namespace pcm
