#include "pcm/filter/result_tree.h"

#include "pcm/build/build_folder.h"
#include "pcm/convert/convert.h"
#include "pcm/io/formats.h"
#include "pcm/system/error.h"
#include "pcm/system/new_output.h"
#include "pcm/system/output_path.h"
#include "pcm/tree/tree_lock.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace pcm {

namespace fs = std::filesystem;

namespace {

// A reader that its maker keeps, too.
class SharedReader final : public PointReader {
public:
    explicit SharedReader(std::shared_ptr<PointReader> points) : points_(std::move(points)) {}
    const FileInfo& info() const override { return points_->info(); }
    bool read(PointBatch& batch, std::size_t max_points) override { return points_->read(batch, max_points); }
    bool seekable() const override { return points_->seekable(); }
    void seek(std::uint64_t index) override { points_->seek(index); }
    double fraction_read() const override { return points_->fraction_read(); }

private:
    const std::shared_ptr<PointReader> points_;
};

}  // namespace

fs::path result_place(const fs::path& copy, bool overwrite)
{
    if (!is_point_file_name(copy) || fs::is_directory(copy)) {
        check_place_of_tree(copy, overwrite);
        return output_tree(copy);
    }
    std::string extension = lower_extension(copy).substr(1);
    const Format* const format = format_of_extension(extension);
    if (!format || !format->create)
        throw Error(ErrorCode::unsupported, copy, "files of this format are only read, not written",
                    "use another extension, or .pct for a tree");
    check_output(copy, overwrite);
    return output_file(copy);
}

BuildReport build_or_write(const std::function<std::unique_ptr<PointReader>()>& open,
                           const std::vector<std::string>& sources, const fs::path& output, const BuildOptions& options)
{
    if (!is_point_file_name(output) || fs::is_directory(output)) return build_tree(*open(), sources, output, options);
    result_place(output, options.overwrite);
    ConvertOptions convert;
    convert.write.threads = options.threads;
    convert.overwrite = options.overwrite;
    convert.progress = options.progress;
    const ConvertReport written = write_cloud(open, output, convert);
    BuildReport report;
    report.outcome = written.outcome;
    report.points_skipped = written.points_skipped;
    report.skipped = written.skipped;
    report.bytes = written.bytes;
    report.notes = written.notes;
    return report;
}

BuildReport build_result(const fs::path& path, const ResultOptions& options,
                         const std::function<std::shared_ptr<PointReader>(std::shared_ptr<const Tree>)>& filter)
{
    const bool in_place = options.target.in_place;
    check_choice(path, options.target);
    // In place, changes that others make meanwhile would be lost. Into another tree, the snapshot opened here is read.
    std::optional<TreeLock> held;
    if (in_place) held.emplace(Tree::open(path)->folder());
    const std::shared_ptr<const Tree> tree = Tree::open(path);
    if (!in_place) refuse_own_copy(tree->folder(), options.target);
    BuildOptions build;
    build.memory_bytes = options.memory_bytes < least_build_memory
                             ? options.memory_bytes
                             : std::max(least_build_memory, options.memory_bytes - options.reader_memory());
    build.threads = options.threads;
    build.chunk_points = options.chunk_points;
    build.sampling = options.sampling.value_or(tree->info().sampling);
    build.overwrite = in_place || options.target.overwrite;
    build.progress = options.progress;
    check_build_options(build);  // before the filter begins
    const fs::path output = in_place ? tree->folder() : options.target.copy;
    return build_or_write([&] { return std::make_unique<SharedReader>(filter(tree)); }, tree->info().sources, output,
                          build);
}

}  // namespace pcm
