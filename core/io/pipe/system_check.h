// Whether clouds that become one are in one coordinate system and count GPS time in the same way.
#pragma once

#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/las_summary.h"
#include "pcm/io/reader.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Clouds are added in order; each is compared with the first one that states a system. The cloud of all of them is in
// that system. One thread.
class SystemCheck {
public:
    // With `ignore_differences` they become notes instead of errors.
    explicit SystemCheck(bool ignore_differences) : ignore_(ignore_differences) {}

    // `path` names the cloud in messages. Returns notes about it; equal findings have equal words. Throws
    // Error(invalid_argument), naming both clouds and both systems, when coordinate systems, units or GPS times differ.
    std::vector<std::string> add(const FileInfo& info, const std::filesystem::path& path);

    // About the cloud that was added last: whether its blocks of the coordinate system (is_crs_block) are those of all.
    bool gives_the_system() const { return gives_the_system_; }
    // ... and whether it states no system.
    bool is_without_system() const { return without_; }
    // The system of all clouds so far.
    const std::optional<CoordinateSystem>& system() const { return system_; }

private:
    void compare_systems(const FileInfo& info, const std::filesystem::path& path, std::vector<std::string>& notes);
    void compare_times(const FileInfo& info, const std::filesystem::path& path, std::vector<std::string>& notes);
    void refuse_or_note(const std::filesystem::path& path, const std::string& found, const std::string& expected,
                        std::vector<std::string>& notes) const;

    const bool ignore_;
    std::optional<CoordinateSystem> system_;
    std::vector<Metadata> blocks_;  // metadata of system_, for a fast comparison
    std::filesystem::path system_of_;
    std::optional<GpsTime> time_;
    std::filesystem::path time_of_;
    bool gives_the_system_ = false, without_ = false, has_blocks_ = false;
};

}  // namespace pcm
