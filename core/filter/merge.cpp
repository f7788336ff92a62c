#include "pcm/filter/merge.h"

#include "pcm/filter/aligned_reader.h"
#include "pcm/filter/common_grid.h"
#include "pcm/filter/common_schema.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/pipe/merged_reader.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/system/tree_folder.h"
#include "pcm/threads/thread_count.h"
#include "pcm/tree/tree_reader.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

struct Source {
    fs::path folder;
    std::optional<Affine> map;
    std::shared_ptr<const Tree> tree;
    FileInfo info;  // as it is read at its place
};

std::unique_ptr<PointReader> open_source(const Source& source, unsigned threads)
{
    std::unique_ptr<PointReader> points = std::make_unique<TreeReader>(source.tree, std::nullopt, Selection(), threads);
    if (!source.map) return points;
    return std::make_unique<TransformedReader>(std::move(points), *source.map);
}

bool same_map(const std::optional<Affine>& a, const std::optional<Affine>& b)
{
    if (!a || !b) return !a && !b;
    return a->linear == b->linear && a->pivot == b->pivot && a->target == b->target;
}

// The trees, each once at a place.
std::vector<Source> open_trees(const std::vector<MergeInput>& inputs, unsigned threads, std::vector<std::string>& notes)
{
    std::vector<Source> sources;
    for (const MergeInput& input : inputs) {
        Source source{{}, input.map, Tree::open(input.tree), {}};
        source.folder = source.tree->folder();
        if (std::any_of(sources.begin(), sources.end(), [&](const Source& other) {
                return same_map(other.map, source.map) && same_tree_folder(other.folder, source.folder);
            })) {
            notes.push_back("the tree " + source.folder.string() + " is named more than once; it is read once");
            continue;
        }
        source.info = open_source(source, threads)->info();
        sources.push_back(std::move(source));
    }
    if (sources.empty()) throw Error(ErrorCode::invalid_argument, {}, "no trees to merge were given");
    return sources;
}

std::string name_of_tree(const fs::path& folder)
{
    const fs::path name = folder.filename().empty() ? folder.parent_path().filename() : folder.filename();
    return name.string();
}

// The grid of all, where there is one.
std::optional<CommonGrid> grid_of(const std::vector<Source>& sources)
{
    std::vector<GriddedBox> grids;
    for (const Source& source : sources) {
        if (!source.info.grid) return std::nullopt;
        grids.push_back({*source.info.grid, source.tree->info().box});
    }
    return common_grid(grids);
}

std::string grid_note(const std::vector<Source>& sources, const std::optional<CommonGrid>& common)
{
    const auto same = [&](const Source& s) { return s.info.grid && *s.info.grid == *sources[0].info.grid; };
    if (sources[0].info.grid && std::all_of(sources.begin(), sources.end(), same)) return {};
    if (common)
        return "positions are on different grids; all are put on that of " +
               name_of_tree(sources[common->like].folder) + ", steps " + exact(common->grid.scale) +
               ", which holds them all";
    const bool none = std::none_of(sources.begin(), sources.end(), [](const Source& s) { return s.info.grid; });
    return none ? std::string() : "no grid of the trees holds the positions of all; they become doubles";
}

// The name is not in any of the schemas.
Attribute source_id_of(const std::vector<Schema>& schemas, std::size_t trees)
{
    Schema all;
    for (const Schema& schema : schemas)
        for (const Attribute& attribute : schema)
            if (!all.find(attribute.name)) all.add(attribute);
    return {unique_name(all, source_id_name),   trees < 65536 ? ScalarType::u16 : ScalarType::u32, 1, 1, 0,
            "number of the merged tree, from 1"};
}

