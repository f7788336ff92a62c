#include "pcm/io/pts/pts_reader.h"

#include "pcm/io/text/text_reader.h"

namespace pcm {

std::unique_ptr<PointReader> open_pts(const std::filesystem::path& path, const ReadOptions& options)
{
    TextConventions conventions;
    conventions.format = "PTS";
    conventions.columns = {"x y z", "x y z intensity", "x y z r g b", "x y z intensity r g b"};
    conventions.signed_intensity = true;
    return open_text(path, options, conventions);
}

}  // namespace pcm
