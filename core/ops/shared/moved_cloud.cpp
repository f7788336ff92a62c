#include "pcm/ops/shared/moved_cloud.h"

#include "pcm/filter/result_tree.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/system/output_path.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree_reader.h"

#include <utility>

namespace pcm::ops {

BuildReport write_moved(const std::shared_ptr<const Tree>& tree, const std::vector<Affine>& maps,
                        const std::filesystem::path& output, const BuildOptions& options)
{
    std::error_code ignored;
    if (std::filesystem::equivalent(tree->folder(), output, ignored))
        throw Error(ErrorCode::invalid_argument, {}, "the output is the input tree", "give the new tree another name");
    const auto open = [&] {
        std::unique_ptr<PointReader> points = std::make_unique<TreeReader>(tree, std::nullopt, Selection());
        for (const Affine& map : maps) points = std::make_unique<TransformedReader>(std::move(points), map);
        return points;
    };
    return build_or_write(open, tree->info().sources, output, options);
}

void put_moved(Result& result, const std::string& output, const std::optional<BuildReport>& report)
{
    result.values["position_error"] = report ? Json(report->outcome.error) : Json();
    result.values["bytes"] = report ? Json(report->bytes) : Json();
    if (!report) return;
    result.output = output;
    result.makes = is_point_file_name(output) ? Makes::file : Makes::cloud;
    result.outcome = report->outcome;
    result.accuracy = rounded_positions(report->outcome.error);
    result.notes.insert(result.notes.end(), report->notes.begin(), report->notes.end());
    result.print("%s: %s points in %.1f s, %s; largest position error %s source units", output.c_str(),
                 grouped(report->outcome.points_out).c_str(), report->outcome.seconds,
                 bytes_text(report->bytes).c_str(), exact(report->outcome.error).c_str());
}

}  // namespace pcm::ops
