#include "pcm/convert/convert.h"

#include "pcm/build/builder.h"
#include "pcm/convert/open_cloud.h"
#include "pcm/convert/output_grid.h"
#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/threads/watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <system_error>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

fs::path without_slash(const fs::path& path) { return path.filename().empty() ? path.parent_path() : path; }

bool has(std::string_view extension, FormatTrait trait)
{
    const Format* const format = format_of_extension(extension);
    return format && format->has(trait);
}

// An option that would have no effect is a user's mistake.
void refuse_idle_options(const ConvertOptions& options, const fs::path& output, const std::string& extension)
{
    const auto refuse = [&](const std::string& what) {
        throw Error(ErrorCode::invalid_argument, output, what + ", not to ." + extension);
    };
    const auto only = [&](FormatTrait trait, const std::string& what) {
        if (!has(extension, trait)) refuse(what + extensions_with(trait));
    };
    if (options.write.grid || options.scale) only(needs_grid, "a grid goes to ");
    if (options.write.decimals) only(takes_decimals, "decimals go to ");
    if (options.write.ascii) only(takes_ascii, "ascii goes to ");
}

void refuse_bad_selection(const Selection& selection)
{
    if (!selection.box) return;
    for (std::size_t a = 0; a < 3; ++a)
        if (!(selection.box->min[a] <= selection.box->max[a]))
            throw Error(ErrorCode::invalid_argument, {},
                        "the box is empty: along " + std::string(1, "xyz"[a]) + " it goes from " +
                            exact(selection.box->min[a]) + " to " + exact(selection.box->max[a]),
                        "give the smaller corner first");
}

void refuse_output(const std::vector<fs::path>& inputs, const fs::path& output, bool overwrite)
{
    std::error_code error;
    const fs::file_status status = fs::status(output, error);
    if (!fs::exists(status)) return;
    for (const fs::path& input : inputs)
        if (fs::equivalent(input, output, error))
            throw Error(ErrorCode::invalid_argument, output, "this is the input; it cannot be the output too",
                        "choose another name");
    if (!overwrite)
        throw Error(ErrorCode::exists, output, "the output exists already", "choose another name, or overwrite it");
    if (extension_of(output) != tree_extension && !fs::is_regular_file(status))
        throw Error(ErrorCode::exists, output, "the output exists and is not a regular file", "choose another name");
}

// Keeps only points with three finite coordinates.
void drop_not_finite(PointBatch& batch)
{
    if (batch.gridded) return;
    std::vector<std::uint32_t> finite;
    for (std::size_t i = 0; i < batch.size; ++i)
        if (std::isfinite(batch.xyz[0][i]) && std::isfinite(batch.xyz[1][i]) && std::isfinite(batch.xyz[2][i]))
            finite.push_back(static_cast<std::uint32_t>(i));
    if (finite.size() < batch.size) keep_points(batch, finite);
}

void append(std::vector<std::string>& notes, std::vector<std::string> more)
{
    for (std::string& note : more)
        if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
}

ConvertReport convert_to_tree(const CloudSources& sources, const fs::path& output, const ConvertOptions& options)
{
    const auto cloud = sources.open();
    BuildOptions build;
    build.memory_bytes = options.memory_bytes;
    build.threads = options.threads;
    build.chunk_points = options.chunk_points;
    build.overwrite = options.overwrite;
    build.progress = options.progress;
    const BuildReport built = build_tree(*cloud, sources.names(), output, build);
    ConvertReport report;
    report.outcome = built.outcome;
    report.points_skipped = built.points_skipped;
    report.bytes = built.bytes;
    report.notes = built.notes;
    return report;
}

}  // namespace

std::unique_ptr<PointReader> open_cloud(const std::vector<fs::path>& inputs, const CloudOptions& options)
{
    return CloudSources(inputs, options).open();
}

ConvertReport write_cloud(const std::function<std::unique_ptr<PointReader>()>& open, const fs::path& output,
                          const ConvertOptions& options)
{
    Watch watch(options.progress);
    ConvertReport report;
    WriteOptions write = options.write;
    auto cloud = open();
    const bool gridded = has(extension_of(output), needs_grid);
    double done = 0;  // fraction of the whole work, before the points are written
    if (gridded && !write.grid && (!cloud->info().grid || options.scale)) {
        const OutputGrid chosen = choose_output_grid(*cloud, options.scale, [&](double fraction) {
            watch.report("Finding the grid of the positions", 0.4 * fraction);
        });
        write.grid = report.grid = chosen.grid;
        append(report.notes, chosen.notes);
        if (chosen.points_read) {
            done = 0.4;
            cloud = open();
        }
    }
    const std::unique_ptr<PointWriter> writer = create_writer(output, cloud->info(), write);
    PointBatch batch;
    while (cloud->read(batch, default_batch_points)) {
        report.outcome.points_in += batch.size;
        if (gridded) drop_not_finite(batch);
        report.outcome.points_out += batch.size;
        if (batch.size) writer->write(batch);
        watch.report("Writing points", done + (0.99 - done) * cloud->fraction_read());
    }
    writer->finish();
    // Complete only now: readers count dropped points while they read.
    report.notes.insert(report.notes.begin(), cloud->info().notes.begin(), cloud->info().notes.end());
    report.points_skipped = report.outcome.points_in - report.outcome.points_out;
    if (report.points_skipped)
        report.notes.push_back(grouped(report.points_skipped) + " points without a finite position were left out");
    report.outcome.points_in += cloud->info().points_left_out;
    report.points_skipped += cloud->info().points_left_out;
    append(report.notes, writer->notes());
    report.outcome.error = writer->position_error();
    report.outcome.error_meaning = "largest position error, source units";
    std::error_code error;
    report.bytes = fs::file_size(output, error);
    if (error) report.bytes = 0;
    report.outcome.seconds = watch.seconds();
    watch.report("Done", 1);
    return report;
}

ConvertReport convert(const std::vector<fs::path>& inputs, const fs::path& output_as_given,
                      const ConvertOptions& options)
{
    const fs::path output = without_slash(output_as_given);
    const std::string extension = extension_of(output);
    refuse_idle_options(options, output, extension);
    refuse_bad_selection(options.cloud.selection);
    const CloudSources sources(inputs, options.cloud);
    refuse_output(sources.paths(), output, options.overwrite);
    const bool to_tree = extension == tree_extension;
    const Format* const format = format_of_extension(extension);
    if (!to_tree && !(format && format->create)) create_writer(output, {}, {});  // throws, naming the writable formats
    return to_tree ? convert_to_tree(sources, output, options)
                   : write_cloud([&] { return sources.open(); }, output, options);
}

}  // namespace pcm