// A reader with notes about the trees before its own.
class NotedReader final : public PointReader {
public:
    NotedReader(std::unique_ptr<PointReader> cloud, std::vector<std::string> notes)
        : cloud_(std::move(cloud)), notes_(std::move(notes))
    {
    }
    const FileInfo& info() const override
    {
        info_ = cloud_->info();
        info_.notes.insert(info_.notes.begin(), notes_.begin(), notes_.end());
        return info_;
    }
    bool read(PointBatch& batch, std::size_t max_points) override { return cloud_->read(batch, max_points); }
    bool seekable() const override { return cloud_->seekable(); }
    void seek(std::uint64_t index) override { cloud_->seek(index); }
    double fraction_read() const override { return cloud_->fraction_read(); }

private:
    const std::unique_ptr<PointReader> cloud_;
    const std::vector<std::string> notes_;
    mutable FileInfo info_;
};

}  // namespace

MergedTrees open_merged(const std::vector<MergeInput>& inputs, const MergeOptions& options)
{
    const unsigned threads = std::min(thread_count(options.threads), 8u);
    std::vector<std::string> notes;
    const std::vector<Source> sources = open_trees(inputs, threads, notes);
    const std::optional<CommonGrid> grid = grid_of(sources);
    if (std::string note = grid_note(sources, grid); !note.empty()) notes.push_back(std::move(note));
    std::vector<Schema> schemas;
    for (const Source& source : sources) schemas.push_back(source.info.schema);
    CommonSchemas common = common_schemas(schemas);
    notes.insert(notes.end(), common.notes.begin(), common.notes.end());

    MergedTrees merged;
    const auto rounding = std::make_shared<double>(0);
    merged.rounding = rounding;
    MergedReader::Inputs parts;
    parts.ignore_crs = options.ignore_crs;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        Alignment to;
        if (grid) {
            to.grid = grid->grid;
            to.map = grid->maps[i];
        }
        to.schema = common.schemas[i];
        if (options.source_id) to.source_id = source_id_of(schemas, sources.size());
        to.number = static_cast<std::uint32_t>(i + 1);
        to.rounding = rounding;
        parts.sources.push_back({sources[i].folder, [source = sources[i], to, threads] {
                                     return std::make_unique<AlignedReader>(open_source(source, threads), to);
                                 }});
        merged.names.push_back(name_of_tree(sources[i].folder));
        if (options.source_id)
            notes.push_back(to.source_id->name + " " + std::to_string(i + 1) + ": " + merged.names.back());
    }
    merged.points = std::make_unique<NotedReader>(std::make_unique<MergedReader>(std::move(parts)), std::move(notes));
    if (grid) merged.grid = grid->grid;
    return merged;
}

MergeReport merge_trees(const std::vector<MergeInput>& inputs, const MergeOptions& options, const ResultOptions& result)
{
    if (result.target.in_place || result.target.copy.empty())
        throw Error(ErrorCode::invalid_argument, {}, "a merge needs the name of a new tree");
    for (const MergeInput& input : inputs) {
        std::error_code ignored;
        if (fs::equivalent(tree_folder_of(input.tree), result.target.copy, ignored))
            throw Error(ErrorCode::invalid_argument, result.target.copy, "the output is one of the trees to merge",
                        "give the new tree another name");
    }
    BuildOptions build;
    build.memory_bytes = result.memory_bytes;
    build.threads = result.threads;
    build.chunk_points = result.chunk_points;
    build.sampling = result.sampling.value_or(Sampling::poisson);
    build.overwrite = result.target.overwrite;
    build.progress = result.progress;
    check_build_options(build);
    MergeOptions own = options;
    own.threads = result.threads;
    const MergedTrees merged = open_merged(inputs, own);
    MergeReport report;
    report.grid = merged.grid;
    report.trees = merged.names;
    if (const auto system = coordinate_system_of(merged.points->info().metadata)) report.system = describe(*system);
    report.build = build_tree(*merged.points, merged.names, result.target.copy, build);
    report.rounding = *merged.rounding + report.build.outcome.error;
    return report;
}

}  // namespace pcm
