#include "pcm/cluster/filter/team_convert.h"

#include "pcm/cluster/filter/selected_points.h"
#include "pcm/cluster/filter/tree_jobs.h"
#include "pcm/cluster/rank_error.h"
#include "pcm/cluster/share_jobs.h"
#include "pcm/cluster/team_folder.h"
#include "pcm/cluster/team_work.h"
#include "pcm/convert/open_cloud.h"
#include "pcm/system/progress_part.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/tree.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr double end_of_selecting = 0.6;  // share of the progress

std::unique_ptr<TreeReader> reader_of(const std::vector<fs::path>& inputs, const ConvertOptions& options)
{
    std::unique_ptr<TreeReader> reader = CloudSources(inputs, options.cloud).open_tree();
    if (!reader)
        throw Error(ErrorCode::unsupported, inputs.front(),
                    "several processes convert one tree, and without a limit of coordinates", "use 'pcmlab convert'");
    return reader;
}

std::vector<std::byte> state_of(const Tree& tree)
{
    ByteWriter out;
    put_state(out, tree.info());
    return std::move(out.bytes());
}

std::vector<std::byte> identity_of_request(const Tree& tree, const std::vector<std::byte>& request)
{
    const std::vector<std::byte> state = state_of(tree);
    ByteWriter out;
    out.put_string("convert");
    out.put_bytes(state.data(), state.size());
    out.put_bytes(request.data(), request.size());
    return std::move(out.bytes());
}

// In rank 0.
ConvertReport write_output(const TeamFolder& folder, std::size_t jobs, const std::vector<fs::path>& inputs,
                           const Tree& selected, const fs::path& output, const ConvertOptions& options)
{
    ConvertOptions last = options;
    last.progress = part_of(options.progress, end_of_selecting, 1);
    return convert(inputs, output, last, [&](std::unique_ptr<PointReader> tree) -> std::unique_ptr<PointReader> {
        // convert() has opened the present tree or an earlier one.
        if (state_of(*Tree::open(selected.folder())) != state_of(selected)) throw tree_has_changed(selected.folder());
        return std::make_unique<SelectedPoints>(std::move(tree), folder.jobs(), jobs);
    });
}

ConvertReport convert_together(Team& team, const std::vector<fs::path>& inputs, const fs::path& output,
                               const ConvertOptions& options, const std::vector<std::byte>& request)
{
    Watch watch(options.progress);
    check_conversion(inputs, output, options);
    const std::unique_ptr<TreeReader> reader = reader_of(inputs, options);
    fs::path next_to_it = output.filename().empty() ? output.parent_path() : output;
    next_to_it += std::string(".") + tree_extension;
    TeamFolder folder(team, next_to_it, true, identity_of_request(reader->tree(), request), true);
    begin_selected(folder.jobs());
    const std::vector<std::size_t> first =
        divide_among_jobs(reader->nodes().size(), [&](std::size_t n) { return reader->nodes()[n].points; });
    const std::size_t jobs = first.size() - 1;
    share_jobs(
        team, count_chunks, jobs, 1,
        [&](std::size_t job) {
            if (!is_selected(folder.jobs(), job))
                write_selected(folder.jobs(), job, *reader, first[job], first[job + 1]);
        },
        [&](std::size_t begun) {
            watch.report("Selecting points", end_of_selecting * static_cast<double>(std::min(begun, jobs)) /
                                                 static_cast<double>(std::max<std::size_t>(1, jobs)));
        });
    ConvertReport report;
    if (team.rank() == 0) {
        report = write_output(folder, jobs, inputs, reader->tree(), output, options);
        run_last_step(report.outcome, [&] {
            try {
                folder.build().discard();
            } catch (const std::exception& error) {
                throw Error::after(folder.path(), "the work is done, but this folder could not be removed", error);
            }
        });
        if (folder.found() == TeamFolder::Found::same_work) report.notes.push_back("interrupted work was resumed");
        report.outcome.seconds = watch.seconds();
    }
    team.wait();
    return report;
}

}  // namespace

ConvertReport convert_by(Team& team, const std::vector<fs::path>& inputs, const fs::path& output,
                         const ConvertOptions& options, const std::vector<std::byte>& request)
{
    return named_by_rank(team, output, [&] { return convert_together(team, inputs, output, options, request); });
}

}  // namespace pcm
