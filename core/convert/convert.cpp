#include "pcm/convert/convert.h"

#include "pcm/build/builder.h"
#include "pcm/convert/open_cloud.h"
#include "pcm/convert/output_grid.h"
#include "pcm/io/file_text.h"
#include "pcm/io/formats.h"
#include "pcm/io/pipe/require_points.h"
#include "pcm/io/survey.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
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
    if (options.write.las_version) only(takes_las_version, "a LAS version goes to ");
    if (options.write.colour_bits) only(takes_colour_bits, "a number of colour bits goes to ");
    if (options.write.float_positions) only(takes_float_positions, "float positions go to ");
}

void refuse_output(const CloudSources& inputs, const fs::path& output, bool overwrite)
{
    std::error_code error;
    const fs::file_status status = fs::status(output, error);
    // First, so that no message advises to overwrite a file of a tree.
    if (extension_of(output) == tree_extension)
        output_tree(output);
    else
        output_file(output);
    if (!fs::exists(status)) return;
    if (inputs.has(output))
        throw Error(ErrorCode::invalid_argument, output, "this is the input; it cannot be the output too",
                    "choose another name");
    if (!overwrite)
        throw Error(ErrorCode::exists, output, "the output exists already", "choose another name, or overwrite it");
}

CloudSources checked_sources(const std::vector<fs::path>& inputs, const fs::path& output, const ConvertOptions& options)
{
    const std::string extension = extension_of(output);
    refuse_idle_options(options, output, extension);
    refuse_impossible_box(options.cloud.selection);
    CloudSources sources(inputs, options.cloud);
    refuse_output(sources, output, options.overwrite);
    if (extension != tree_extension) check_writable_name(output);
    return sources;
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

std::unique_ptr<PointReader> open_selected(CloudSources& sources, const Selection& selection,
                                           const ReadThrough& through)
{
    auto points = sources.open();
    if (through) points = through(std::move(points));
    if (!selection.chooses_points()) return points;
    return require_points(std::move(points), [&sources] { return sources.bounds(); });
}

ConvertReport convert_to_tree(CloudSources& sources, const fs::path& output, const ConvertOptions& options,
                              const std::function<std::unique_ptr<PointReader>()>& open)
{
    const auto cloud = open();
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
    report.skipped = built.skipped;
    report.bytes = built.bytes;
    report.notes = built.notes;
    return report;
}

// Passes the points of a cloud on, and shows them to a surveyor.
class WatchedReader final : public PointReader {
public:
    WatchedReader(PointReader& cloud, Surveyor& surveyor) : cloud_(cloud), surveyor_(surveyor) {}

    const FileInfo& info() const override { return cloud_.info(); }
    bool read(PointBatch& batch, std::size_t max_points) override
    {
        const bool more = cloud_.read(batch, max_points);
        if (more) surveyor_.watch(batch);
        return more;
    }
    double fraction_read() const override { return cloud_.fraction_read(); }

private:
    PointReader& cloud_;
    Surveyor& surveyor_;
};

// What has to be known before a file is begun: the grid of its positions, and the answers to its format's questions.
// Returns whether the cloud was read for it.
bool look_ahead(PointReader& cloud, const fs::path& output, const ConvertOptions& options, WriteOptions& write,
                ConvertReport& report, Watch& watch)
{
    const Format* const format = format_of_extension(extension_of(output));
    const bool needs = format && format->has(needs_grid) && !write.grid && (!cloud.info().grid || options.scale);
    const bool asks = format && format->questions && !write.survey;
    Surveyor surveyor(cloud.info(), asks ? format->questions(cloud.info(), write) : SurveyQuestions());
    WatchedReader watched(cloud, surveyor);
    bool has_read = false;
    if (needs) {
        const OutputGrid chosen = choose_output_grid(watched, options.scale, [&](double fraction) {
            watch.report("Finding the grid of the positions", 0.4 * fraction);
        });
        write.grid = report.grid = chosen.grid;
        append(report.notes, chosen.notes);
        has_read = chosen.points_read > 0;
    } else {
        for (PointBatch batch; surveyor.open() && watched.read(batch, default_batch_points); has_read = true)
            watch.report("Looking at the values", 0.4 * cloud.fraction_read());
    }
    if (asks) write.survey = std::make_shared<const Survey>(surveyor.answers());
    return has_read;
}

}  // namespace

std::unique_ptr<PointReader> open_cloud(const std::vector<fs::path>& inputs, const CloudOptions& options)
{
    return CloudSources(inputs, options).open();
}

ConvertReport write_cloud(const std::function<std::unique_ptr<PointReader>()>& open, const fs::path& output,
                          const ConvertOptions& options)
{
    check_writable_name(output);
    output_file(output);
    Watch watch(options.progress);
    ConvertReport report;
    WriteOptions write = options.write;
    auto cloud = open();
    const bool gridded = has(extension_of(output), needs_grid);
    double done = 0;  // fraction of the whole work, before the points are written
    if (look_ahead(*cloud, output, options, write, report, watch)) {
        done = 0.4;
        cloud = open();
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
    watch.report("Writing points", 0.99, true);  // the last chance to cancel
    run_last_step(report.outcome, [&] { writer->finish(); });
    // Complete only now: readers count dropped points while they read.
    report.notes.insert(report.notes.begin(), cloud->info().notes.begin(), cloud->info().notes.end());
    report.skipped = cloud->info().skipped;
    report.points_skipped = report.outcome.points_in - report.outcome.points_out;
    if (report.points_skipped)
        report.notes.push_back(points_text(report.points_skipped) + " without a finite position left out");
    report.outcome.points_in += cloud->info().points_left_out;
    report.points_skipped += cloud->info().points_left_out;
    append(report.notes, writer->notes());
    report.outcome.error = writer->position_error();
    report.outcome.error_meaning = "largest position error, source units";
    std::error_code error;
    report.bytes = fs::file_size(output, error);
    if (error) report.bytes = 0;
    report.outcome.seconds = watch.seconds();
    watch.finish("Done");
    return report;
}

ConvertReport convert(const std::vector<fs::path>& inputs, const fs::path& output_as_given,
                      const ConvertOptions& options, const ReadThrough& through)
{
    const fs::path output = without_slash(output_as_given);
    CloudSources sources = checked_sources(inputs, output, options);
    const auto open = [&] { return open_selected(sources, options.cloud.selection, through); };
    ConvertReport report = extension_of(output) == tree_extension ? convert_to_tree(sources, output, options, open)
                                                                  : write_cloud(open, output, options);
    report.notes.insert(report.notes.begin(), sources.notes().begin(), sources.notes().end());
    return report;
}

ConvertReport convert(const std::vector<fs::path>& inputs, const fs::path& output, const ConvertOptions& options)
{
    return convert(inputs, output, options, {});
}

void check_conversion(const std::vector<fs::path>& inputs, const fs::path& output, const ConvertOptions& options)
{
    checked_sources(inputs, without_slash(output), options);
}

}  // namespace pcm
